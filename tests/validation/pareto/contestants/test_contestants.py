"""A run that is refused says why; one that chooses its steps is judged at its own times."""

from __future__ import annotations

import math

import numpy as np

from validation.adapters.exudyn.steps import Solver
from validation.adapters.exudyn.timed_systems import pendulum
from validation.pareto.problems import pendulum as swing
from validation.pareto.problems import spin_up


def test_what_is_refused_says_why() -> None:
    refused = spin_up.judged_model("1 mode", spin_up.model(1)).measured(method="variational", dt=0.1)
    assert "variational" in refused.ended and math.isnan(refused.error)
    explicit = [one for one in spin_up.exudyn_all(quick=False) if one.method == "RK44"]
    assert "constraints" in explicit[0].run().ended


def test_a_solver_that_chooses_its_steps_is_judged_at_its_own_times() -> None:
    """It records at its first step after each time due: read as of that time, any tolerance would err alike."""
    recorded = pendulum(swing.GRAVITY).run(Solver("DOPRI5", relative=1e-8), 1.0, 5.0, 1.0)
    due = np.arange(6.0)
    assert len(recorded.t) == 6 and np.abs(recorded.t - due).max() > 1e-4
    assert swing.far(recorded.values[:, 0], recorded.t) < 1e-6 < 1e-3 < swing.far(recorded.values[:, 0], due)
