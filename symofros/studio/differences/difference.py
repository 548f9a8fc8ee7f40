"""A difference between two files that a person can act on, and which file is likelier right."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.studio.differences.alignment import Close
from symofros.studio.differences.mechanism import FOLLOWING, Body, Mechanism

# What makes mechanisms different; the rest (limits, dissipation, springs, zero of coordinates) doesn't.
MECHANICS = ("kinematics", "M", "g", "constraints")
# Digits by which a number must be shorter than the other to be the likelier one.
_SHORTER = 4
_TRIANGLE = 1e-6


@dataclass(frozen=True)
class Difference:
    """One entry that differs.

    Attributes:
        entry: What differs: "mass", "center of mass", "inertia", "origin", "axis", "pitch", "joint kind", "parent",
            "presence", "armature", "damping", "friction", "lower limit" and so on.
        link: Name of the link in the first file.
        joint: Name of the joint in the first file that has the entry; "" where the link has it.
        here: Value in the first file.
        there: Value in the second file.
        changes: What it changes: of "kinematics", "M", "g", "constraints", "coordinates", "limits", "dissipation",
            "springs", "events"; empty for nothing that can be observed.
        names: Names of link and joint in the second file.
        places: "file:line" of the link or joint in both files, where they are known.
        likelier: Which file is likelier right: 0, 1; None where neither is.
        reason: Why.
    """

    entry: str
    link: str
    joint: str
    here: Any
    there: Any
    changes: tuple[str, ...] = ()
    names: tuple[str, str] = ("", "")
    places: tuple[str, str] = ("", "")
    likelier: int | None = None
    reason: str = ""

    @property
    def is_mechanical(self) -> bool:
        """Whether kinematics, M, g or constraints change."""
        return any(what in MECHANICS for what in self.changes)

    @property
    def subject(self) -> str:
        """The link or joint that has the entry."""
        return f"joint '{self.joint}'" if self.joint else f"link '{self.link}'" if self.link else "the file"


def likelier(pair: tuple[Mechanism, Mechanism], bodies: tuple[Body, Body], what: str, close: Close) -> tuple[Any, str]:
    """Which of two links is likelier right, and why: impossible inertias, twins, round numbers."""
    for k in (0, 1):
        if what in ("mass", "inertia") and not _is_possible(bodies[k]) and _is_possible(bodies[1 - k]):
            return 1 - k, "no distribution of mass has the other's inertia"
    twins = [_twin(pair[k], bodies[k], what, close) for k in (0, 1)]
    for k in (0, 1):
        if twins[k] and not twins[1 - k]:
            return k, f"link '{twins[k]}' of the same file has the same numbers"
    digits = [max((len(repr(float(f"{x:.15g}"))) for x in _values(body, what)), default=0) for body in bodies]
    for k in (0, 1):
        if digits[k] + _SHORTER <= digits[1 - k]:
            return k, "its number is the rounder one"
    return None, ""


def _is_possible(body: Body) -> bool:
    moments = np.linalg.eigvalsh(body.inertia)
    slack = _TRIANGLE * abs(moments).max()
    return bool(body.mass >= 0.0 and moments[0] >= -slack and moments[2] <= moments[0] + moments[1] + slack)


def _values(body: Body, what: str) -> Array:
    """The numbers of an entry as the file has them, without their signs and in no order: those of a mirrored twin."""
    R, I = body.pose.R, body.inertia  # noqa: E741
    found = {
        "mass": np.array([body.mass]),
        "center of mass": R.T @ (body.center - body.pose.p),
        "inertia": (R.T @ I @ R)[np.triu_indices(3)],
        "origin": body.placed.p,
    }
    return np.sort(np.abs(found.get(what, np.zeros(0))))


def _twin(mechanism: Mechanism, body: Body, what: str, close: Close) -> str:
    """Another link with the same numbers; "" if there is none."""
    own = _values(body, what)
    if not own.any():
        return ""
    slack = close.tolerance * np.abs(own).max()
    others = (other for other in mechanism.bodies if other.name not in body.name.split("+"))
    return next((other.name for other in others if np.abs(_values(other, what) - own).max() <= slack), "")


def entries_of_joint(
    here: dict[str, float], there: dict[str, float], sign: float, offset: float, close: Close
) -> Iterator[tuple[str, float | None, float | None, tuple[str, ...]]]:
    """Numbers of a coordinate that differ, those of the second file in coordinates of the first, and what they change.

    Limits of velocity and effort, and what resists, are even; limits of the coordinate and a spring's rest follow it.
    """
    mapped = {name: value for name, value in there.items() if name not in ("lower limit", "upper limit")}
    ends = ("lower limit", "upper limit") if sign > 0.0 else ("upper limit", "lower limit")
    for name, of in zip(("lower limit", "upper limit"), ends, strict=True):
        if of in there:
            mapped[name] = sign * there[of] + offset
    for name, origin in (("rest of the spring", offset), ("push of the springs", 0.0)):
        if name in mapped:
            mapped[name] = sign * mapped[name] + origin
    for name in sorted(here.keys() | mapped.keys()):
        a, b = here.get(name), mapped.get(name)
        near = (
            a is not None
            and b is not None
            and abs(a - b) <= close.tolerance * max(float(offset != 0.0), abs(a), abs(b))
        )
        lacks_other = name in FOLLOWING and (a is None or b is None)  # Another entry says so.
        if not near and not lacks_other:
            yield name, a, b, (_changes(name),)


def _changes(name: str) -> str:
    if name == "armature":
        return "M"
    if "limit" in name:
        return "limits"
    return "springs" if "stiffness" in name or "spring" in name else "dissipation"
