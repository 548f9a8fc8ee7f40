"""Elastic descriptions of beams: one row a theory with every fact about it that is not mechanics.

Which directions have functions, which entries of a beam the theory has no use for, whether it holds at any bending.
`Beam.elastic` is the row of the theory that a beam states. To add a theory: its name in `Theory`, a row of `_ROWS`, and
its mechanics, a folder of `symofros/mechanics/beams/` with a row of `theories.py` there. A
section's matrix of stiffness, force and moment per strain, is here, too.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations
from typing import Any, Literal, get_args

from symofros.base.arguments import entries_of
from symofros.description.values import Value, as_values
from symofros.errors import DescriptionError

Theory = Literal["second_order", "strain"]
THEORIES: tuple[Theory, ...] = get_args(Theory)
Direction = Literal["bend_y", "bend_z", "twist", "stretch", "shear_y", "shear_z"]
# Strains of a geometrically exact rod; a beam of second order deforms in the first three directions.
STRAINS: tuple[Direction, ...] = get_args(Direction)
DIRECTIONS = STRAINS[:3]

# Stiffnesses against stretch and shear.
STRAIN_STIFFNESSES = ("EA", "GA_y", "GA_z")
# Products of inertia, about axes of the section that are no principal ones.
PRODUCTS = ("EI_yz", "rhoI_yz")
# Points (y, z) of the section, which may be off the axis.
CENTERS = ("tension_center", "shear_center", "mass_center")
# Strains without stress: functions of the station as well.
PRE_STRAINS = ("twist_rate", "curvature_y", "curvature_z")

Point = tuple[Value, Value]
AXIS: Point = (0.0, 0.0)


@dataclass(frozen=True)
class ElasticDescription:
    """One theory of elastic beams.

    Attributes:
        name: Value of the entry `theory`.
        noun: What a beam of this theory is called in errors.
        lacks: What it is or does in place of the entries that it lacks.
        directions: Directions that may have functions.
        lacking: Entries of a beam without meaning in this theory: they keep their defaults.
        is_exact: Whether the theory holds at any bending, so that results err by discretisation alone: no order of
            terms is chosen, no limit of bending applies, loads may follow the sections.
        mode_family: Family of functions that are the modes of a beam clamped at its root; None where no family is.
    """

    name: Theory
    noun: str
    lacks: str
    directions: tuple[Direction, ...]
    lacking: tuple[str, ...]
    is_exact: bool = False
    mode_family: Literal["clamped_free"] | None = None

    @property
    def has_coupled_sections(self) -> bool:
        """Whether sections may have centres off the axis, products of inertia, or a matrix of stiffness."""
        return "stiffness" not in self.lacking


_ROWS = (
    ElasticDescription(
        name="second_order",
        noun="a beam of second order in its displacements",
        lacks="is straight without stress, neither stretches nor shears, has its centres on the axis, and principal"
        " axes y and z",
        directions=DIRECTIONS,
        lacking=("sections", "stiffness", *PRE_STRAINS, *STRAIN_STIFFNESSES, *PRODUCTS, *STRAINS[3:], *CENTERS),
        mode_family="clamped_free",
    ),
    ElasticDescription(
        name="strain",
        noun="a geometrically exact rod (theory 'strain')",
        lacks="keeps every term, and shortens by itself",
        directions=STRAINS,
        lacking=("retain", "foreshortening"),
        is_exact=True,
    ),
)

ELASTIC: dict[str, ElasticDescription] = {row.name: row for row in _ROWS}


# Strains in the order of a matrix of stiffness, and what such a matrix takes the place of.
MATRIX_ORDER = ("stretch", "shear_y", "shear_z", "twist_rate", "curvature_y", "curvature_z")
IN_MATRIX = ("EI_y", "EI_z", "GJ", *STRAIN_STIFFNESSES, "EI_yz", "tension_center", "shear_center")
# Difference of two entries across the diagonal of a matrix of stiffness, over the root of the product of the
# diagonal's: programs for sections write seven digits.
_ASYMMETRY = 1e-6


def stiffness_rows(stated: Any, label: str) -> tuple[tuple[Value, ...], ...]:
    """A matrix of stiffness (6, 6), made symmetric where rounding left a difference; empty where none is stated.

    Raises:
        DescriptionError: It has other rows, or is not symmetric.
    """
    listed = entries_of(stated)
    listed = [stated] if listed is None else listed
    if not listed:
        return ()
    size = len(MATRIX_ORDER)
    if len(listed) != size:
        rule = f"{size} rows of {size} entries: {', '.join(MATRIX_ORDER)}"
        raise DescriptionError(label, f"{len(listed)} rows", rule, "give all, zeros included")
    rows = [list(as_values(row, size, f"{label}[{i}]")) for i, row in enumerate(listed)]
    for i, j in combinations(range(size), 2):
        a, b, first, second = rows[i][j], rows[j][i], rows[i][i], rows[j][j]
        if a == b:
            continue
        if isinstance(a, float) and isinstance(b, float) and isinstance(first, float) and isinstance(second, float):
            if abs(a - b) <= _ASYMMETRY * math.sqrt(abs(first * second)):
                rows[i][j] = rows[j][i] = 0.5 * (a + b)
                continue
        rule = "a matrix of stiffness is symmetric: forces have the strain energy as their potential"
        found = f"[{i}][{j}] is {a}, [{j}][{i}] is {b}"
        raise DescriptionError(f"{label} is not symmetric", found, rule, "state the same value for both")
    return tuple(map(tuple, rows))
