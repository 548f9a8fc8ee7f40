"""The integrator in C: what single statements of it are for, on the smallest models that show it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import RK45

import symofros as sf

MODELS = Path(__file__).parents[2] / "reference_models"


@pytest.fixture(scope="module")
def cart() -> sf.Model:
    """A mass on a rail with a force."""
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), effort=("F",))
    return sf.compile(sf.System("cart", [sf.RigidBody("mass", joint, sf.Inertia(2.0))], inputs=[sf.Input("F")]))


def test_a_held_signal_changes_at_the_time_of_its_sample(cart: sf.Model) -> None:
    """At the time of an inner sample its own value holds; a step that begins there is driven by it."""
    force = sf.Signal([0.0, 0.25, 0.5, 1.0], [0.0, 4.0, -4.0, 0.0], "hold")
    run = sf.simulate(cart, t_end=0.75, u={"F": force}, method="euler", dt=0.25)  # Times are exact in binary.
    np.testing.assert_array_equal(run.t, [0.0, 0.25, 0.5, 0.75])
    np.testing.assert_array_equal(run.u[:, 0], [0.0, 4.0, -4.0, -4.0])
    np.testing.assert_allclose(run.v[:, 0], [0.0, 0.0, 0.5, 0.0], rtol=0, atol=1e-15)


def test_no_adaptive_step_is_longer_than_max_step(cart: sf.Model) -> None:
    """A constant force is integrated exactly, so that nothing but max_step keeps steps short."""
    free, bound = (
        sf.simulate(cart, t_end=1.0, u={"F": 1.0}, method="dopri5", max_step=longest) for longest in (np.inf, 0.03)
    )
    assert np.diff(free.t).max() > 0.3
    assert np.diff(bound.t).max() <= 0.03 * (1 + 1e-12)
    batch = sf.simulate_batch(cart, [[0.0]], t_end=1.0, u={"F": 1.0}, method="dopri5", max_step=0.03)
    assert int(batch.steps[0]) == bound.statistics.steps >= 34


def test_generalized_alpha_keeps_conditions_on_speeds() -> None:
    """Such a condition is solved for the acceleration at the end of the step; its order is two, as for phi."""
    model = sf.compile(sf.load(MODELS / "closed" / "sleigh.yaml"))
    start = sf.assemble(model, model.neutral(), np.linspace(0.5, 1.0, model.nv))
    exact = sf.simulate(model, start.q, start.v, 0.2, method="dop853", rtol=1e-11, atol=1e-12)
    errors = []
    for dt in (4e-3, 2e-3):
        run = sf.simulate(model, start.q, start.v, 0.2, method="generalized_alpha", dt=dt)
        assert run.outcome.ok, run.outcome
        rate = model.constraint_rate(run.q, run.v, u=run.u)
        assert np.abs(rate).max() < 1e-9
        errors.append(np.abs(model.difference(exact.q[-1], run.q[-1])).max())
    assert errors[1] < 1e-4 and 3.0 < errors[0] / errors[1] < 5.0, errors


def test_the_next_step_is_chosen_from_the_errors_of_the_last_two() -> None:
    """Equation (4) of docs/theory/simulation.md, with errors of SciPy's coefficients of the same method."""
    joint = sf.Joint("x", "prismatic", axis=(1, 0, 0), effort=("-8*x^3",))
    model = sf.compile(sf.System("hardening", [sf.RigidBody("mass", joint, sf.Inertia(2.0))]))
    tolerance = 1e-7
    run = sf.simulate(model, [2.0], [1.0], 3.0, method="dopri5", rtol=tolerance, atol=tolerance)
    assert run.statistics.steps > 50

    def slope(y: np.ndarray) -> np.ndarray:
        return np.array([y[1], -4.0 * y[0] ** 3])

    errors, steps = [], np.diff(run.t)
    for y, y1, h in zip(*(np.hstack([run.q, run.v])[part] for part in (slice(-1), slice(1, None))), steps, strict=True):
        k = np.zeros((7, 2))
        for i, row in enumerate(RK45.A):
            k[i] = slope(y + h * row[:i] @ k[:i])
        k[5], k[6] = slope(y + h * RK45.A[5, :5] @ k[:5]), slope(y1)
        bound = tolerance + tolerance * np.array([abs(y[0]), max(abs(y[1]), abs(y1[1]))])
        errors.append(np.sqrt(np.mean((h * RK45.E @ k / bound) ** 2)))
    now, before = np.array(errors[1:-2]), np.maximum(errors[:-3], 1e-4)
    expected = 0.9 * now ** -(1 / 5 - 0.03) * before**0.04
    # What was rejected between two accepted steps has its own say.
    followed = np.isclose(steps[2:-1] / steps[1:-2], expected, rtol=1e-6)
    assert np.sum(~followed) <= run.statistics.rejected < 5


def test_a_run_continues_after_its_last_output_time(cart: sf.Model) -> None:
    """These times lie within a step; what follows is not recorded, but stepped."""
    run = sf.simulate(cart, t_end=1.0, u={"F": 1.0}, method="dopri5", output=[0.11, 0.23])
    np.testing.assert_array_equal(run.t, [0.11, 0.23])
    assert run.outcome.kind == "finished" and run.outcome.t == 1.0
