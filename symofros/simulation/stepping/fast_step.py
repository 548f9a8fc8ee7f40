"""Steps made by hand through the C extension of Python, where it can be built: a tenth of a microsecond a call."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from symofros.runtime.calls import step_type
from symofros.simulation.stepping.by_hand import HandRun
from symofros.simulation.stepping.status import Status


def fast_step(hand: HandRun, made: Callable[[int], Any], plain: Callable[..., Any]) -> Any:
    """step(u=None, steps=1) of a run, or None where there is no extension.

    Args:
        hand: The run; it lives as long as what is returned.
        made: What comes of steps with another status than that they were just made.
        plain: The same call with any arguments, for all that is out of the ordinary.
    """
    Step = None if hand.looks_ahead else step_type()
    if Step is None:
        return None
    ffi, native = hand.run.ffi, hand.run.native
    function, struct = (int(ffi.cast("uintptr_t", of)) for of in (native.sym_hand_step, hand.hand))
    return Step(function, struct, len(hand.held), int(Status.CALLBACK_FAILED), made, plain, hand)
