"""What a single run notes of a motion every executor notes of the same motion, or says that it has not looked."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pytest

import symofros as sf
from tests.models import GUESSES, compiled

UNSEEN = "not examined"


class Motion(NamedTuple):
    """A motion by rk4.

    Attributes:
        model: Model that moves.
        q: First configuration (nq).
        v: First speeds (nv).
        t_end: End [s].
        said: Part of the note that it bears; "" for none.
    """

    model: sf.Model
    q: np.ndarray
    v: np.ndarray
    t_end: float
    said: str


@cache
def motion(name: str) -> Motion:
    """A parallelogram that turns over its singular posture, or stops before it."""
    m = compiled("parallelogram")
    first = sf.assemble(m, GUESSES["parallelogram"], np.full(m.nv, 3.0))
    return Motion(m, first.q, first.v, *((0.6, "singular posture") if name == "singular" else (0.1, "")))


def in_batch(moved: Motion, **options: Any) -> sf.Outcome:
    """As the second of two motions, of which the first does not move."""
    speeds = np.stack([0.0 * moved.v, moved.v])
    runs = sf.simulate_batch(moved.model, moved.q, speeds, t_end=moved.t_end, method="rk4", dt=1e-3, **options)
    return runs.outcome(1)


EXECUTORS: dict[str, Callable[[Motion], sf.Outcome]] = {
    "single": lambda moved: sf.simulate(moved.model, *moved[1:4], method="rk4", dt=1e-3).outcome,
    "last state": in_batch,
    "each step": lambda moved: in_batch(moved, output=1e-3),
    "every tenth": lambda moved: in_batch(moved, output=1e-2),
    "events": lambda moved: in_batch(moved, output=1e-3, events={"never": "t - 100"}),
}


@pytest.mark.parametrize("executor", EXECUTORS)
@pytest.mark.parametrize("name", ["singular", "regular"])
def test_every_executor_notes_what_a_single_run_notes(name: str, executor: str) -> None:
    moved = motion(name)
    notes = EXECUTORS[executor](moved).notes
    if any(UNSEEN in note for note in notes):
        assert executor == "events" and len(notes) == 1
    else:
        assert [moved.said in note for note in notes] == [True] * bool(moved.said)
