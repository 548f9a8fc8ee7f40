"""Geometrically exact beams, rods: what is known of one from its description (docs/theory/rods.md)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial

from symofros.description.beams.beam import Beam
from symofros.description.beams.elastic import STRAINS, Direction
from symofros.description.beams.shapes import Family, UserShape
from symofros.description.values import Value
from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.expr.vector import Mat3
from symofros.mechanics.beams.integrals import Lower
from symofros.mechanics.beams.piecewise import Piecewise
from symofros.mechanics.beams.strain.planar import strain_equations
from symofros.mechanics.beams.strain.resolution import with_sections
from symofros.mechanics.beams.strain.section_law import section_law
from symofros.mechanics.beams.strain.shape import IntegrationError, StrainShape
from symofros.mechanics.beams.strain.strains import AXES, TURNING, strain_functions, strains_of
from symofros.mechanics.beams.theory import BeamEquations, BeamShape, BeamTheory, Interpolated, Judged

# Intervals between the stations at which a rod's turn is judged.
_INTERVALS = 16


class StrainTheory(BeamTheory):
    """A rod: its strains are sums of functions, and it errs by the number of its sections alone."""

    @classmethod
    def family_functions(
        cls, family: Family, direction: Direction, count: int, user: tuple[UserShape, ...] = ()
    ) -> Sequence[tuple[Piecewise, bool]]:
        """Shape functions of strains, the same for all directions."""
        return [(function, False) for function in strain_functions(family, count, user)]

    @property
    def functions(self) -> Sequence[Piecewise]:
        """Strain functions."""
        return strains_of(self.beam).functions

    @property
    def units(self) -> tuple[str, ...]:
        """Coordinates of twist and bending are angles."""
        return tuple("rad" if axis < TURNING else "" for axis, _ in strains_of(self.beam).axes)

    def sizes(self, length: float) -> tuple[float, ...]:
        """Sizes of the strain coordinates that turn the rod by a right angle, or stretch or shear it by a tenth."""
        return strains_of(self.beam).sizes

    def resolved(self, number: Callable[[Value, float], float]) -> Beam:
        """The beam with the sections that its stress-free curvature needs."""
        return with_sections(self.beam, number)

    @property
    def interpolated(self) -> Interpolated:
        """Mass centres, and how strains without functions follow others, are known at the sections."""
        beam = self.beam
        if not beam.modes:
            return Interpolated()
        strains = strains_of(beam)
        with_functions = {AXES[direction][0] for direction, n in zip(STRAINS, beam.counts, strict=True) if n}
        labels = "stiffness" if beam.stiffness else "tension_center or shear_center"
        following = list(section_law(beam, with_functions).following.values())
        properties = [("mass_center", list(beam.mass_center)), (labels, following)]
        return Interpolated(properties, strains.sections.stations, strains.masses.stations, strains.interpolation)

    @property
    def judged(self) -> Judged:
        """Data by which a deformation is judged: rotations of the sections, error of the shape's integration."""
        beam, strains = self.beam, strains_of(self.beam)
        xi = tuple(k / _INTERVALS for k in range(_INTERVALS + 1))
        return Judged(
            counts=(
                beam.bend_y,
                beam.bend_z,
                beam.modes - beam.bend_y - beam.bend_z,
            ),  # Stretch and shear turn nothing.
            xi=xi,
            angles=strains.turns(xi),
            displacements=(False,) * beam.modes,
            sections=len(strains.sections.stations) - 1,  # Beside the root.
            integration_error=partial(IntegrationError, beam),
        )

    def shape(self, values: Mapping[str, float], stations: Sequence[float]) -> BeamShape:
        """Poses of the sections, from the frames of the equations."""
        return StrainShape(self.beam, values, stations)

    def equations(
        self, g: Graph, lower: Lower, coordinates: tuple[Edge, ...], R_LB: Mat3 | None = None
    ) -> BeamEquations:
        """The rod in a graph; one that bends in a plane, and neither stretches nor shears, by the formulas for that."""
        return strain_equations(g, lower, self.beam, coordinates, R_LB)
