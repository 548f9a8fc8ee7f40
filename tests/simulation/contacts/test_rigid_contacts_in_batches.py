"""Rigid contacts in batches and steppers of many: motions of single runs (docs/theory/constraints.md, section 15)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.simulation.rigid_scenes import GROUND, G, ball, box, in_shell, rested, rod

STEPS: list[dict[str, Any]] = [
    {"method": "rk4", "dt": 1e-3},
    {"method": "dopri5", "rtol": 1e-9, "atol": 1e-12},
]


def starts(name: str, n: int) -> tuple[sf.Model, Any, Any]:
    """A model and n first states: in the air, the first three on the ground, in motion into it."""
    rng = np.random.default_rng(3)
    if name == "ball":
        model = ball()
        q, v = np.array([rested(model, 0.1 + h) for h in rng.uniform(0.0, 0.2, n)]), rng.uniform(-2, 2, (n, 6))
    elif name == "rod":
        model, angle = rod(0.4, 0.3), rng.uniform(-1, 1, n)
        q, v = np.stack([0 * angle, np.cos(angle) + 0.05, angle], axis=1), rng.uniform(-2, 2, (n, 3))
    elif name == "shell":
        model = sf.compile(in_shell(0.3, (0, 1, 0), 2.5))
        q, v = np.array([model.neutral()] * n), rng.uniform(-4, 4, (n, 12))
        q[:, 0], v[:, 0], v[:, 6] = np.where(np.arange(n) < 3, 0.4, 0.39), 0.4, 0.0
        return model, q, v
    else:
        model = box(0.3)
        q = np.array([rested(model, 0.11)] * n)
        v = np.array([1.0, 0.5, 0, 0.2, 0.1, 2.0]) + rng.uniform(-0.1, 0.1, (n, 6))
    height = 1 if name == "rod" else 2
    q[:3, height] = np.cos(q[:3, 2]) if name == "rod" else 0.1
    v[:3, height] = -0.4
    return model, q, v


def apart(events: Sequence[Any]) -> list[Any]:
    """The first event of each instant: where two balls land or slide at once, rounding decides which are listed."""
    return [one for k, one in enumerate(events) if k == 0 or one.t > events[k - 1].t]


@pytest.mark.parametrize("name", ["ball", "rod", "box", "shell"])
@pytest.mark.parametrize("steps", STEPS)
def test_batches_move_as_single_runs_do(name: str, steps: dict[str, Any]) -> None:
    """States to 1e-12, each event at its instant, with what it took; strikes at the start, too."""
    model, q, v = starts(name, 9)
    grid = np.linspace(0, 0.15, 4)
    many = sf.simulate_batch(model, q, v, t_end=0.15, output=grid, **steps)
    struck = 0
    for i in range(len(q)):
        run = sf.simulate(model, q[i], v[i], t_end=0.15, output=grid, **steps)
        assert many.outcome(i).kind == run.outcome.kind == "finished"
        assert many.q[i] == pytest.approx(run.q, abs=1e-12) and many.v[i] == pytest.approx(run.v, abs=1e-11)
        found, known = apart(many.events(i)), apart(run.events)
        # Two corners of the box slide at once: which of them is the first, rounding decides.
        what = [[x.name.split(maxsplit=1)[1] if name == "box" else x.name for x in each] for each in (found, known)]
        assert what[0] == what[1] and [x.t for x in found] == pytest.approx([x.t for x in known], abs=1e-11)
        for one, other in zip(found, known, strict=True):
            assert one.energy_lost == pytest.approx(other.energy_lost, abs=1e-9)
        assert many[i].lam == pytest.approx(run.lam, rel=1e-8, abs=1e-8)
        struck += bool(found) and found[0].t == 0.0
    assert struck == 3


def braked(n: int) -> tuple[sf.Model, Any, Any, Any]:
    """Masses that slide to rest by coefficients of friction of their own: model, speeds, coefficients, parameters."""
    x = sf.RigidBody("x", sf.Joint("x", "prismatic", axis=(1, 0, 0)))
    mass = sf.RigidBody("mass", sf.Joint("z", "prismatic", axis=(0, 0, 1), parent="x"), sf.Inertia(2.0))
    foot = sf.Contact("foot", ("mass", None), GROUND, restitution=0.0, friction=sf.formula("mu"))
    system = sf.System("braked", (x, mass), parameters=(sf.Parameter("mu", 0.3),), connections=(foot,))
    model, rng = sf.compile(system), np.random.default_rng(5)
    speed, mu = rng.uniform(-2, 2, n), rng.uniform(0.2, 0.9, n)
    par = np.tile(model.parameter_values, (n, 1))
    par[:, model.names.par.index("mu")] = mu
    return model, np.stack([speed, 0 * speed], axis=1), mu, par


def test_contacts_that_hold_from_the_start_have_forces() -> None:
    """A ball that rests, slides or rolls as it begins, without an event there: its forces are those of a single run."""
    model, q = ball(), [rested(ball(), 0.1)] * 3
    v = np.zeros((3, 6))
    v[1:, 0], v[2, 4] = 1.0, 10.0
    grid = np.linspace(0, 0.1, 5)
    many = sf.simulate_batch(model, q, v, t_end=0.1, output=grid, method="rk4", dt=1e-3)
    for i, speeds in enumerate(v):
        run = sf.simulate(model, q[i], speeds, t_end=0.1, output=grid, method="rk4", dt=1e-3)
        assert many[i].lam == pytest.approx(run.lam, abs=1e-12) and run.lam[:, 0] == pytest.approx(0.4 * G, rel=1e-9)


@pytest.mark.parametrize("threads", [1, 2])
def test_each_motion_has_its_own_friction(threads: int) -> None:
    """More motions than slots: each stops after v^2/(2 mu g), at v/(mu g), in batches and in steppers of many."""
    n = 150
    model, v, mu, par = braked(n)
    many = sf.simulate_batch(model, None, v, t_end=1.2, par=par, dt=1e-2, method="rk4", threads=threads)
    stops = np.abs(v[:, 0]) / (mu * G)
    way = np.where(stops < 1.2, v[:, 0] ** 2 / (2 * mu * G), np.abs(v[:, 0]) * 1.2 - 0.5 * mu * G * 1.44)
    assert many.q[:, -1, 0] == pytest.approx(np.sign(v[:, 0]) * way, abs=1e-13)
    for i in np.flatnonzero(stops < 1.2):
        (found,) = many.events(int(i))
        assert found.name == "foot sticks" and found.t == pytest.approx(stops[i], abs=1e-13)
    steppers = sf.Steppers(model, n, par=par, dt=1e-2, method="rk4", threads=threads)
    steppers.reset(v=v)
    steppers.step(steps=120)
    assert np.array_equal(steppers.q, many.q[:, -1])


def test_an_action_changes_friction_on_the_way() -> None:
    """Rain at 1 m/s: what is left of the way is v^2/(2 mu g) with the new coefficient, of each motion."""
    model, v, mu, par = braked(5)
    v[:, 0] = np.linspace(1.2, 1.6, 5)
    rain = sf.Event("dx - 1", "falling", action={"mu": 0.1})
    many = sf.simulate_batch(model, None, v, t_end=2.0, par=par, dt=1e-2, method="rk4", events={"rain": rain})
    assert many.q[:, -1, 0] == pytest.approx((v[:, 0] ** 2 - 1) / (2 * mu * G) + 1 / (0.2 * G), abs=1e-12)
    assert [found.name for found in many.events(3)] == ["rain", "foot sticks"]


def test_steppers_of_many_are_saved_and_begin_anew() -> None:
    """Directions of sliding and instants of strikes are a part of what is saved, and forgotten where motions begin."""
    model, q, v = starts("box", 66)
    steppers = sf.Steppers(model, 66, dt=2e-3, method="rk4")
    for _ in range(2):
        steppers.reset(q, v)
        steppers.step(steps=12)
        kept = steppers.save()
        steppers.step(steps=12)
        ends = steppers.q.copy()
        steppers.restore(kept)
        steppers.step(steps=12)
        assert np.array_equal(steppers.q, ends)
    known = sf.simulate_batch(model, q, v, t_end=0.048, dt=2e-3, method="rk4")
    assert ends == pytest.approx(known.q[:, -1], abs=1e-12)


def test_balls_that_are_restored_to_a_time_before_a_strike_rebound() -> None:
    """The instant of their last strike is that of the state: one that is to come would take the rebound from it."""
    model = ball(0.7, 0.5)
    q, v = np.array([rested(model, h) for h in (0.2, 0.25, 0.3)]), np.zeros((3, 6))
    steppers = sf.Steppers(model, 3, dt=2e-3, method="rk4")
    steppers.reset(q, v)
    steppers.step(steps=20)
    kept = steppers.save()
    steppers.step(steps=100)
    ends = steppers.q.copy(), steppers.v.copy()
    steppers.restore(kept)
    steppers.step(steps=100)
    assert np.array_equal(steppers.q, ends[0]) and np.array_equal(steppers.v, ends[1])
    known = sf.simulate_batch(model, q, v, t_end=0.24, dt=2e-3, method="rk4")
    assert all(known.events(i) for i in range(3))
    assert ends[0] == pytest.approx(known.q[:, -1], abs=1e-12)
