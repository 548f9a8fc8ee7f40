"""States of timed models."""

from __future__ import annotations

import numpy as np

import symofros as sf
from validation.timing.task import task


def test_states_of_many_loops_are_closed_and_differ() -> None:
    made = task("four_bars10", 60)
    model = sf.compile(made.system, sf.Options(("constraint", "constraint_rate"), backend="interpreter"))
    assert len(made.states) == 60
    assert np.abs(model.constraint(made.states.q)).max() < 1e-12
    assert np.abs(model.constraint_rate(made.states.q, made.states.v)).max() < 1e-9
    assert len(np.unique(made.states.q[:, 0])) >= 20
