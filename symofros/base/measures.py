"""What the rows and columns of a constraint Jacobian measure, by which rank decisions judge sizes.

docs/theory/constraints.md, section 10. The numbers are those of native/model/row_sizes.c.in.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

# Units of rows: what a formula states, in a unit of its own; a length; an angle.
FORMULA, LENGTH, ANGLE = 0, 1, 2
# Kinds of speeds.
TRANSLATION, ROTATION, OTHER = 0, 1, 2
SPEED_KINDS = 3


class Measures(NamedTuple):
    """Measures of one constraint Jacobian G (nc, nv).

    Attributes:
        group: First row of the rows that share their sizes: those of one constraint with one unit (nc).
        unit: FORMULA, LENGTH or ANGLE of each row (nc).
        speed: TRANSLATION, ROTATION or OTHER of each speed (nv).
    """

    group: tuple[int, ...] = ()
    unit: tuple[int, ...] = ()
    speed: tuple[int, ...] = ()

    def of_rows(self, rows: Sequence[int]) -> Measures:
        """Measures of some rows, in order."""
        first: dict[int, int] = {}
        for i, row in enumerate(rows):
            first.setdefault(self.group[row], i)
        group = tuple(first[self.group[row]] for row in rows)
        return Measures(group, tuple(self.unit[row] for row in rows), self.speed)

    def of_speeds(self, speeds: Iterable[int]) -> Measures:
        """Measures of the columns of some speeds, in order."""
        return self._replace(speed=tuple(self.speed[k] for k in speeds))

    def kinds(self, speeds: int) -> tuple[int, ...]:
        """Kinds of so many speeds, OTHER of those that none is stated of."""
        return (*self.speed, *(OTHER,) * speeds)[:speeds]

    @classmethod
    def joined(cls, parts: Iterable[tuple[int, int, Measures]], rows: int, speeds: int) -> Measures:
        """Measures of a Jacobian of blocks; speeds outside of them are of the kind OTHER.

        Args:
            parts: First row, first speed and measures of each block.
            rows: Number of all rows.
            speeds: Number of all speeds.
        """
        group, unit, speed = list(range(rows)), [FORMULA] * rows, [OTHER] * speeds
        for row, column, part in parts:
            group[row : row + len(part.group)] = [row + first for first in part.group]
            unit[row : row + len(part.unit)] = part.unit
            speed[column : column + len(part.speed)] = part.speed
        return cls(tuple(group), tuple(unit), tuple(speed))
