"""Scenes of rigid contacts: a mass, a ball, a rod, a box, a disc on a plane."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from math import cos, sin
from typing import Any

import symofros as sf

G = 9.81
GROUND = ("world", None)
FINE: dict[str, Any] = {"method": "dopri5", "rtol": 1e-11, "atol": 1e-13}


def point(friction: float, gravity: tuple[float, float, float] = (0, 0, -G), e: float = 0.0) -> sf.Model:
    """A mass of 2 kg that does not turn, on a plane."""
    x, y = (sf.RigidBody(n, sf.Joint(n, "prismatic", axis=a, parent=p)) for n, a, p in _SLIDES)
    axis = sf.Joint("z", "prismatic", axis=(0, 0, 1), parent="y")
    foot = sf.Contact("foot", ("z", None), GROUND, restitution=e, friction=friction)
    bodies = (x, y, sf.RigidBody("z", axis, sf.Inertia(2.0)))
    return sf.compile(sf.System("point", bodies, connections=(foot,), gravity=gravity))


def guided(friction: float) -> sf.Model:
    """A sledge of 1 kg on a cross-beam of 3 kg, led along a line askew on the plane."""
    x, y = (sf.RigidBody(n, sf.Joint(n, "prismatic", axis=a, parent=p)) for n, a, p in _SLIDES)
    x = replace(x, inertia=sf.Inertia(3.0))
    axis = sf.Joint("z", "prismatic", axis=(0, 0, 1), parent="y")
    foot = sf.Contact("foot", ("z", None), GROUND, restitution=0.0, friction=friction)
    line = sf.Coupling("line", "y - 0.5*x")
    bodies = (x, y, sf.RigidBody("z", axis, sf.Inertia(1.0)))
    return sf.compile(sf.System("guided", bodies, connections=(foot,), constraints=(line,)))


_SLIDES = (("x", (1, 0, 0), "world"), ("y", (0, 1, 0), "x"))


def ball_system(e: float = 0.5, friction: float = 0.5) -> sf.System:
    """A homogeneous ball above the ground."""
    body = sf.RigidBody("ball", sf.Joint("free", "free"), sf.Inertia(0.4, moments=(1.6e-3,) * 3))
    floor = sf.Contact("floor", ("ball", None), GROUND, restitution=e, friction=friction, radius=0.1)
    return sf.System("ball", (body,), connections=(floor,))


@cache
def ball(e: float = 0.5, friction: float = 0.5) -> sf.Model:
    """The same, compiled."""
    return sf.compile(ball_system(e, friction))


def rod_system(friction: Any, e: float = 0.0) -> sf.System:
    """A rod of 1 kg and 2 m in a plane, whose lower tip touches the ground: Painleve's."""
    x = sf.RigidBody("x", sf.Joint("x", "prismatic", axis=(1, 0, 0)))
    z = sf.RigidBody("z", sf.Joint("z", "prismatic", axis=(0, 0, 1), parent="x"))
    turning = sf.Joint("angle", "revolute", axis=(0, 1, 0), parent="z")
    body = sf.RigidBody("rod", turning, sf.Inertia(1.0, moments=(1 / 3, 1 / 3, 1e-3)))
    tip = sf.Contact("tip", ("rod", None), GROUND, restitution=e, friction=friction, points=[(0, 0, -1)])
    return sf.System("rod", (x, z, body), connections=(tip,))


@cache
def rod(friction: float, e: float = 0.0) -> sf.Model:
    """The same, compiled."""
    return sf.compile(rod_system(friction, e))


def box_system(
    friction: float, gravity: tuple[float, float, float] = (0, 0, -G), height: float = 0.1, e: float = 0.0
) -> sf.System:
    """A box of 2 kg on four feet, at whose centre a force draws."""
    pull = sf.Load(force=(sf.formula("pull"), 0, 0), axes="world")
    inertia = sf.Inertia(2.0, moments=(0.02, 0.03, 0.04))
    body = sf.RigidBody("box", sf.Joint("free", "free"), inertia, loads=(pull,))
    feet = [(x, y, -height) for x in (-0.2, 0.2) for y in (-0.1, 0.1)]
    sole = sf.Contact("sole", ("box", None), GROUND, restitution=e, friction=friction, points=feet)
    return sf.System("box", (body,), inputs=(sf.Input("pull"),), connections=(sole,), gravity=gravity)


def box(friction: float, gravity: tuple[float, float, float] = (0, 0, -G), **stated: float) -> sf.Model:
    """The same, compiled."""
    return sf.compile(box_system(friction, gravity, **stated))


def sphere(name: str, mass: float, radius: float, *frames: sf.Frame) -> sf.RigidBody:
    """A free homogeneous ball."""
    inertia = sf.Inertia(mass, moments=(0.4 * mass * radius**2,) * 3)
    return sf.RigidBody(name, sf.Joint(name, "free"), inertia, frames=frames)


def in_shell(friction: float, axis: tuple[float, float, float] = (1, 0, 0), angle: float = 0.0) -> sf.System:
    """A ball inside a free shell, whose frame of contact is turned about an axis; without weight."""
    shell = sphere("shell", 2.0, 0.5, sf.Frame("hollow", rotation=sf.Rotation.axis_angle(axis, angle)))
    sizes: dict[str, Any] = {"surface": "sphere", "inside": True, "radius": 0.1, "surface_radius": 0.5}
    contact = sf.Contact("wall", ("ball", None), ("shell", "hollow"), restitution=0.0, friction=friction, **sizes)
    bodies = [sphere("ball", 1.0, 0.1), shell]
    return sf.System("in_shell", bodies, gravity=(0, 0, 0), connections=[contact])


RADIUS, MASS = 0.1, 0.5


def disc_system(friction: float, e: float = 0.0, half: float = 0.0, incline: float = 0.0) -> sf.System:
    """A homogeneous disc on its rim or, with half a length, a cylinder on its two rims; x is down the incline."""
    across = MASS * (RADIUS**2 / 4 + half**2 / 3)
    body = sf.RigidBody(
        "disc", sf.Joint("free", "free"), sf.Inertia(MASS, moments=(across, across, MASS * RADIUS**2 / 2))
    )
    points = [(0, 0, z) for z in ((-half, half) if half else (0.0,))]
    contact = sf.Contact("rim", ("disc", None), GROUND, restitution=e, friction=friction, points=points, rim=RADIUS)
    gravity = (G * sin(incline), 0.0, -G * cos(incline))
    return sf.System("disc", (body,), gravity=gravity, connections=(contact,))


def three_feet() -> sf.System:
    """A body on three feet; where it strikes with the speeds `WITHOUT_ANSWER` no simultaneous strike is found."""
    pull = sf.Load(force=(sf.formula("pull"), 0, 0), axes="world")
    inertia = sf.Inertia(2.0, center_of_mass=(-0.1, 0.0, -0.3), moments=(0.02, 0.03, 0.04))
    body = sf.RigidBody("body", sf.Joint("free", "free"), inertia, loads=(pull,))
    feet = [(-0.1, 0.5, -0.1), (0.1, -0.4, -0.1), (0.2, -0.2, -0.1)]
    sole = sf.Contact("sole", ("body", None), GROUND, restitution=0.0, friction=1.3, points=feet)
    return sf.System("three_feet", (body,), inputs=(sf.Input("pull"),), connections=(sole,))


WITHOUT_ANSWER = (-2.2, -1.5, -0.3, 3.2, -2.6, 3.0)


def rested(model: sf.Model, height: float) -> Any:
    """The configuration in which a box stands."""
    q = model.neutral()
    q[2] = height
    return q
