"""Rigid contacts of balls with cylinders, capsules and boxes: closed forms (docs/theory/constraints.md, section 15)."""

from __future__ import annotations

from math import pi, sqrt
from typing import Any

import numpy as np
import pytest

import symofros as sf
from tests.simulation.rigid_scenes import FINE, GROUND, G, sphere

RADIUS = 0.1


def system_against(surface: str, friction: float, turned: sf.Rotation | None = None, **sizes: Any) -> sf.System:
    """A ball and a solid that is fixed, whose frame may be turned."""
    frame = sf.Frame("top") if turned is None else sf.Frame("top", rotation=turned)
    base = sf.RigidBody("base", sf.Joint("base", "fixed"), frames=[frame])
    laws: dict[str, Any] = {"restitution": 0.0, "friction": friction, "radius": RADIUS}
    contact = sf.Contact("top", ("ball", None), ("base", "top"), surface=surface, **sizes, **laws)  # type: ignore[arg-type]
    return sf.System("against", [base, sphere("ball", 1.0, RADIUS)], connections=[contact])


def against(surface: str, friction: float, turned: sf.Rotation | None = None, **sizes: Any) -> sf.Model:
    return sf.compile(system_against(surface, friction, turned, **sizes))


ALONG_X = sf.Rotation.axis_angle((0, 1, 0), pi / 2)
# Height of the top, where it ends, radius of the path of the ball's centre beyond.
SOLIDS: dict[str, tuple[float, float, float, sf.Rotation | None, dict[str, Any]]] = {
    "box": (0.2, 0.5, RADIUS, None, {"size": (1.0, 0.6, 0.4)}),
    "capsule": (0.3, 0.4, 0.3 + RADIUS, ALONG_X, {"surface_radius": 0.3, "length": 0.8}),
    "cylinder": (0.3, 0.0, 0.3 + RADIUS, sf.Rotation.axis_angle((1, 0, 0), pi / 2), {"surface_radius": 0.3}),
}


@pytest.mark.parametrize("surface", SOLIDS)
def test_a_ball_slides_over_an_edge_until_it_leaves(surface: str) -> None:
    """Without friction it goes straight on, then round the edge, and leaves where cos = (2 + v^2/(g rho))/3."""
    top, end, rho, turned, sizes = SOLIDS[surface]
    model, start, v = against(surface, 0.0, turned, **sizes), np.zeros(6), np.zeros(6)
    start, v[0] = model.neutral(), 0.5
    start[2] = top + RADIUS
    run = sf.simulate(model, start, v, t_end=end / v[0] + 0.5, **FINE)
    (leaves,) = run.events
    assert run.outcome.notes == () and leaves.name == "top opens"
    assert (leaves.q[2] - top - RADIUS) / rho + 1 == pytest.approx((2 + v[0] ** 2 / (G * rho)) / 3, abs=1e-9)
    straight = run.q[run.t < end / v[0]]
    assert np.abs(straight[:, 2] - top - RADIUS).max(initial=0.0) < 1e-12


@pytest.mark.parametrize("given", [FINE, {"method": "rk4", "dt": 7e-4}, {"method": "rodas4"}])
def test_no_record_of_a_ball_that_leaves_at_the_edge_at_once_says_that_it_is_drawn(given: dict[str, Any]) -> None:
    """At more than sqrt(g R) its force jumps from m g to zero; m (g - v^2/R) draws, of the mode that ends there."""
    top, end, _, _, sizes = SOLIDS["box"]
    model, v = against("box", 0.0, **sizes), [1.5, 0.0, 0.0, 0.0, 0.0, 0.0]
    start = model.neutral()
    start[2] = top + RADIUS
    run = sf.simulate(model, start, v, t_end=0.5, **given)
    (leaves,) = run.events
    assert leaves.name == "top opens" and leaves.t == pytest.approx(end / v[0], abs=1e-5)
    push = run.contact_forces().push[:, 0]
    assert push == pytest.approx(np.where(run.t < leaves.t, G, 0.0), abs=1e-6)
    assert run.a[run.t >= leaves.t, 2] == pytest.approx(-G, abs=1e-9)


def test_a_ball_that_rolls_in_an_upright_cylinder_comes_up_again() -> None:
    """Its height swings harmonically, sqrt(2/7) times as fast as it goes round: why golf balls leave their holes."""
    rate, way = 12.0, 0.4
    model = against("cylinder", 100.0, surface_radius=way + RADIUS, inside=True)
    start, v = model.neutral(), [0.0, rate * way, 0.0, 0.0, 0.0, -rate * way / RADIUS]
    start[0] = way
    run = sf.simulate(model, start, v, t_end=2.0, **FINE)
    swing = sqrt(2 / 7) * rate
    assert run.events == () and run.t[-1] > 2 * pi / swing
    assert run.q[:, 2] == pytest.approx(-5 / 7 * G / swing**2 * (1 - np.cos(swing * run.t)), abs=1e-9)
    assert np.linalg.norm(run.q[:, :2], axis=1) == pytest.approx(way, abs=1e-11)


def test_points_have_no_normal_of_a_box() -> None:
    """A point that meets a box is refused; with a radius it is a ball."""
    ball, sizes = sphere("ball", 1.0, RADIUS), {"surface": "box", "size": (1.0, 1.0, 1.0)}
    contact = sf.Contact("c", ("ball", None), GROUND, restitution=0.0, **sizes)  # type: ignore[arg-type]
    with pytest.raises(sf.DescriptionError, match="radius above zero"):
        sf.compile(sf.System("s", [ball], connections=[contact]))
