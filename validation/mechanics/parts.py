"""Joints of several coordinates as a series of simple ones, which every engine knows.

A series of joints without mass in between is the joint itself: coordinates and speeds are the same.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import symofros as sf

PartKind = Literal["revolute", "prismatic", "screw", "ball", "free", "general", "elastic"]
Axis = tuple[float | sf.Expression, float | sf.Expression, float | sf.Expression]

_X: Axis = (1.0, 0.0, 0.0)
_Y: Axis = (0.0, 1.0, 0.0)
_Z: Axis = (0.0, 0.0, 1.0)

# Kind -> names of its coordinates and speeds after the joint's name.
_QUATERNION = ("qx", "qy", "qz", "qw")
COORDINATES: dict[str, tuple[str, ...]] = {
    "ball": _QUATERNION,
    "free": ("px", "py", "pz", *_QUATERNION),
    "cylindrical": ("angle", "length"),
    "universal": ("angle1", "angle2"),
    "planar": ("x", "y", "angle"),
}
_SPEEDS: dict[str, tuple[str, ...]] = {"ball": ("wx", "wy", "wz"), "free": ("vx", "vy", "vz", "wx", "wy", "wz")}


@dataclass(frozen=True)
class Part:
    """One simple joint of a series.

    Attributes:
        kind: "general" where the series is not found, "elastic" between the root and the tip of a beam: no rigid
            engine can represent them.
        axis: As stated, in the frame that the parts before it lead to.
        first: Its first coordinate among the joint's, and its first speed.
        coordinates: How many.
        speeds: How many.
    """

    kind: PartKind
    axis: Axis
    first: int = 0
    coordinates: int = 1
    speeds: int = 1


def coordinate_symbols(joint: sf.Joint) -> tuple[str, ...]:
    """What formulas call a joint's coordinates."""
    if joint.kind == "general":
        return joint.coordinates
    if joint.kind in COORDINATES:
        return tuple(f"{joint.name}.{suffix}" for suffix in COORDINATES[joint.kind])
    return (joint.name,)


def speed_symbols(joint: sf.Joint) -> tuple[str, ...]:
    """What formulas call its speeds."""
    if joint.kind in _SPEEDS:
        return tuple(f"{joint.name}.{suffix}" for suffix in _SPEEDS[joint.kind])
    return tuple(f"d{name}" for name in coordinate_symbols(joint))


def rate_symbols(joint: sf.Joint) -> tuple[str, ...]:
    """What inputs call the rates of the speeds of a prescribed joint."""
    return tuple(f"d{name}" for name in speed_symbols(joint))


def series(joint: sf.Joint) -> list[Part]:
    """The simple joints that a joint is made of, from the parent outwards."""
    axis = joint.axis
    stated: dict[str, list[Part]] = {
        "revolute": [Part("revolute", axis)],
        "continuous": [Part("revolute", axis)],
        "prismatic": [Part("prismatic", axis)],
        "screw": [Part("screw", axis)],
        "cylindrical": [Part("revolute", axis), Part("prismatic", axis, 1)],
        "universal": [Part("revolute", axis), Part("revolute", joint.axis2, 1)],
        "planar": [Part("prismatic", _X), Part("prismatic", _Y, 1), Part("revolute", _Z, 2)],
        "ball": [Part("ball", axis, 0, 4, 3)],
        "free": [Part("free", axis, 0, 7, 6)],
    }
    return stated[joint.kind] if joint.kind in stated else _general(joint)


def _general(joint: sf.Joint) -> list[Part]:
    """Slides along x, y, z and turns by yaw, pitch, roll, where each is a coordinate of its own."""
    whole = [Part("general", joint.axis, 0, len(joint.coordinates), len(joint.coordinates))]
    if joint.moving_rotation.kind != "rpy":
        return whole
    roll, pitch, yaw = joint.moving_rotation.values
    slides = [("prismatic", axis, value) for axis, value in zip((_X, _Y, _Z), joint.moving_position, strict=True)]
    turns = [("revolute", axis, value) for axis, value in ((_Z, yaw), (_Y, pitch), (_X, roll))]
    parts: list[Part] = []
    for kind, axis, value in (*slides, *turns):
        if value == 0.0:
            continue
        if not isinstance(value, sf.Expression) or value.kind != "symbol" or value.name not in joint.coordinates:
            return whole
        index = joint.coordinates.index(value.name)
        parts.append(Part("prismatic" if kind == "prismatic" else "revolute", axis, index))
    used = sorted(part.first for part in parts)
    return parts if used == list(range(len(joint.coordinates))) else whole
