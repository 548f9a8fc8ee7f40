"""The inertia, strain energy and tip of one beam as forms of its elastic coordinates (docs/theory/beams.md)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import combinations_with_replacement
from typing import NamedTuple

from symofros.description.beam import Beam, Retain
from symofros.description.values import Value
from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.mechanics.beams.deformation import Deformation, deformation_of
from symofros.mechanics.beams.fields import EVERY_DEGREE, Field, Form, no_form, unit_field
from symofros.mechanics.beams.integrals import LengthIntegrator, Lower, points_for

ORDERS: dict[Retain, float] = {"zeroth_order": 0, "first_order": 1, "all": EVERY_DEGREE}
# Pairs of axes in the order of Sym3: xx, yy, zz, xy, xz, yz.
PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))

Vector = tuple[Form, Form, Form]


class SectionInertia(NamedTuple):
    """Inertia of a beam's sections about one of their axes.

    Attributes:
        per_length: Moment of inertia per length about the axis [kg m].
        axis: Components of the axis in B.
        spins: Partial angular velocities of the section about the axis, one a coordinate.
    """

    per_length: Value
    axis: tuple[Field, ...]
    spins: tuple[Field, ...]


@dataclass(frozen=True)
class BeamForms:
    """What the equations of motion need of one beam (eqs. 8-13).

    Attributes:
        beam: The beam as described.
        along: Integration over its length.
        shape: Displacement field.
        order: Degree in elastic coordinates and speeds up to which terms of the equations of motion are kept.
    """

    beam: Beam
    along: LengthIntegrator
    shape: Deformation
    order: float

    @cached_property
    def _sections(self) -> tuple[SectionInertia, ...]:
        """Inertia of sections about the axis of twist alone, or about all three axes, which bending turns (eq. 13)."""
        beam, shape = self.beam, self.shape
        if beam.rotary_inertia:
            weights = ((0, beam.rhoJ), (1, beam.rhoI_y), (2, beam.rhoI_z))
            sections = []
            for k, per_length in weights:
                axis, spins = (tuple(row[k] for row in rows) for rows in (shape.rotation, shape.partial_spins))
                sections.append(SectionInertia(per_length, axis, spins))
        else:
            one, none = unit_field(shape.lengths), Field(0, shape.lengths, {})
            spins = tuple(shape.roll.by(i) for i in range(beam.modes))
            sections = [SectionInertia(beam.rhoJ, (one, none, none), spins)]
        return tuple(section for section in sections if section.per_length != 0.0)

    def _summed(self, parts: list[tuple[Field, Value]]) -> Form:
        total = no_form(self.along.g, self.along.coordinates)
        for field, weight in parts:
            total = total + self.along.integral(field, weight)
        return total

    @cached_property
    def mass(self) -> Edge:
        """The beam's mass."""
        return self.along.integral(unit_field(self.shape.lengths), self.beam.rhoA).value()

    @cached_property
    def first_moment(self) -> Vector:
        """First moment S, the integral of r dm (eq. 8)."""
        x, y, z = (self.along.integral(_cut(field, self.order + 1), self.beam.rhoA) for field in self.shape.position)
        return x, y, z

    @cached_property
    def second_moment(self) -> tuple[Form, ...]:
        """Second moment E, the integral of r r^T dm, sections included, in the order of Sym3 (eqs. 9, 13)."""
        upto, r = self.order + 1, self.shape.position
        E = [self.along.integral(r[a].times(r[b], upto), self.beam.rhoA) for a, b in PAIRS]
        for section in self._sections:
            c = section.axis
            J = [self.along.integral(c[a].times(c[b], upto), section.per_length) for a, b in PAIRS]
            half = (J[0] + J[1] + J[2]).scaled(self.along.g.constant(0.5))
            E = [e + (half - j if a == b else -j) for e, j, (a, b) in zip(E, J, PAIRS, strict=True)]
        return tuple(E)

    @cached_property
    def angular(self) -> tuple[Vector, ...]:
        """Angular momentum K_i about the root per unit rate of each coordinate (eqs. 10, 13)."""
        r = self.shape.position
        momenta: list[Vector] = []
        for i in range(self.beam.modes):
            d = [field.by(i) for field in r]
            parts: list[list[tuple[Field, Value]]] = []
            for a in range(3):
                b, c = (a + 1) % 3, (a + 2) % 3
                moment = r[b].times(d[c], self.order) - r[c].times(d[b], self.order)
                parts.append([(moment, self.beam.rhoA)])
                for section in self._sections:
                    parts[a].append((section.axis[a].times(section.spins[i], self.order), section.per_length))
            momenta.append((self._summed(parts[0]), self._summed(parts[1]), self._summed(parts[2])))
        return tuple(momenta)

    @cached_property
    def modal_mass(self) -> dict[tuple[int, int], Form]:
        """Modal mass M_ij for i <= j (eqs. 11, 13)."""
        masses = {}
        for i, j in combinations_with_replacement(range(self.beam.modes), 2):
            parts = [(field.by(i).times(field.by(j), self.order), self.beam.rhoA) for field in self.shape.position]
            parts += [(s.spins[i].times(s.spins[j], self.order), s.per_length) for s in self._sections]
            masses[i, j] = self._summed([(field, weight) for field, weight in parts if field.terms])
        return masses

    @cached_property
    def strain_energy(self) -> Form:
        """Strain energy, half the integral of GJ k1^2 + EI_y k2^2 + EI_z k3^2 (eq. 7); cubic if every term is kept."""
        upto = 3 if self.order > 1 else 2
        beam, half = self.beam, self.along.g.constant(0.5)
        stiffness = (beam.GJ, beam.EI_y, beam.EI_z)
        squares = [(k.times(k, upto), EI) for k, EI in zip(self.shape.curvatures, stiffness, strict=True)]
        return self._summed([(square, EI) for square, EI in squares if square.terms]).scaled(half)

    def damping_energy(self, speeds: tuple[Edge, ...]) -> Form:
        """Rayleigh's dissipation function: damping times the quadratic strain energy of the rates (eq. 14)."""
        factor = self.along.lower(self.beam.damping)
        quadratic = self.strain_energy.upto(2).scaled(factor)
        return Form(self.along.g, speeds, quadratic.terms)

    def point(self, xi: float) -> Vector:
        """Position p_BS of the section at a station xi."""
        x, y, z = (self.along.at(field, xi) for field in self.shape.position)
        return x, y, z

    def angles(self, xi: float) -> Vector:
        """Yaw, pitch and roll of the section at a station xi."""
        yaw, pitch, roll = (self.along.at(f, xi) for f in (self.shape.yaw, self.shape.pitch, self.shape.roll))
        return yaw, pitch, roll


def _cut(field: Field, upto: float) -> Field:
    return Field(field.power, field.lengths, {mono: f for mono, f in field.terms.items() if len(mono) <= upto})


def beam_forms(g: Graph, lower: Lower, beam: Beam, coordinates: tuple[Edge, ...]) -> BeamForms:
    """The forms of a beam in a graph.

    Args:
        g: The graph that operations are added to.
        lower: Lowering of values of the description to edges.
        beam: The beam as described.
        coordinates: Edges of the elastic coordinates.
    """
    shape = deformation_of(beam)
    knots = tuple(sorted({knot for function in shape.functions for knot in function.phi.knots} or {0, 1}))
    along = LengthIntegrator(
        g,
        lower,
        beam.length,
        lower(beam.length),
        coordinates,
        knots,
        points_for([function.phi for function in shape.functions]),
    )
    return BeamForms(beam, along, shape, ORDERS[beam.retain])
