"""Beams of second order: what is known of one from its description (docs/theory/beams.md)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from symofros.description.beams.elastic import Direction
from symofros.description.beams.shapes import Family, UserShape
from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.expr.vector import Mat3
from symofros.mechanics.beams.integrals import LengthIntegrator, Lower, at_middle, points_for
from symofros.mechanics.beams.piecewise import Piecewise
from symofros.mechanics.beams.second_order.deformation import deformation_of, small_coordinates
from symofros.mechanics.beams.second_order.equations import SecondOrderEquations
from symofros.mechanics.beams.second_order.forms import ORDERS
from symofros.mechanics.beams.second_order.shape import FieldShape
from symofros.mechanics.beams.shape_functions import shapes
from symofros.mechanics.beams.theory import BeamShape, BeamTheory, Judged


class SecondOrderTheory(BeamTheory):
    """A beam whose displacements are kept to second order: it errs by its bending."""

    @classmethod
    def family_functions(
        cls, family: Family, direction: Direction, count: int, user: tuple[UserShape, ...] = ()
    ) -> Sequence[tuple[Piecewise, bool]]:
        """Shape functions of displacements and twist angles, which satisfy the conditions at the clamped end."""
        return [(shape.phi, shape.length) for shape in shapes(family, direction, count, user)]

    @property
    def functions(self) -> Sequence[Piecewise]:
        """Shape functions of the displacements and of the twist angle."""
        return [shape.phi for shape in deformation_of(self.beam).functions]

    @property
    def units(self) -> tuple[str, ...]:
        """Displacements, and angles."""
        return tuple("m" if length else "rad" for length in deformation_of(self.beam).lengths)

    def sizes(self, length: float) -> tuple[float, ...]:
        """Sizes of the elastic coordinates up to which slopes and twist cause errors below a percent."""
        return small_coordinates(self.beam, length)

    @property
    def judged(self) -> Judged:
        """Data by which a deformation is judged: slopes and twist of the sections, EI_z and EI_y at mid-length."""
        beam, shape = self.beam, deformation_of(self.beam)
        xi, angles = shape.station_angles
        EI_z, EI_y = (at_middle(EI, beam) for EI in (beam.EI_z, beam.EI_y))
        return Judged(shape.counts, xi, angles, shape.lengths, EI_z, EI_y)

    def shape(self, values: Mapping[str, float], stations: Sequence[float]) -> BeamShape:
        """Poses of the sections, from the displacement field of the equations."""
        return FieldShape(self.beam, stations)

    def equations(
        self, g: Graph, lower: Lower, coordinates: tuple[Edge, ...], R_LB: Mat3 | None = None
    ) -> SecondOrderEquations:
        """The beam in a graph."""
        beam, shape = self.beam, deformation_of(self.beam)
        knots = tuple(sorted({knot for function in shape.functions for knot in function.phi.knots} or {0, 1}))
        points = points_for([function.phi for function in shape.functions])
        along = LengthIntegrator(g, lower, beam.length, coordinates, knots, points)
        return SecondOrderEquations(beam, along, R_LB or Mat3.identity(g), ORDERS[beam.retain], shape)
