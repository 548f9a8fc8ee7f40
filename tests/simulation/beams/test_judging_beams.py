"""What a run skips of judging its beams is bounded (docs/theory/beams.md, 26d and 26e): never an error that matters."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

import symofros as sf

METHODS = ("rk4", "semi_implicit_euler", "dopri5", "rodas4", "generalized_alpha")
# What a run may leave out of the largest error: a tenth of it or 1e-4; the rest is rounding.
SLACK, NEGLIGIBLE, ROUNDING = 1.10, 1e-4, 1e-9


@cache
def strip(stiffness: float) -> sf.Model:
    """A strip that bends in both planes and twists; its planes differ in stiffness by a factor."""
    beam = sf.Beam(
        "strip", sf.Joint("root", "revolute"), "L", 1.0, EI_z=stiffness, EI_y=1.0, GJ=2.0, rhoJ=0.1,
        bend_y=2, bend_z=2, twist=2,
    )  # fmt: skip
    return sf.compile(sf.System("strip", (beam,), gravity=(0, 0, 0), parameters=(sf.Parameter("L", 0.5),)))


def errors_of(model: sf.Model, run: sf.Trajectory) -> np.ndarray:
    """Errors of the first beam by its slopes and twist alone, at each step."""
    (beam,) = model.beams()
    return np.array([beam.bending(q[beam.in_q]).error for q in run.q])


def slopes_of(model: sf.Model, run: sf.Trajectory) -> np.ndarray:
    (beam,) = model.beams()
    return np.array([beam.bending(q[beam.in_q]).slope for q in run.q])


def assert_bounded(model: sf.Model, run: sf.Trajectory) -> None:
    """What the run states is a step of its own, and no step has a larger error than the slack allows."""
    errors, slopes, stated = errors_of(model, run), slopes_of(model, run), run.bendings[0]
    at = int(np.argmin(np.abs(slopes - stated.slope) + np.abs(run.t - stated.t)))
    assert slopes[at] == pytest.approx(stated.slope, rel=ROUNDING, abs=1e-12) and run.t[at] == pytest.approx(stated.t)
    assert errors.max() <= max(SLACK * errors[at], errors[at] + NEGLIGIBLE) * (1.0 + ROUNDING)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("stiffness", [1.0, 15.0])
@pytest.mark.parametrize("seed", range(2))
def test_strips_state_the_largest_error_of_all_steps(method: str, stiffness: float, seed: int) -> None:
    """Over amplitudes, the share of twist, speeds and steps, coarse ones too; while the joint turns fast."""
    rng = np.random.default_rng(seed)
    model = strip(stiffness)
    for _ in range(2):
        size = 10.0 ** rng.uniform(-3, -0.5, 3)
        q = np.concatenate([[0.0], np.repeat(size * [0.3, 0.3, 1.0], 2) * rng.normal(size=6)])
        v = np.concatenate([[rng.choice([0.0, 5.0])], rng.normal(size=6) * np.repeat(size, 2)])
        dt = 10.0 ** rng.uniform(-4.5, -3.2)
        run = sf.simulate(model, q, v, t_end=200 * dt, dt=dt, method=method, beam_limit=math.inf)
        assert_bounded(model, run)


@pytest.mark.parametrize("stiffness", [1.0, 15.0])
@pytest.mark.parametrize("limit", [1e-3, 0.02, 0.3])
@pytest.mark.parametrize("dt", [1e-5, 3e-4])
def test_the_first_step_beyond_the_limit_ends_a_run(stiffness: float, limit: float, dt: float) -> None:
    """Where growth is fast and slow, in steps fine and coarse, with twist and without."""
    model = strip(stiffness)
    for twist in (0.0, 0.5):
        v = np.array([0.0, 1.0, -0.3, 2.0, 0.4, 30.0 * twist, 0.0])
        run = sf.simulate(model, model.neutral(), v, t_end=4000 * dt, dt=dt, beam_limit=limit)
        errors = errors_of(model, run)
        assert np.all(errors[:-1] <= limit * (1.0 + ROUNDING))
        if len(run.t) < 4001:
            assert run.outcome.kind == "beyond theory" and errors[-1] > limit
