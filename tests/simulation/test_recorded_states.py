"""What a run records is what it goes on from, whenever it is recorded."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.simulation.settings import CLOSED
from tests.models import GUESSES, compiled

# Of |phi| and |G v - b| after a projection.
PROJECTED = 1e-12
T_END, DT = 0.2, 1e-2
# Within steps, at their ends, and at the end of the run.
TIMES = (0.0, 0.0137, 0.05, 0.1099, 0.11, T_END)
OWN = ("rk4", "semi_implicit_euler", "euler", "dopri5", "dop853", "implicit_euler", "rodas4", "generalized_alpha")
# Closed loops of one and several freedoms, rolling, a condition on speeds alone; then balls and free bases.
CLOSED_MODELS = ("four_bar", "slider_crank", "rolling_disc", "sleigh")
TREES = ("gyroscope", "space_arm")


@cache
def scene(name: str) -> tuple[sf.Model, np.ndarray, np.ndarray]:
    model = compiled(name)
    q, v = model.random_state(np.random.default_rng(3))
    if model.nc:
        assembled = sf.assemble(model, GUESSES[name], 0.5 * v)
        q, v = assembled.q, assembled.v
    return model, q, v


def largest_violation(model: sf.Model, q: np.ndarray, v: np.ndarray) -> float:
    both = np.concatenate([model.constraint(q), model.constraint_rate(q, v)], axis=-1)
    return float(np.abs(both).max(initial=0.0))


def quaternion_lengths(model: sf.Model, q: np.ndarray) -> np.ndarray:
    starts = [s.q + 3 * (s.kind == "pose") for s in model.record.segments if s.kind != "linear"]
    return np.array([np.linalg.norm(q[:, i : i + 4], axis=1) for i in starts])


@pytest.mark.parametrize("method", OWN)
@pytest.mark.parametrize("name", [*CLOSED_MODELS, *TREES])
def test_states_at_given_times_match_a_run_recorded_at_every_step(name: str, method: str) -> None:
    model, q, v = scene(name)
    every = sf.simulate(model, q, v, T_END, method=method, dt=DT)
    given = sf.simulate(model, q, v, T_END, method=method, dt=DT, output=TIMES)
    assert given.outcome.kind == every.outcome.kind == "finished" and given.statistics.steps == every.statistics.steps
    for i, t in enumerate(given.t):
        at = np.flatnonzero(np.abs(every.t - t) < 1e-12)
        for k in at:
            np.testing.assert_array_equal(given.q[i], every.q[k])
            np.testing.assert_array_equal(given.v[i], every.v[k])
    assert given.t[-1] == every.t[-1] == T_END
    assert largest_violation(model, given.q[1:], given.v[1:]) < PROJECTED
    np.testing.assert_allclose(quaternion_lengths(model, given.q), 1.0, atol=1e-14)


@pytest.mark.parametrize("method", ["semi_implicit_euler", "dopri5", "generalized_alpha"])
def test_events_lie_on_the_constraints_and_end_the_run_there(method: str) -> None:
    """The event is a zero of its formula where the run ends, after the projection."""
    model, q, v = scene("slider_crank")
    middle = float(sf.simulate(model, q, v, 0.0937, method=method, dt=DT).q[-1, 0])
    events = {"passing": sf.Event(f"{model.names.q[0]} - ({middle!r})", terminal=True)}
    run = sf.simulate(model, q, v, T_END, method=method, dt=DT, events=events)
    assert run.outcome.kind == "event" and len(run.events) == 1
    np.testing.assert_array_equal(run.events[0].q, run.q[-1])
    np.testing.assert_array_equal(run.events[0].v, run.v[-1])
    assert largest_violation(model, run.q[-1:], run.v[-1:]) < PROJECTED
    assert run.q[-1, 0] == pytest.approx(middle, abs=1e-12)


def test_a_projection_that_fails_names_the_constraint_and_how_far_it_is_off() -> None:
    """The slider of a slider-crank is led beyond the reach of crank and rod together."""
    system = MODELS["slider_crank"]
    bodies = [
        replace(body, joint=replace(body.joint, prescribed=True)) if body.name == "slider" else body
        for body in system.bodies
    ]
    model = sf.compile(replace(system, name="led_slider_crank", bodies=bodies))
    turn, swing = np.arccos(0.4375 / 0.45), -1.5 * np.arccos(0.4375 / 0.45)
    start = sf.assemble(model, [turn, swing], u=[0.0, 0.4375, 0.0, 0.0])
    run = sf.simulate(model, start.q, start.v, 1.0, u={"slide": "0.4375 + 0.1*t^2"}, dt=1e-2)
    assert run.outcome.kind == "constraints lost" and "'gudgeon" in run.outcome.reason
    assert float(run.outcome.reason.split("off by ")[1].split()[0]) > CLOSED


@pytest.mark.parametrize("method", ["rk4", "rodas4", "generalized_alpha"])
def test_records_within_steps_of_turning_bodies_follow_the_motion(method: str) -> None:
    """Where coordinates are more than speeds, too: cubics by the rates at both ends, off by no more than the steps."""
    body = sf.RigidBody("top", sf.Joint("j", "ball"), sf.Inertia(1.0, (0.1, 0.2, 0.5), (0.3, 0.4, 0.2)))
    model = sf.compile(sf.System("top", (body,)), sf.Options(backend="tape"))
    start = model.neutral(), np.array([2.0, -3.0, 4.0])
    grid = np.arange(0.0, 0.201, 0.0125)
    exact = sf.simulate(model, *start, 0.2, method="dop853", rtol=1e-11, atol=1e-12, output=grid)
    run = sf.simulate(
        model, *start, 0.2, method=method, dt=0.05, output=grid, adaptive=False if method == "rodas4" else None
    )
    at_steps = np.abs(run.v[::4] - exact.v[::4]).max()
    assert np.abs(run.v - exact.v).max() <= 1.5 * at_steps + 2e-3
    np.testing.assert_allclose(run.q, exact.q, atol=1.5 * np.abs(run.q[::4] - exact.q[::4]).max() + 1e-3)
