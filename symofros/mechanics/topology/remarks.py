"""What is made of a sound description that its author should know."""

from __future__ import annotations

from collections.abc import Iterator

from symofros.description.system import System
from symofros.mechanics.topology.numbers import Numbers
from symofros.mechanics.topology.run_time import rotations_of

# A matrix of ten digits and more is told apart from its rotation by rounding alone.
FEW_DIGITS = 1e-9


def rounded_rotations(system: System) -> Iterator[str]:
    """Rotation matrices stated with few digits, for which the nearest rotations are used: by how much they are none."""
    numbers = Numbers(system)
    for body in system.bodies:
        for what, rotation, where in rotations_of(system, body):
            defect = numbers.rounded(rotation)
            if defect > FEW_DIGITS:
                place = f"{where}: " if where else ""
                yield f"{place}{what}: |R R^T - 1| = {defect:.1g} by the digits stated; the nearest rotation is used"
