"""Elastic descriptions of beams: one row a theory with every fact about it that is not mechanics.

Which directions have functions, which entries of a beam the theory has no use for, whether it holds at any bending.
`Beam.elastic` is the row of the theory that a beam states. To add a theory: its name in `Theory`, a row of `_ROWS`, and
its mechanics, a folder of `symofros/mechanics/beams/` with a row of `theories.py` there.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from symofros.description.values import Value

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
