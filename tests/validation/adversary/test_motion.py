"""Runs of chaotic motions are judged as long as they can be predicted, and by their energy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import symofros as sf
from validation.adversary.attacks.step_sizes import pendulum
from validation.adversary.motion import against_finer


@pytest.mark.parametrize("speed", [0.0, 0.5])
def test_a_chaotic_run_is_judged_before_it_is_unpredictable(speed: float) -> None:
    """From rest as well, where a share of the speeds is none."""
    one = pendulum()
    par = one.par(l1=1.0, l2=1.0, m1=1.0, m2=1.0)
    start = np.array([3.0, 2.0]), np.array([speed, 0.0])
    run = sf.simulate(one.model, *start, t_end=20.0, dt=2e-3, par=par)
    assert not run.outcome.notes
    assert against_finer(one.model, run, par, 1.0).kind == "agreed"
    wrong = replace(run, v=2.0 * run.v)
    assert against_finer(one.model, wrong, par, 1.0, start).kind == "contradicted"
