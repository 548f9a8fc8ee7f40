"""Spatial mechanisms with closed loops: Bricard's, Stewart's and Clavel's, and two arms that hold one payload."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import cos, pi, sin

import symofros as sf

from ..rigid.station import mss

Point = tuple[float, float, float]

# Corners of a unit cube on the way around, and the axis of the hinge at each: IFToMM benchmark library, A04.
_CORNERS: tuple[Point, ...] = ((0, 0, 0), (1, 0, 0), (1, -1, 0), (1, -1, 1), (0, -1, 1), (0, 0, 1))
_HINGES: tuple[Point, ...] = ((0, 1, 0), (0, 0, 1), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 0))
_THICKNESS = 0.1
# Of the delta robot's rods [m].
_RADIUS = 0.02


def _minus(a: Point, b: Point) -> Point:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def bricard() -> sf.System:
    """Six hinges at right angles: over-constrained, it moves all the same. Five moving bars; 5 conditions of rank 4.

    Source: IFToMM benchmark library of multibody problems, A04: bars of 1 kg, 1 m, square section 0.1 m.
    """
    bodies: list[sf.Body] = []
    parent, at = "world", _CORNERS[0]
    for i in range(5):
        span = _minus(_CORNERS[i + 1], _CORNERS[i])
        across, along = (1.0 + _THICKNESS**2) / 12, _THICKNESS**2 / 6
        moments = tuple(along if x else across for x in span)
        joint = sf.Joint(f"q{i + 1}", "revolute", parent, position=at, axis=_HINGES[i])
        center = (span[0] / 2, span[1] / 2, span[2] / 2)
        bodies.append(sf.RigidBody(f"bar{i + 1}", joint, sf.Inertia(1.0, center, moments), (sf.Frame("end", span),)))
        parent, at = f"bar{i + 1}", span
    ground = sf.RigidBody("ground", frames=(sf.Frame("hinge", _CORNERS[5]),))
    # The sixth hinge is about x: all directions but the rotation about it are blocked.
    last = sf.Closure("hinge6", ("ground", "hinge"), ("bar5", "end"), ("x", "y", "z"), ("y", "z"))
    return sf.System("bricard", (ground, *bodies), gravity=(0, -9.81, 0), constraints=(last,))


def stewart(radius: float = 0.6, top: float = 0.35) -> sf.System:
    """A platform on six legs: universal joint, slide and, at the platform, a ball joint that is a closure.

    Source: Stewart (1965), with round dimensions of ours; each leg's cylinder and rod have mass.
    """
    tray = sf.Inertia(8.0, (0, 0, 0), (0.3, 0.3, 0.6))
    sockets = [_on_circle(top, 60 * (i // 2 * 2 + 1) + (10 if i % 2 else -10), 0.0) for i in range(6)]
    bodies: list[sf.Body] = [
        sf.RigidBody(
            "platform", sf.Joint("pose", "free"), tray, tuple(sf.Frame(f"s{i}", p) for i, p in enumerate(sockets))
        )
    ]
    closures = []
    for i in range(6):
        foot = _on_circle(radius, 60 * (i - i % 2) + 60 * (i % 2) + (15 if i % 2 == 0 else -15), 0.0)
        joint = sf.Joint(f"foot{i}", "universal", position=foot, axis=(1, 0, 0), axis2=(0, 1, 0))
        cylinder = sf.RigidBody(f"cylinder{i}", joint, sf.Inertia(1.2, (0, 0, 0.2), (0.02, 0.02, 0.002)))
        slide = sf.Joint(f"leg{i}", "prismatic", f"cylinder{i}", axis=(0, 0, 1), actuated=True)
        rod = sf.RigidBody(f"rod{i}", slide, sf.Inertia(0.7, (0, 0, -0.2), (0.01, 0.01, 0.001)))
        bodies += [cylinder, rod]
        closures.append(sf.Closure(f"ball{i}", ("platform", f"s{i}"), (f"rod{i}", None)))
    return sf.System("stewart", tuple(bodies), constraints=tuple(closures))


def stewart_guess(height: float = 0.8) -> list[float]:
    """Coordinates from which it assembles: the platform above the feet, legs upright."""
    return [0.0, 0.0, height, 0.0, 0.0, 0.0, 1.0, *([0.0, 0.0, height] * 6)]


def _on_circle(radius: float, degrees: float, z: float) -> Point:
    return radius * cos(degrees * pi / 180), radius * sin(degrees * pi / 180), z


def delta(
    base: float = 0.2, top: float = 0.06, upper: float = 0.3, lower: float = 0.7, rod_mass: float = 0.0
) -> sf.System:
    """Three cranks, each with two parallel rods of constant length to one platform: it translates, and never turns.

    Source: Clavel (1988), with round dimensions of ours. Rods without mass are conditions on a distance; with mass they
    are slender bodies on universal joints, whose lower ends are ball joints to the platform.
    """
    half = 0.05
    feet = sf.Inertia(0.6, (0, 0, 0), (0.001, 0.001, 0.002))
    frames: list[sf.Frame] = []
    bodies: list[sf.Body] = []
    rods: list[sf.Constraint] = []
    for i in range(3):
        angle = 120.0 * i
        turn = sf.Rotation.rpy(0, 0, angle * pi / 180)
        joint = sf.Joint(
            f"motor{i}", "revolute", position=_on_circle(base, angle, 0), rotation=turn, axis=(0, 1, 0), actuated=True
        )
        ends = tuple(sf.Frame(name, (upper, y, 0)) for name, y in (("left", half), ("right", -half)))
        crank = sf.Inertia(0.5, (upper / 2, 0, 0), (1e-4, 0.004, 0.004))
        bodies.append(sf.RigidBody(f"crank{i}", joint, crank, ends))
        for name, y in (("left", half), ("right", -half)):
            c, s = cos(angle * pi / 180), sin(angle * pi / 180)
            frames.append(sf.Frame(f"{name}{i}", (top * c - y * s, top * s + y * c, 0)))
            rod, foot = f"rod_{name}{i}", ("platform", f"{name}{i}")
            if rod_mass == 0.0:
                rods.append(sf.Rod(rod, (f"crank{i}", name), foot, lower))
                continue
            bodies.append(_slender(rod, sf.Joint(f"{rod}.root", "universal", f"crank{i}", name), rod_mass, lower))
            rods.append(sf.Closure(f"{rod}.ball", foot, (rod, "end")))
    platform = sf.RigidBody("platform", sf.Joint("pose", "free"), feet, tuple(frames))
    return sf.System("delta_rods" if rod_mass else "delta", (*bodies, platform), constraints=tuple(rods))


def _slender(name: str, root: sf.Joint, mass: float, length: float) -> sf.RigidBody:
    """A rod that hangs from its root, along -z of its frame; it turns about x, then about y."""
    across = mass * length**2 / 12
    inertia = sf.Inertia(mass, (0, 0, -length / 2), (across, across, mass * _RADIUS**2 / 2))
    hung = replace(root, axis=(1, 0, 0), axis2=(0, 1, 0))
    return sf.RigidBody(name, hung, inertia, (sf.Frame("end", (0, 0, -length)),))


def delta_guess() -> list[float]:
    """Coordinates from which it assembles: cranks level, the platform below."""
    return [0.0, 0.0, 0.0, 0.0, 0.0, -0.55, 0.0, 0.0, 0.0, 1.0]


def grasp() -> sf.System:
    """The paper's task: the station's second hand holds what the first hand carries; six conditions close the loop."""
    system = mss()
    payload = sf.RigidBody(
        "payload",
        sf.Joint("grip", "fixed", "spdm_left_link7", "end"),
        sf.Inertia(120.0, (0.3, 0.0, 0.0), (8.0, 10.0, 10.0)),
        (sf.Frame("handle", (0.6, 0.0, 0.0), sf.Rotation.rpy(0, 0, "pi")),),
    )
    hold = sf.Closure("hold", ("payload", "handle"), ("spdm_right_link7", "end"), ("x", "y", "z"), ("x", "y", "z"))
    return sf.System("grasp", (*system.bodies, payload), gravity=(0, 0, 0), constraints=(hold,))


def grasp_guess(names: Sequence[str]) -> list[float]:
    """Coordinates from which it assembles: both arms bent towards each other."""
    bent = {"q3": 0.9, "q4": -1.6, "q5": 0.4, "q2": 0.0}
    return [bent.get(name[-2:], 0.0) + (0.2 if "ssrms" in name else 0.0) for name in names]
