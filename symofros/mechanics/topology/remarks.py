"""What is made of a sound description that its author should know."""

from __future__ import annotations

import math
from collections.abc import Iterator

from symofros.description.system import System
from symofros.description.values import Rotation
from symofros.mechanics.topology.numbers import Numbers
from symofros.mechanics.topology.run_time import rotations_of

# A matrix of ten digits and more differs from its rotation by rounding alone.
FEW_DIGITS = 1e-9
# A whole turn, stated with six digits.
_TURN = 2.0 * math.pi * (1.0 + 1e-6)
# Where the angles of a rotation stand.
_ANGLES = {"rpy": slice(0, 3), "axis_angle": slice(3, 4)}


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
