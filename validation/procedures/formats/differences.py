"""`diff` of a robot with itself stated otherwise, and with one entry changed: the entry, and what it changes."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any, cast

import numpy as np
from scipy.spatial.transform import Rotation

import symofros as sf

from ...comparison.restated import RESTATEMENTS, Restated
from ...mechanics.geometry import Array, rotation_matrix
from ..scene import Cell, Scene, off

SAME, VALUE = 0.5, 1e-9
Change = Callable[[sf.System], sf.System]
_SOLID = sf.Inertia(1.3, (0.1, -0.05, 0.08), (0.05, 0.06, 0.07, 0.004, -0.003, 0.002))
_LIMITS = sf.Limits(-1.0, 1.5, velocity=3.0, effort=20.0)
# What only states the same mechanism otherwise.
_OTHERWISE = ("bodies in another order", "bodies divided into welded parts", "other names")


def robot() -> sf.System:
    """A body that floats, with two arms of unlike joints: hinge and slide on one, ball and hinge on the other."""
    ports = (
        sf.Frame("left", (0.3, 0.1, 0.2), sf.Rotation.rpy(0.2, -0.3, 0.4)),
        sf.Frame("right", (-0.2, 0.3, 0.1), sf.Rotation.rpy(-0.4, 0.1, 0.3)),
    )
    elements = (sf.Damper(0.3), sf.Friction(0.2, minimum_velocity=0.01))
    hinge = sf.Joint(
        "q1", "revolute", "trunk", "left", axis=(0, 0.6, 0.8), elements=elements, limits=_LIMITS, armature=0.02
    )
    slide = sf.Joint(
        "s", "prismatic", "upper", position=(0.3, 0, 0.1), axis=(0.8, 0.6, 0), rotation=sf.Rotation.rpy(0.1, 0.2, 0.3)
    )
    ball = sf.Joint("b", "ball", "trunk", "right")
    wrist = sf.Joint("q2", "revolute", "arm", position=(0.2, 0.1, -0.1), axis=(1, 0, 0))
    end = (sf.Frame("end", (0.1, 0.2, 0.3), sf.Rotation.rpy(0.5, 0.1, -0.2)),)
    bodies = (
        sf.RigidBody("trunk", sf.Joint("root", "free"), replace(_SOLID, mass=5.0), ports),
        sf.RigidBody("upper", hinge, _SOLID),
        sf.RigidBody("lower", slide, replace(_SOLID, mass=0.7), end),
        sf.RigidBody("arm", ball, replace(_SOLID, mass=1.1)),
        sf.RigidBody("hand", wrist, replace(_SOLID, mass=0.4)),
    )
    return sf.System("robot", bodies)


def _body(name: str, **changes: Any) -> Change:
    def change(system: sf.System) -> sf.System:
        return replace(
            system, bodies=tuple(replace(cast(Any, b), **changes) if b.name == name else b for b in system.bodies)
        )

    return change


def _joint(name: str, **changes: Any) -> Change:
    def change(system: sf.System) -> sf.System:
        joint = next(b.joint for b in system.bodies if b.name == name)
        assert joint is not None
        return _body(name, joint=replace(joint, **changes))(system)

    return change


_OTHER_SOLID = replace(_SOLID, center_of_mass=(0.1, -0.05, 0.09))
_PLACED = {"kinematics", "M", "g"}
_TIED = sf.Coupling("tied", sf.formula("q1 - 2*s"))
_SHUT = sf.Closure("shut", ("hand", None), ("lower", "end"), ("x", "y"))
_BAR = sf.Rod("bar", ("hand", None), ("lower", "end"), 0.8)


def _with(*constraints: Any) -> Change:
    return lambda system: replace(system, constraints=constraints)


def _losing(damping: float, friction: float) -> Change:
    return _joint("upper", elements=(sf.Damper(damping), sf.Friction(friction, minimum_velocity=0.01)))


# What is changed -> link or joint, entry, what it changes, the change. What changes no motion leaves it the same.
CHANGED: dict[str, tuple[str, str, set[str], Change]] = {
    "a mass": ("lower", "mass", {"M", "g"}, _body("lower", inertia=replace(_SOLID, mass=0.71))),
    "a centre": ("hand", "center of mass", {"M", "g"}, _body("hand", inertia=replace(_OTHER_SOLID, mass=0.4))),
    "a moment": ("arm", "inertia", {"M"}, _body("arm", inertia=replace(_SOLID, mass=1.1, moments=(0.05, 0.06, 0.08)))),
    "gravity": ("", "gravity", {"g"}, lambda system: replace(system, gravity=(0.0, 0.1, -9.81))),
    "an axis": ("upper", "axis", _PLACED, _joint("upper", axis=(0, 0.8, 0.6))),
    "an axis that leans": ("lower", "axis", _PLACED, _joint("lower", axis=(0.8, 0.6, 0.1))),
    "a place": ("hand", "origin", _PLACED, _joint("hand", position=(0.2, 0.12, -0.1))),
    "a place of a ball": ("arm", "origin", _PLACED, _joint("arm", position=(0.0, 0.02, 0.0))),
    "a kind": ("lower", "joint kind", _PLACED, _joint("lower", kind="revolute")),
    "a parent": ("hand", "parent", _PLACED, _joint("hand", parent="upper")),
    "damping": ("upper", "damping", {"dissipation"}, _losing(0.31, 0.2)),
    "friction": ("upper", "friction", {"dissipation"}, _losing(0.3, 0.21)),
    "armature": ("upper", "armature", {"M"}, _joint("upper", armature=0.021)),
    "a limit": ("upper", "upper limit", {"limits"}, _joint("upper", limits=replace(_LIMITS, upper=1.6))),
    "a limit of speed": (
        "upper",
        "limit of velocity",
        {"limits"},
        _joint("upper", limits=replace(_LIMITS, velocity=3.5)),
    ),
    "a spring": ("lower", "stiffness", {"springs"}, _joint("lower", elements=(sf.Spring(20.0),))),
    "a frame": ("lower", "frame 'end'", {"kinematics"}, _body("lower", frames=(sf.Frame("end", (0.1, 0.2, 0.31)),))),
    "a coupling": ("", "constraint 'tied'", {"constraints"}, _with(_TIED)),
    "a closure": ("", "constraint 'shut'", {"constraints"}, _with(_SHUT)),
    "a rod": ("", "constraint 'bar'", {"constraints"}, _with(_BAR)),
}
# The same conditions, stated otherwise, and others of the same names.
_CONDITIONS: dict[str, tuple[Any, Any, bool]] = {
    "a coupling times a number": (_TIED, replace(_TIED, residual=sf.formula("4*s - 2*q1")), True),
    "a coupling by another ratio": (_TIED, replace(_TIED, residual=sf.formula("q1 - 3*s")), False),
    "a closure of other axes": (_SHUT, replace(_SHUT, translations=("x", "z")), False),
    "a rod of another length": (_BAR, replace(_BAR, length=0.9), False),
    "a rod between other bodies": (_BAR, replace(_BAR, first=("arm", None)), False),
}


def first_differences(_: Scene) -> Iterator[Cell]:
    """The first difference names what was changed; what states the same otherwise has none."""
    original = robot()
    for what, (subject, entry, changes, change) in CHANGED.items():
        found = sf.diff(original, change(original))
        first = found.first_difference or next(iter(found.differences), None)
        mechanical = bool(changes & _MECHANICAL)
        yield Cell(f"diff of {what}", float(_misnamed(found, first, subject, entry, changes, mechanical)), SAME)
    for what, (one, varied, same) in _CONDITIONS.items():
        found = sf.diff(*(_with(item)(original) for item in (one, varied)))
        first = found.first_difference
        wrong = found.same != same or (first is None) != same
        wrong |= first is not None and first.entry != f"constraint '{one.name}'"
        yield Cell(f"diff of {what}", float(wrong), SAME)
    for name in _OTHERWISE:
        other = RESTATEMENTS[name](original, np.random.default_rng(15))
        assert isinstance(other, Restated)
        found = sf.diff(original, other.system)
        exact = found.same and found.identical and max(found.errors.values()) < VALUE and not found.coordinates
        yield Cell(f"diff of {name}", float(not exact), SAME)
    yield from _remapped(original)


_MECHANICAL = {"kinematics", "M", "g", "constraints"}


def _misnamed(
    found: sf.MechanismDiff, first: Any, subject: str, entry: str, changes: set[str], mechanical: bool
) -> bool:
    """Whether a difference does not fit the change: its place, entry, what it changes, and the verdict in words."""
    if first is None or found.same == mechanical or len(found.differences) != 1:
        return True
    place = first.link or first.subject
    wrong = (subject not in place) or first.entry != entry or set(first.changes) != changes or first.here == first.there
    if found.errors:
        wrong |= any((found.errors[name] > VALUE) != (name in changes) for name in ("M", "g"))
        wrong |= "frame" not in entry and (found.errors["kinematics"] > VALUE) != ("kinematics" in changes)
    verdict = " ".join(str(found).split())
    stated = f"different, first in {entry} of {first.subject}" if mechanical else "the same mechanism, with other"
    return wrong or f": {stated}" not in verdict


def _reframed(system: sf.System) -> sf.System:
    """The same with the frame of each link turned within it, and with it all that is stated in it."""
    rng = np.random.default_rng(25)
    turns = {body.name: Rotation.random(random_state=rng).as_matrix() for body in system.bodies}

    def vector(X: Array, x: Any) -> tuple[float, float, float]:
        a, b, c = map(float, X.T @ np.array(x, dtype=float))
        return a, b, c

    def turned(before: Array, rotation: sf.Rotation, after: Array) -> sf.Rotation:
        own = rotation_matrix(rotation.kind, np.array(rotation.values, dtype=float))
        return sf.Rotation.matrix((before.T @ own @ after).tolist())

    changed: list[Any] = []
    for body in system.bodies:
        X, joint, inertia = turns[body.name], body.joint, cast(sf.RigidBody, body).inertia
        assert joint is not None and inertia is not None
        carrier = turns.get(joint.parent, np.eye(3)) if joint.frame is None else np.eye(3)
        joint = replace(
            joint,
            position=vector(carrier, joint.position),
            rotation=turned(carrier, joint.rotation, X),
            axis=vector(X, joint.axis),
        )
        mass = replace(
            inertia, center_of_mass=vector(X, inertia.center_of_mass), rotation=turned(X, inertia.rotation, np.eye(3))
        )
        frames = tuple(
            replace(one, position=vector(X, one.position), rotation=turned(X, one.rotation, np.eye(3)))
            for one in body.frames
        )
        changed.append(replace(cast(sf.RigidBody, body), joint=joint, inertia=mass, frames=frames))
    return replace(system, bodies=tuple(changed))


def _remapped(original: sf.System) -> Iterator[Cell]:
    """Coordinates of another sign or zero: the same mechanism, whose frames are where the first one's are."""
    other = _reframed(original)
    found = sf.diff(original, other)
    yield Cell("diff of frames of links that are turned", float(not (found.identical and found.same)), SAME)
    for what, change in (("a mass", 0.02), ("a place", 0.03)):
        damaged = _body("hand", inertia=replace(_SOLID, mass=0.4 + change))(original)
        if what == "a place":
            damaged = _joint("hand", position=(0.2, 0.1 + change, -0.1))(original)
        found = sf.diff(original, _reframed(damaged))
        first = found.first_difference
        entry = {"a mass": "mass", "a place": "origin"}[what]
        wrong = first is None or first.link != "hand" or first.entry != entry
        yield Cell(f"diff of {what}, frames turned", float(wrong), SAME, str(found)[:200] if wrong else "")
    plain = _joint("upper", limits=None, elements=())(original)
    turned, far = (
        _joint("upper", limits=None, elements=(), rotation=sf.Rotation.axis_angle((0.0, 0.6, 0.8), angle))
        for angle in (0.4, 2.8)
    )
    reversed_axis = _joint("upper", limits=None, elements=(), axis=(0, -0.6, -0.8))
    slid = _joint("lower", position=(0.3 + 0.8 * 0.05, 0.03, 0.1), rotation=sf.Rotation())
    straight = _joint("lower", rotation=sf.Rotation())
    cases = {
        "a sign": (plain, reversed_axis(original)),
        "a zero": (plain, turned(original)),
        "a zero far away": (plain, far(original)),
        "a zero of a slide": (straight(plain), slid(plain)),
    }
    both = turned(_joint("lower", axis=(-0.8, -0.6, 0.0))(original))
    third = _joint("lower", axis=(-0.8, -0.6, 0.0))(turned(slid(original)))
    cases |= {"a zero and a sign beyond it": (plain, both), "two zeros and a sign": (straight(plain), third)}
    lean = _joint("lower", axis=(-0.8, -0.6, -0.1))(turned(original))
    found = sf.diff(plain, lean)
    first = next((one for one in found.differences if one.entry == "axis"), None)
    unit = np.array([0.8, 0.6, 0.1]) / math.sqrt(1.01)
    there = [] if first is None else first.there
    yield Cell("diff of an axis that leans beyond a zero", off(np.array(there, dtype=float), unit), VALUE)
    cases |= {f"{what}, frames turned": (one, _reframed(other)) for what, (one, other) in cases.items()}
    functions = sf.Options(("frame_pose",), ("end",), backend="interpreter")
    for what, (one, other) in cases.items():
        found = sf.diff(one, other)
        ours, theirs = sf.compile(one, functions), sf.compile(other, functions)
        q, linear = ours.neutral(), [ours.names.q.index(name) for name in ("q1", "s", "q2")]
        q[linear] = np.random.default_rng(16).uniform(-1.0, 1.0, len(linear))  # Those of a ball depend on its frames.
        moved, known = q.copy(), 0 < len(found.coordinates) <= 2 and found.same
        for here, there, sign, offset in found.coordinates:
            moved[theirs.names.q.index(there)] = (q[ours.names.q.index(here)] - offset) * sign
        error = max(off(a, b) for a, b in zip(theirs.frame_pose("end", moved), ours.frame_pose("end", q), strict=True))
        yield Cell(f"diff of {what}", error + float(not known), VALUE)
