"""Joints of several coordinates as a series of simple ones, which every engine knows.

A series of joints without mass in between is the joint itself: coordinates and speeds are the same.
"""

from __future__ import annotations

from dataclasses import dataclass

import symofros as sf

from .joint_kinds import SIMPLE_JOINTS, STATED_JOINTS, PartKind

Axis = tuple[float | sf.Expression, float | sf.Expression, float | sf.Expression]

_X: Axis = (1.0, 0.0, 0.0)
_Y: Axis = (0.0, 1.0, 0.0)
_Z: Axis = (0.0, 0.0, 1.0)


@dataclass(frozen=True)
class Part:
    """One simple joint of a series.

    Attributes:
        kind: "general" where the series is not found, "elastic" between the root and the tip of a beam: no rigid
            engine can represent them.
        axis: Axis as stated, in the frame that the parts before it lead to.
        first: Index of its first coordinate among the joint's, and of its first speed.
        coordinates: Number of coordinates.
        speeds: Number of speeds.
    """

    kind: PartKind
    axis: Axis
    first: int = 0
    coordinates: int = 1
    speeds: int = 1


def input_symbol(name: str) -> str:
    """Name of an input in formulas, where t and pi mean something else without quotes (docs/yaml.md)."""
    return f"`{name}`" if name in ("t", "pi") else name


def coordinate_symbols(joint: sf.Joint) -> tuple[str, ...]:
    """Names of a joint's coordinates in formulas."""
    return tuple(map(input_symbol, _coordinates(joint)))


def speed_symbols(joint: sf.Joint) -> tuple[str, ...]:
    """Names of a joint's speeds in formulas."""
    speeds = STATED_JOINTS[joint.kind].speeds if joint.kind in STATED_JOINTS else None
    return tuple(f"d{name}" for name in _coordinates(joint)) if speeds is None else _named(joint, speeds)


def rates_by_coordinate(joint: sf.Joint) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Alternative names in formulas of a joint's speeds and of a prescribed joint's rates of them: d`q`, dd`q`."""
    names = [
        name.replace("`", "``") for name in (speed_symbols(joint) if has_quaternion(joint) else _coordinates(joint))
    ]
    first = speed_symbols(joint) if has_quaternion(joint) else tuple(f"d`{name}`" for name in names)
    return first, tuple(f"{'d' if has_quaternion(joint) else 'dd'}`{name}`" for name in names)


def _coordinates(joint: sf.Joint) -> tuple[str, ...]:
    if joint.kind not in STATED_JOINTS:
        return joint.coordinates
    return _named(joint, STATED_JOINTS[joint.kind].coordinates)


def _named(joint: sf.Joint, suffixes: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(f"{joint.name}.{suffix}" if suffix else joint.name for suffix in suffixes)


def has_quaternion(joint: sf.Joint) -> bool:
    """Whether a joint's coordinates end with a quaternion, so that its speeds are no rates of them."""
    return joint.kind in STATED_JOINTS and STATED_JOINTS[joint.kind].speeds is not None


def rate_symbols(joint: sf.Joint) -> tuple[str, ...]:
    """Input names of the rates of a prescribed joint's speeds."""
    return tuple(f"d{name}" for name in speed_symbols(joint))


def series(joint: sf.Joint) -> list[Part]:
    """The simple joints that a joint is made of, from the parent outwards."""
    if joint.kind not in STATED_JOINTS:
        return _general(joint)
    axes = {"axis": joint.axis, "axis2": joint.axis2, "x": _X, "y": _Y, "z": _Z}
    parts: list[Part] = []
    for first, (kind, axis) in enumerate(STATED_JOINTS[joint.kind].series):
        simple = SIMPLE_JOINTS[kind]
        parts.append(Part(kind, axes[axis], first, simple.coordinates, simple.speeds))
    return parts


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
        names = coordinate_symbols(joint)
        if not isinstance(value, sf.Expression) or value.kind != "symbol" or value.name not in names:
            return whole
        index = names.index(value.name)
        parts.append(Part("prismatic" if kind == "prismatic" else "revolute", axis, index))
    used = sorted(part.first for part in parts)
    return parts if used == list(range(len(joint.coordinates))) else whole
