"""Rigid contacts by Rosenbrock methods: derivatives of friction (docs/theory/constraints.md, section 15, (41a))."""

from __future__ import annotations

from functools import cache
from math import log2
from typing import Any, Literal

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import symofros as sf
from tests.simulation.contacts.test_rigid_rims import in_body, tilted
from tests.simulation.rigid_scenes import FINE, GROUND, G, ball, disc_system, in_shell, point, rested, rod

Fixed = Literal["rodas4", "implicit_euler"]


@cache
def sliding(name: str) -> tuple[sf.Model, Any, Any]:
    """A body that slides askew while it turns, and goes on to: model, coordinates, speeds."""
    if name == "rim":
        model = sf.compile(disc_system(0.2))
        v = np.array(in_body(0.9, np.array([1.0, -8.0, 12.0])))
        return model, tilted(model, 0.9), v
    if name == "shell":
        model = sf.compile(in_shell(0.3, (0, 1, 0), 2.5))
        q = model.neutral()
        q[0] = 0.4
        return model, q, {"ball.vy": 3.0, "ball.vz": 2.0, "ball.wx": 3.0}
    foot, w = (0.1, 0.05, -0.2), np.array([1.0, 2.0, 3.0])
    body = sf.RigidBody("body", sf.Joint("free", "free"), sf.Inertia(1.0, moments=(0.02, 0.03, 0.04)))
    contact = sf.Contact("foot", ("body", None), GROUND, restitution=0.0, friction=0.2, points=(foot,), radius=0.05)
    model = sf.compile(sf.System("body", (body,), connections=(contact,)))
    return model, rested(model, 0.25), np.array([1.0, 0.5, -np.cross(w, foot)[2], *w])


@pytest.mark.parametrize(("method", "order"), [("rodas4", 4), ("implicit_euler", 1)])
@pytest.mark.parametrize("name", ["foot", "shell", "rim"])
def test_steps_converge_at_their_order_while_balls_slide(name: str, method: Fixed, order: int) -> None:
    """It falls to 2 or less without any of the terms of (41a), or where friction acts beside the point of the rows."""
    model, q, v = sliding(name)
    known = sf.simulate(model, q, v, t_end=0.024, **FINE).v[-1]
    ends = [sf.simulate(model, q, v, t_end=0.024, method=method, adaptive=False, dt=dt).v[-1] for dt in (4e-3, 2e-3)]
    coarse, fine = (np.abs(end - known).max() for end in ends)
    assert log2(coarse / fine) == pytest.approx(order, abs=0.35) and fine < (1e-7 if order == 4 else 0.1)


@pytest.mark.parametrize("method", ["rk4", "rodas4"])
def test_a_slip_that_turns_past_a_right_angle_does_not_disturb_steps(method: Literal["rk4", "rodas4"]) -> None:
    """A mass thrown up and across an incline: its event is at the right angle, and steps keep their order across it."""
    friction, gx, start = 0.3, 4.0, np.array([-1.0, 0.6])

    def rates(_: float, v: Any) -> Any:
        return np.array([gx, 0.0]) - friction * G * v / np.linalg.norm(v)

    def across(_: float, v: Any) -> Any:
        return v @ start

    known = solve_ivp(rates, (0, 0.5), start, "DOP853", rtol=1e-12, atol=1e-13, events=across)
    run = sf.simulate(
        point(friction, (gx, 0, -G)), None, [*start, 0.0], t_end=0.5, method=method, adaptive=False, dt=5e-3
    )
    assert [found.name for found in run.events] == ["foot turns"]
    assert run.events[0].t == pytest.approx(known.t_events[0][0], abs=1e-7)
    assert run.v[-1, :2] == pytest.approx(known.y[:, -1], abs=1e-7) and np.linalg.norm(known.y[:, -1]) > 0.4


@pytest.mark.parametrize("scene", ["ball", "rod"])
def test_events_are_those_of_explicit_runs(scene: str) -> None:
    """Strikes, slides and sticks at their instants, with the energy that each takes."""
    model = ball(0.5, 0.5) if scene == "ball" else rod(0.4, 0.3)
    q = rested(model, 0.2) if scene == "ball" else [0.0, np.cos(0.5) + 0.05, 0.5]
    v = [2.0, 0.5, 0.0, 0.0, -5.0, 3.0] if scene == "ball" else [1.0, 0.0, 0.0]
    known = sf.simulate(model, q, v, t_end=0.5, **FINE)
    run = sf.simulate(model, q, v, t_end=0.5, method="rodas4", rtol=1e-8, atol=1e-11)
    assert len(known.events) >= 3
    for found, other in zip(run.events[:5], known.events[:5], strict=True):
        assert found.name == other.name and found.t == pytest.approx(other.t, abs=1e-7)
        assert found.energy_lost == pytest.approx(other.energy_lost, abs=1e-6)
    assert run.q[-1] == pytest.approx(known.q[-1], abs=1e-5)


@pytest.mark.parametrize("method", ["rodas4", "implicit_euler"])
def test_a_slip_against_stiff_damping_takes_long_steps(method: Any) -> None:
    """Its speed settles in 2 us at (weight along the plane - friction)/damping; explicit steps of 10 ms lose it."""
    mass, mu, along, damping = 2.0, 0.3, 5.0, 1e6
    slide = sf.RigidBody("x", sf.Joint("x", "prismatic", axis=(1, 0, 0), elements=(sf.Damper(damping),)))
    body = sf.RigidBody("z", sf.Joint("z", "prismatic", axis=(0, 0, 1), parent="x"), sf.Inertia(mass))
    foot = sf.Contact("foot", ("z", None), GROUND, restitution=0.0, friction=mu)
    model = sf.compile(sf.System("honey", (slide, body), connections=(foot,), gravity=(along, 0, -G)))
    settled = mass * (along - mu * G) / damping
    run = sf.simulate(model, None, [settled / 2, 0.0], t_end=1.0, method=method, adaptive=False, dt=1e-2)
    assert run.outcome.kind == "finished" and run.events == ()
    assert run.v[-1, 0] == pytest.approx(settled, rel=1e-9)
    assert run.contact_forces().force[-1, 0] == pytest.approx([-mu * mass * G, 0.0, mass * G], rel=1e-9)
    assert sf.simulate(model, None, [settled / 2, 0.0], t_end=1.0, dt=1e-2).outcome.kind != "finished"


@pytest.mark.parametrize("method", ["generalized_alpha", "variational", "cvode", "ida"])
def test_other_implicit_methods_name_those_that_do(method: Any) -> None:
    """They keep equations or past steps in which no mode ends."""
    with pytest.raises(sf.SymofrosError, match="rigid|constraints") as refused:
        sf.simulate(ball(), rested(ball(), 0.3), t_end=0.1, method=method, stabilisation="none")
    assert method == "variational" or "rodas4 or implicit_euler" in str(refused.value)
