"""Values of a stage that are not of the kind that UsdPhysics has: attributes may be authored with any type."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple


class Fault(NamedTuple):
    """A value that can't be meant.

    Attributes:
        path: Path of the prim.
        name: Name of the value.
        value: What it is.
        rule: What it must be.
    """

    path: str
    name: str
    value: Any
    rule: str


# Name -> how many numbers it is.
_SIZES = {
    **dict.fromkeys(("mass", "density", "lower", "upper", "gravityMagnitude", "material density"), 1),
    **dict.fromkeys(("size", "radius", "height", "maxForce"), 1),
    **dict.fromkeys(("centerOfMass", "diagonalInertia", "position0", "position1", "gravityDirection", "color"), 3),
    **dict.fromkeys(("principalAxes", "rotation0", "rotation1"), 4),
    "inertia": 6,
}
# Infinities stand for none.
_UNBOUNDED = frozenset({"lower", "upper", "gravityMagnitude", "centerOfMass", "maxForce"})
_PAIRS = ("breaks", "cones", "distances", "moving")


def faults(stage: Mapping[str, Any]) -> Iterator[Fault]:
    """The values of a stage that can't be read.

    Args:
        stage: As `usd_worker.stage_data` gives it.
    """
    for unit in ("meters", "kilograms"):
        if not (isinstance(stage[unit], float) and stage[unit] > 0.0):
            yield Fault("", f"{unit}PerUnit", stage[unit], "a finite number above zero")
    for row in (*stage["bodies"], *stage["joints"], *stage["shapes"], *stage["scenes"]):
        yield from _stated(row)
        yield from _bounds(row)


def _stated(row: Mapping[str, Any]) -> Iterator[Fault]:
    """Sizes, places and axes."""
    path = row["path"]
    for name, value in (*row.items(), *row.get("sizes", {}).items()):
        if name in _SIZES and value not in (None, []):
            yield from _numbers(path, name, value, _SIZES[name], name in _UNBOUNDED)
        elif name == "axis" and value is not None and value not in ("X", "Y", "Z"):
            yield Fault(path, name, value, "X, Y or Z")
    for name in _PAIRS:
        for value in row.get(name, ()):
            if value is not None:
                yield from _numbers(path, name, value, 3 if name == "moving" else 1, name != "moving")


def _bounds(row: Mapping[str, Any]) -> Iterator[Fault]:
    """Faults of limits, drives and format extensions of a row: each is one number, which may be infinite."""
    limits = ((f"limit {freedom}", value) for freedom, pair in row.get("limits", {}).items() for value in pair)
    drives = (("maxForce", drive["maxForce"]) for drive in row.get("drives", {}).values())
    for name, value in (*limits, *drives):
        if value is not None:
            yield from _numbers(row["path"], name, value, 1, True)
    for name, value in row.get("extensions", {}).items():
        yield from _numbers(row["path"], name, value, 1, True)


def _numbers(path: str, name: str, value: Any, count: int, may_be_infinite: bool) -> Iterator[Fault]:
    values = [value] if count == 1 else value
    known = isinstance(values, list) and len(values) == count
    if known and all(_is_number(x, may_be_infinite) for x in values):
        return
    rule = "one number" if count == 1 else f"{count} numbers"
    yield Fault(path, name, value, rule if may_be_infinite else f"{rule}, finite")


def _is_number(value: Any, may_be_infinite: bool) -> bool:
    """Whether a value is a number; infinities and NaN are stated by their names."""
    if isinstance(value, int | float) and not isinstance(value, bool):
        return math.isfinite(value)
    return may_be_infinite and value in ("inf", "-inf")
