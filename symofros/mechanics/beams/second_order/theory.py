"""Beams of second order: what is known of one, and its deformed axis in numbers (docs/theory/beams.md)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from symofros.description.beams.beam import Beam
from symofros.description.beams.elastic import Direction
from symofros.description.beams.shapes import Family, UserShape
from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.expr.vector import Mat3
from symofros.mechanics.beams.fields import Field, Monomial
from symofros.mechanics.beams.integrals import LengthIntegrator, Lower, at_middle, points_for
from symofros.mechanics.beams.piecewise import Piecewise
from symofros.mechanics.beams.second_order.deformation import deformation_of, small_coordinates
from symofros.mechanics.beams.second_order.equations import SecondOrderEquations
from symofros.mechanics.beams.second_order.forms import ORDERS
from symofros.mechanics.beams.shape_functions import shapes
from symofros.mechanics.beams.theory import Array, BeamShape, BeamTheory, Judged


@dataclass(frozen=True)
class _Sampled:
    """A field at stations.

    Attributes:
        count: Number of stations S.
        values: Monomial -> its coefficient without the power of L (S).
        powers: Monomial -> that power.
    """

    count: int
    values: Mapping[Monomial, Array]
    powers: Mapping[Monomial, int]

    def at(self, length: float, q: Array) -> Array:
        """Values for coordinates (..., n) at every station (..., S)."""
        total = np.zeros((*q.shape[:-1], self.count))
        for mono, values in self.values.items():
            factor = length ** self.powers[mono] * np.prod(q[..., list(mono)], axis=-1)
            total = total + np.asarray(factor)[..., None] * values
        return total


class FieldShape(BeamShape):
    """Where a beam's sections are, for given elastic coordinates (docs/theory/beams.md, eqs. 1-3).

    A station at the tip has the pose that the model's own `frame_pose` gives the tip's frame.

    Args:
        beam: Beam as the user stated it.
        stations: Stations x/L (S).
    """

    def __init__(self, beam: Beam, stations: Sequence[float]) -> None:
        shape, exact = deformation_of(beam), tuple(map(Fraction, stations))
        self._position = [_sampled(field, exact) for field in shape.position]
        self._angles = [_sampled(field, exact) for field in (shape.yaw, shape.pitch, shape.roll)]

    def points(self, length: float, q: Array) -> Array:
        """p_BS of the stations, in the axes of the root (..., S, 3) [m]."""
        return np.stack([field.at(length, q) for field in self._position], axis=-1)

    def axes(self, length: float, q: Array) -> Array:
        """R_BS of the sections (..., S, 3, 3): yaw, pitch and roll in turn, so rotations at any deflection."""
        yaw, pitch, roll = (field.at(length, q) for field in self._angles)
        return _about(2, yaw) @ _about(1, pitch) @ _about(0, roll)


def _sampled(field: Field, stations: Sequence[Fraction]) -> _Sampled:
    values = {mono: np.array([float(f(xi)) for xi in stations]) for mono, f in field.terms.items()}
    return _Sampled(len(stations), values, {mono: field.exponent(mono) for mono in values})


def _about(axis: int, angle: Array) -> Array:
    """Rotations about a coordinate axis (..., 3, 3)."""
    c, s = np.cos(angle), np.sin(angle)
    R = np.zeros((*angle.shape, 3, 3))
    i, j = (axis + 1) % 3, (axis + 2) % 3
    R[..., axis, axis] = 1.0
    R[..., i, i] = R[..., j, j] = c
    R[..., i, j], R[..., j, i] = -s, s
    return R


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
    def strains(self) -> Mapping[int, Field]:
        """Twist rate and curvatures."""
        fields = enumerate(deformation_of(self.beam).curvatures)
        return {k: field for k, field in fields if any(len(monomial) == 1 for monomial in field.terms)}

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
