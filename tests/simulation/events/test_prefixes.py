"""A motion up to an instant is the same whatever the end of its run (docs/theory/simulation.md, section 2)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.simulation.contacts.test_resting import ball as held_ball
from tests.simulation.contacts.test_resting import floor
from tests.simulation.rigid_scenes import ball_system

FIXED: dict[str, Any] = {"method": "rk4", "dt": 1e-2}
ADAPTIVE: dict[str, dict[str, Any]] = {
    "dopri5": {"method": "dopri5", "rtol": 1e-8, "atol": 1e-10},
    "dop853": {"method": "dop853", "rtol": 1e-8, "atol": 1e-10},
    "rodas4": {"method": "rodas4", "rtol": 1e-8, "atol": 1e-10},
}
# With a share of the run's time as an instant, strikes would accumulate at others.
SHORT, LONG = 1.0, 10.0


def bouncing() -> dict[str, Any]:
    """A ball comes to rest on a floor by strikes that accumulate, held by a switch."""
    return {"model": held_ball(), "q0": [0.2], "events": floor()}


def rigid() -> dict[str, Any]:
    """A ball with spin on a rigid plane."""
    model = sf.compile(ball_system())
    q = model.neutral()
    q[2] = 0.15
    return {"model": model, "q0": q, "v0": [0.3, 0, 0, 0, 2.0, 0]}


def sticking() -> dict[str, Any]:
    """A block on a spring whose friction sticks, driven at 1 Hz."""
    elements = (sf.Friction(0.5, sticks=True), sf.Spring(40.0))
    body = sf.RigidBody("block", sf.Joint("s", "prismatic", elements=elements, actuated=True), sf.Inertia(1.0))
    return {"model": sf.compile(sf.System("block", (body,))), "q0": [0.1], "u": {"s": "sin(2*pi*t)"}}


def counting() -> dict[str, Any]:
    """A pendulum-like mass whose spring changes side by events that act."""
    body = sf.RigidBody("mass", sf.Joint("x", "prismatic", actuated=True), sf.Inertia(1.0))
    model = sf.compile(sf.System("mass", (body,), (sf.Parameter("side", 1.0),)))
    turns = {"turn": sf.Event("x", "both", action={"side": "-side"})}
    return {"model": model, "q0": [0.1], "u": {"x": "-50*x - side"}, "events": turns}


MOTIONS: dict[str, Callable[[], dict[str, Any]]] = {
    "bouncing": bouncing,
    "rigid": rigid,
    "sticking": sticking,
    "counting": counting,
}


@pytest.mark.parametrize("motion", MOTIONS)
def test_fixed_steps_are_the_beginning_of_a_longer_run(motion: str) -> None:
    """Bit by bit, and those that are made by hand, or in a batch, have the same events."""
    given = MOTIONS[motion]()
    short, long = (sf.simulate(t_end=t_end, **given, **FIXED) for t_end in (SHORT, LONG))
    for name in ("t", "q", "v"):
        np.testing.assert_array_equal(getattr(short, name), getattr(long, name)[: len(short.t)])
    times = [found.t for found in short.events]
    assert times and times == [found.t for found in long.events[: len(times)]]
    many = sf.simulate_batch(t_end=SHORT, **given | {"q0": [given["q0"]]}, **FIXED)
    np.testing.assert_allclose([found.t for found in many.events(0)], times, rtol=0, atol=1e-12)


@pytest.mark.parametrize("method", ADAPTIVE)
@pytest.mark.parametrize("motion", MOTIONS)
def test_adaptive_steps_meet_what_those_of_a_longer_run_meet(motion: str, method: str) -> None:
    """The end of a run cuts its last step, and an event within it is met by another interpolation: to the tolerance."""
    given = MOTIONS[motion]()
    short, long = (sf.simulate(t_end=t_end, **given, **ADAPTIVE[method]) for t_end in (SHORT, LONG))
    met, later = ([(found.name, found.t) for found in run.events if found.t < SHORT] for run in (short, long))
    assert met and [name for name, _ in met] == [name for name, _ in later]
    np.testing.assert_allclose([t for _, t in met], [t for _, t in later], rtol=0, atol=1e-6)
    n = int(np.searchsorted(short.t, met[0][1]))
    np.testing.assert_array_equal(short.q[:n], long.q[:n])
