"""What is made of a sound description that its author should know."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator

from symofros.description.forces import Damper, Friction, Spring
from symofros.description.joints.joint import Joint
from symofros.description.system import System
from symofros.description.values import Rotation
from symofros.mechanics.topology.coordinates import joint_sizes
from symofros.mechanics.topology.numbers import Numbers
from symofros.mechanics.topology.run_time import rotations_of

# A matrix of ten digits and more differs from its rotation by rounding alone.
FEW_DIGITS = 1e-9
# A whole turn, stated with six digits.
_TURN = 2.0 * math.pi * (1.0 + 1e-6)
# Where the angles of a rotation stand.
_ANGLES = {"rpy": slice(0, 3), "axis_angle": slice(3, 4)}


# What the linear and the higher coefficients of a force along a coordinate are, and what negative ones do.
_STIFFNESS = "stiffness", "pushes away from rest"
_DAMPING = "damping", "gives energy"
_COEFFICIENTS: dict[type, tuple[tuple[str, str], str, str | None]] = {
    Spring: (_STIFFNESS, "stiffness", "cubic"),
    Damper: (_DAMPING, "coefficient", "quadratic"),
    Friction: (_DAMPING, "viscous", None),
}


def remarks(system: System) -> Iterator[str]:
    """All remarks on a description, at the defaults of its parameters."""
    yield from rotation_remarks(system)
    yield from force_remarks(system)


def force_remarks(system: System) -> Iterator[str]:
    """Springs that push away from rest, and dampers that give energy, by more than others on them take back.

    A higher coefficient that is positive says that it is meant: it bounds the motion (two wells, a limit cycle).
    """
    numbers, where = Numbers(system), system.origin.get
    for joint in (body.joint for body in system.bodies if body.joint is not None):
        for (what, does, k), (linear, higher) in _coefficients(joint, numbers).items():
            if (linear < 0.0 and not higher > 0.0) or (what == "damping" and higher < 0.0):
                of = f" of coordinate {k}" if joint_sizes(joint)[1] > 1 else ""
                value, label = (linear, what) if linear < 0.0 else (higher, f"quadratic {what}")
                what = f"joint '{joint.name}': {label}{of}"
                yield _negative(what, value, does, "effort", where(("joint", joint.name), ""))
    for connection in system.connections:
        for what, does in (_STIFFNESS, _DAMPING):
            stated = getattr(connection, what, None)  # None: a rigid contact
            if stated is not None and (value := numbers.value(stated)) < 0.0:
                origin = where(("connection", connection.name), "")
                yield _negative(f"connection '{connection.name}': {what}", value, does, "VirtualPower", origin)


def _coefficients(joint: Joint, numbers: Numbers) -> dict[tuple[str, str, int], list[float]]:
    """Sums of the linear and the higher coefficients, by kind and coordinate."""
    sums: dict[tuple[str, str, int], list[float]] = defaultdict(lambda: [0.0, 0.0])
    for element in joint.elements:
        if type(element) in _COEFFICIENTS:
            kind, linear, higher = _COEFFICIENTS[type(element)]
            both = sums[*kind, element.coordinate]
            both[0] += numbers.value(getattr(element, linear))
            both[1] += numbers.value(getattr(element, higher)) if higher else 0.0
    return sums


def _negative(what: str, value: float, does: str, entry: str, origin: str) -> str:
    place = f"{origin}: " if origin else ""
    return f"{place}{what} {value:g} is negative: it {does}; where that is meant, state a formula in {entry}"


def rotation_remarks(system: System) -> Iterator[str]:
    """Rotation matrices stated with few digits, for which nearest rotations are used; angles beyond a turn."""
    numbers = Numbers(system)
    for body in system.bodies:
        for what, rotation, where in rotations_of(system, body):
            place = f"{where}: " if where else ""
            defect, angle = numbers.rounded(rotation), _largest_angle(numbers, rotation)
            if defect > FEW_DIGITS:
                yield f"{place}{what}: |R R^T - 1| = {defect:.1g} by the digits stated; the nearest rotation is used"
            if angle > _TURN:
                yield f"{place}{what}: {angle:.6g} rad is more than a turn; {angle:.6g} degrees are {angle:.6g}*pi/180"


def _largest_angle(numbers: Numbers, rotation: Rotation) -> float:
    """The largest angle in which a rotation is stated [rad]."""
    angles = rotation.values[_ANGLES[rotation.kind]] if rotation.kind in _ANGLES else ()
    return max((abs(numbers.value(angle)) for angle in angles), default=0.0)
