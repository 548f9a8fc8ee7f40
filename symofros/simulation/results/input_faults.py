"""Which input of a run is no finite number, and where it comes from."""

from __future__ import annotations

import numpy as np

from symofros.base.user_functions import raised_where
from symofros.simulation.inputs import InputPlan
from symofros.simulation.stepping.stepper import InputValueError, Stepper

# Size of a state that makes feedback overflow.
_EXPLODED = 1e100


def input_failure(failure: BaseException | None) -> tuple[str, str]:
    """Reason and advice for a function of inputs that failed, and ended the run."""
    if isinstance(failure, InputValueError):
        return str(failure), "let it return finite numbers, one an input"
    if failure is None:
        return "the input function failed", "call it by itself at this state"
    return f"the input function raised {raised_where(failure)}", "call it by itself at this state; outcome.failure"


def input_fault(stepper: Stepper) -> str:
    """The input that is not finite at the state evaluated last, in words; "" where there is none."""
    t, q, v = stepper.evaluation_point
    if not np.abs(np.concatenate([q, v])).max(initial=0.0) < _EXPLODED:
        return ""  # The state went first, and took a feedback with it.
    bad = np.flatnonzero(~np.isfinite(stepper.inputs_now))
    if not len(bad):
        return ""
    i = int(bad[0])
    value = stepper.inputs_now[i]
    return f"input '{stepper.model.names.u[i]}' is {value} at t = {t:.6g} s, {_source(stepper.inputs, i)}"


def _source(inputs: InputPlan, i: int) -> str:
    """Where input i comes from."""
    if i in inputs.formulas:
        return f"by its formula {str(inputs.formulas[i])!r}"
    if any(index == i for index, *_ in inputs.signals):
        return "by its samples"
    return "a constant"
