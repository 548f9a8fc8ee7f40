"""Instants of formulas of time by any method, of each motion by its own parameters (docs/theory/simulation.md)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf

# Where two pulses or events do not lie, and three where they do [s].
ELSEWHERE, PLACES = 1.0, np.array([[2.0], [5.3], [7.7]])
# 1 N s within 20 ms about `at`.
PULSE = "100*max(0, 1 - abs(t - at)/0.01)"


def mass(force: str = "0") -> sf.Model:
    """A mass of 1 kg that slides freely, and a force on it."""
    body = sf.RigidBody("mass", sf.Joint("x", "prismatic", axis=(1, 0, 0), actuated=True), sf.Inertia(1.0))
    power = (sf.VirtualPower("force", (("dx", sf.formula(force)),)),)
    at = (sf.Parameter("at", ELSEWHERE),)
    return sf.compile(sf.System("mass", (body,), at, gravity=(0, 0, 0), virtual_power=power))


METHODS = ("rk4", "euler", "semi_implicit_euler", "implicit_euler", "generalized_alpha", "variational")


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("jump", [0.0, 0.3, 0.57])
def test_a_force_that_jumps_at_the_end_of_a_fixed_step_counts_from_there_on(method: str, jump: float) -> None:
    """Force times time, exactly: neither half the force at the jump, nor a derivative across it."""
    law, span = f"max(0, sign(t - {jump}))", 0.9
    cases: list[tuple[sf.Model, dict[str, Any]]] = [(mass(), {"u": {"x": law}}), (mass(law), {})]
    for model, given in cases:
        run = sf.simulate(model, t_end=span, method=method, dt=0.01, **given)
        assert run.v[-1] == pytest.approx(span - jump, abs=1e-12) and not run.outcome.notes
        stepper = sf.Stepper(model, method=method, dt=0.01, **given)
        stepper.reset()
        stepper.step(None, steps=round(span / 0.01))
        np.testing.assert_array_equal(stepper.v, run.v[-1])
        if method in ("rk4", "euler", "semi_implicit_euler"):
            many = sf.simulate_batch(model, np.zeros((3, 1)), t_end=span, method=method, dt=0.01, **given)
            np.testing.assert_array_equal(many.v[:, -1], [run.v[-1]] * 3)


def test_a_run_ends_before_a_jump_at_its_end() -> None:
    """As a longer run does, bit by bit."""
    model = mass("1 + max(0, sign(t - 0.5))")
    short, long = (sf.simulate(model, t_end=t_end, dt=0.1) for t_end in (0.5, 1.0))
    np.testing.assert_array_equal(short.v, long.v[: len(short.v)])
    assert short.v[-1] == pytest.approx(0.5, abs=1e-14)


def test_a_prescribed_acceleration_that_jumps_leaves_the_order_of_fixed_steps() -> None:
    """A pendulum on a carriage that is pushed on and braked: rates of a formula with corners are no mean at them."""
    carriage = sf.RigidBody("carriage", sf.Joint("s", "prismatic", axis=(1, 0, 0), prescribed=True), sf.Inertia(1.0))
    rod = sf.Inertia(1.0, (0, 0, -0.5), (0.1, 0.1, 0.01))
    system = sf.System(
        "crane", (carriage, sf.RigidBody("rod", sf.Joint("q", "revolute", "carriage", axis=(0, 1, 0)), rod))
    )
    model, law = sf.compile(system), {"s": "t^2 - 2*max(0, t - 0.5)^2 + max(0, t - 1)^2"}
    ends = [sf.simulate(model, t_end=1.5, u=law, dt=dt).q[-1, 0] for dt in (0.02, 0.01, 0.005)]
    assert abs(ends[1] - ends[2]) < 1e-7 and abs(ends[0] - ends[1]) > 8 * abs(ends[1] - ends[2])


@pytest.mark.parametrize("method", ["rk4", "dopri5", "dop853"])
def test_trajectories_meet_pulses_at_instants_of_their_own(method: str) -> None:
    """Those of the first trajectory's parameters are not those of the others, nor are they after an action."""
    model = mass(PULSE)
    many = sf.simulate_batch(model, np.zeros((3, 1)), t_end=10.0, par=PLACES, method=method)
    np.testing.assert_allclose(many.v[:, -1, 0], 1.0, atol=1e-6)
    moved = {"move": sf.Event("t - 0.5", action={"at": 8.2})}
    many = sf.simulate_batch(model, np.zeros((2, 1)), t_end=10.0, events=moved, method=method)
    np.testing.assert_allclose(many.v[:, -1, 0], 1.0, atol=1e-6)
    run = sf.simulate(model, t_end=10.0, events=moved, method=method)
    stepper = sf.Stepper(model, events=moved, method=method, dt=10.0 if method != "rk4" else 1e-3)
    stepper.reset()
    stepper.step(None, steps=1 if method != "rk4" else 10000)
    # Tighter tolerances are held against the run with these instants, too.
    for v, outcome in ((run.v[-1], run.outcome), (stepper.v, stepper.outcome), (many.v[1, -1], many.outcome(1))):
        assert v == pytest.approx(1.0, abs=1e-6) and not outcome.notes, outcome


@pytest.mark.parametrize("formula", ["exp(-((t - at)/0.001)^2) - 0.5", "max(0, 1 - abs(t - at)/0.001) - 0.5"])
@pytest.mark.parametrize("given", [{"dt": 0.13}, {"method": "dopri5"}])
def test_trajectories_meet_events_at_instants_of_their_own(given: dict[str, Any], formula: str) -> None:
    model, events = mass(), {"narrow": formula}
    singles = [[e.t for e in sf.simulate(model, t_end=10.0, par=par, events=events, **given).events] for par in PLACES]
    many = sf.simulate_batch(model, np.zeros((3, 1)), t_end=10.0, par=PLACES, events=events, **given)
    for k, (single, place) in enumerate(zip(singles, PLACES, strict=True)):
        assert len(single) == 2 and np.mean(single) == pytest.approx(place[0], abs=1e-9)
        np.testing.assert_allclose([e.t for e in many.events(k)], single, rtol=0, atol=1e-12)
    moved = {"narrow": sf.Event(formula, "rising"), "move": sf.Event("t - 0.5", action={"at": 8.2})}
    many = sf.simulate_batch(model, np.zeros((2, 1)), t_end=10.0, events=moved, **given)
    assert [e.name for e in many.events(1)] == ["move", "narrow"]


def test_steppers_look_ahead_of_each_motion() -> None:
    """Events and jumps by its parameters, also by those that a reset gives, and beyond 1024 steps."""
    formula, places = "exp(-((t - at)/1e-4)^2) - 0.5", np.tile(np.linspace(0.5, 12.0, 5), 14)[:, np.newaxis]
    model = mass("max(0, sign(t - at))")
    with_events = sf.Steppers(model, 70, par=places, events={"narrow": formula}, dt=0.01)
    without = sf.Steppers(model, 70, par=places, dt=0.01)
    for steppers in (with_events, without):
        steppers.reset()
        steppers.step(steps=1250)
        np.testing.assert_allclose(steppers.v, 12.5 - places, rtol=0, atol=0.011)
    assert [len(with_events.events(k)) for k in range(70)] == [2] * 70
    early = places[::-1] + 0.003  # In groups of 64: the others have had their slots.
    with_events.reset(par=early)
    with_events.step(steps=1250)
    for k in (0, 35, 69):
        assert np.mean([e.t for e in with_events.events(k)]) == pytest.approx(early[k, 0], abs=1e-9)
