"""Events with actions where the caller makes the steps: one motion, and many."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.models import bounds
from tests.simulation.grasping import PLAN, docking, model_of, tumbling
from tests.simulation.mechanisms import slide
from tests.simulation.rigid_scenes import G, box, rested


@pytest.mark.parametrize("method", ["rk4", "generalized_alpha", "dopri5"])
def test_a_stepper_acts_as_a_run_does(method: str) -> None:
    """To the last bit by fixed steps, with the same events; states are kept and put back with the modes in them."""
    model = model_of(pose="moment")
    q, v = tumbling(model)
    options: dict[str, Any] = {"dt": 1e-3, "method": method, "events": PLAN} | bounds(method, 1e-10, 1e-12)
    run = sf.simulate(model, q, v, 0.06, **options)
    stepper = sf.Stepper(model, **options)
    stepper.reset(q, v)
    stepper.step(steps=30)
    held, par = stepper.save(), stepper.par.copy()
    assert par[model.names.par.index("grip")] == 1.0 and len(stepper.events) == 1
    for other in (stepper, stepper.copy()):
        while other.t < 0.06 - 1e-9:
            assert other.step()
        assert other.outcome.ok and [found.name for found in other.events] == ["grab", "drop"]
        if method == "dopri5":
            assert np.abs(other.q - run.q[-1]).max() < 1e-8
        else:
            assert np.array_equal(other.q, run.q[-1]) and np.array_equal(other.v, run.v[-1])
            pairs = zip(other.events, run.events, strict=True)
            assert all(np.array_equal(a.v_after, b.v_after) and a.energy_lost == b.energy_lost for a, b in pairs)
    end = stepper.q.copy()
    stepper.restore(held)
    assert np.array_equal(stepper.par, par) and len(stepper.events) == 1
    for _ in range(30):
        stepper.step()
    assert np.array_equal(stepper.q, end)
    stepper.reset(q, v)
    assert stepper.par[model.names.par.index("grip")] == 0.0 and stepper.step(steps=60)
    assert [found.name for found in stepper.events] == ["grab", "drop"]


@pytest.mark.parametrize(("method", "threads"), [("rk4", 2), ("dopri5", 1)])
def test_each_of_many_acts_as_one_alone(method: str, threads: int) -> None:
    """Modes, parameters and events are its own, whoever shares its thread; kept states have them."""
    model, rng, n = model_of(pose="moment"), np.random.default_rng(5), 5
    q, v = (np.array(rows) for rows in zip(*(model.random_state(rng) for _ in range(n)), strict=True))
    options: dict[str, Any] = {"dt": 1e-3, "method": method} | bounds(method, 1e-10, 1e-12)
    mixed = PLAN | {"late": sf.Event("q1 - 0.3", action={"m": "2*m"}, once=True)}
    many = sf.simulate_batch(model, q, v, 0.06, events=mixed, threads=threads, output=0.01, **options)
    for i in range(n):
        run, one = sf.simulate(model, q[i], v[i], 0.06, events=mixed, **options), many[i]
        assert one.outcome.ok and one.outcome.notes == run.outcome.notes
        assert [found.name for found in one.events] == [found.name for found in run.events]
        assert np.abs(many.q_last[i] - run.q[-1]).max() < 1e-9
        assert np.allclose(one.par_over_time[-1], run.par_over_time[-1], atol=1e-9)
        for mine, other in zip(one.events, run.events, strict=True):
            assert mine.t == pytest.approx(other.t, abs=1e-10)
            assert mine.energy_lost == pytest.approx(other.energy_lost, abs=1e-7)
    if method == "dopri5":
        return
    steppers = sf.Steppers(model, n, events=mixed, threads=threads, dt=1e-3)
    steppers.reset(q, v)
    steppers.step(steps=30)
    held = steppers.save()
    others = steppers.copy()
    for these in (steppers, others):
        assert these.step(steps=30).all() and np.abs(these.q - many.q_last).max() < 1e-12
        assert [found.name for found in these.events(2)] == [found.name for found in many.events(2)]
    end = steppers.q.copy()
    steppers.restore(held)
    assert len(steppers.events(2)) < len(others.events(2)) and steppers.step(steps=30).all()
    assert np.array_equal(steppers.q, end) and np.array_equal(steppers.par, others.par)
    steppers.reset(q, v, which=np.arange(n) == 2)
    assert steppers.step().all() and not steppers.events(2) and np.array_equal(steppers.par[2], model.parameter_values)


def test_one_of_many_whose_action_fails_ends_alone() -> None:
    """In the words of a run; bounces that become ever shorter end before they fall through."""
    ball = slide(name="z", axis=(0, 0, 1), gravity=(0, 0, -10))
    model, heights = sf.compile(ball), np.array([[0.2], [5.0]])
    events = {"contact": sf.Event("z", "falling", action={"dz": "-0.5*dz"}), "deep": sf.Event("z + 1", terminal=True)}
    many = sf.simulate_batch(model, heights, t_end=0.9, dt=2e-3, events=events)
    steppers = sf.Steppers(model, 2, dt=2e-3, events=events)
    steppers.reset(heights)
    steppers.step(steps=450)
    for outcome in (many.outcome(0), steppers.outcome(0)):
        assert outcome.kind == "interrupted" and "'contact' acts again" in outcome.reason
        assert outcome.t == pytest.approx(0.6, abs=1e-4)
    assert many.outcome(1).ok and steppers.running.tolist() == [False, True] and not many.events(1)


def test_impossible_actions_end_the_motion_of_a_stepper() -> None:
    """As it ends a run, in the same words."""
    model, q, v = docking()
    for action in ({"grip": 1}, {"grip": 0.5}, {"dq1": "1/grip"}):
        events = {"dock": sf.Event("t - 1e-3", action=action)}
        stepper = sf.Stepper(model, dt=1e-4, events=events)
        stepper.reset(q, v)
        assert not stepper.step(steps=50)
        assert stepper.outcome == sf.simulate(model, q, v, 0.01, dt=1e-4, events=events).outcome


def test_a_reset_forgets_modes_that_were_chosen_without_an_event() -> None:
    """A box that stood, and is thrown upwards from above the ground."""
    model = box(0.3)
    stepper = sf.Stepper(model, dt=1e-3)
    stepper.reset(rested(model, 0.1))
    assert stepper.step() and not stepper.events
    stepper.reset(rested(model, 0.2), [0, 0, 1.0, 0, 0, 0])
    assert stepper.step(steps=10) and stepper.q[2] == pytest.approx(0.2 + 0.01 - 0.5 * G * 1e-4, abs=1e-12)
