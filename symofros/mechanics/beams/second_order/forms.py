"""The inertia, strain energy and tip of one beam as forms of its elastic coordinates (docs/theory/beams.md)."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, partial
from itertools import combinations_with_replacement
from typing import NamedTuple, Self

from symofros.description.beams.beam import Retain
from symofros.description.values import Value
from symofros.expr.edges import Edge
from symofros.mechanics.beams.fields import EVERY_DEGREE, Field, Form, UnitIntegral, no_form, unit_field
from symofros.mechanics.beams.integrals import is_uniform
from symofros.mechanics.beams.second_order.deformation import Deformation
from symofros.mechanics.beams.theory import BeamEquations
from symofros.mechanics.spatial.inertia import PAIRS

ORDERS: dict[Retain, float] = {"zeroth_order": 0, "first_order": 1, "all": EVERY_DEGREE}

Vector = tuple[Form, Form, Form]


class SectionInertia(NamedTuple):
    """Inertia of a beam's sections about one of their axes.

    Attributes:
        about: Index of the axis.
        per_length: Moment of inertia per length about the axis [kg m].
        axis: Components of the axis in B.
        spins: Partial angular velocities of the section about the axis, one a coordinate.
    """

    about: int
    per_length: Value
    axis: tuple[Field, ...]
    spins: tuple[Field, ...]


@dataclass(frozen=True)
class BeamForms(BeamEquations):
    """Inertia, strain energy and places of sections as forms of the elastic coordinates (eqs. 8-13).

    Attributes:
        shape: Displacement field.
    """

    shape: Deformation

    @cached_property
    def _sections(self) -> tuple[SectionInertia, ...]:
        """Inertia of sections about the axis of twist alone, or about all three axes, which bending turns (eq. 13)."""
        beam, shape = self.beam, self.shape
        if beam.rotary_inertia:
            weights = ((0, beam.rhoJ), (1, beam.rhoI_y), (2, beam.rhoI_z))
            sections = []
            for k, per_length in weights:
                axis, spins = (tuple(row[k] for row in rows) for rows in (shape.rotation, shape.partial_spins))
                sections.append(SectionInertia(k, per_length, axis, spins))
        else:
            one, none = unit_field(shape.lengths), Field(0, shape.lengths, {})
            spins = tuple(shape.roll.by(i) for i in range(beam.modes))
            sections = [SectionInertia(0, beam.rhoJ, (one, none, none), spins)]
        return tuple(section for section in sections if section.per_length != 0.0)

    def _integral(self, of: Hashable, product: Callable[[], Field], weight: Value) -> Form:
        """The integral of a product of fields; its numbers are formed once for beams with equal shape functions.

        Args:
            of: What the product is of, besides the order and the choice of rotary inertia.
            product: The product, formed where it is needed.
            weight: Property of the section.
        """
        if not is_uniform(weight):
            return self.along.integral(product(), weight)
        known, key = self.shape.integrals, (of, self.order, self.beam.rotary_inertia, self.along.start)
        if key not in known:
            known[key] = UnitIntegral.of(product(), self.along.start)
        return self.along.uniform(known[key], weight)

    def _summed(self, forms: Iterable[Form]) -> Form:
        return sum(forms, start=no_form(self.along.g, self.along.coordinates))

    def beyond(self, xi: float) -> Self:
        """The same of the part beyond a station, whose moments stay about the root."""
        return replace(self, along=replace(self.along, start=Fraction(xi)))

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
        upto, r, rhoA = self.order + 1, self.shape.position, self.beam.rhoA
        E = [self._integral(("E", a, b), partial(r[a].times, r[b], upto), rhoA) for a, b in PAIRS]
        for section in self._sections:
            c = section.axis
            J = [
                self._integral(("J", section.about, a, b), partial(c[a].times, c[b], upto), section.per_length)
                for a, b in PAIRS
            ]
            half = (J[0] + J[1] + J[2]).scaled(self.along.g.constant(0.5))
            E = [e + (half - j if a == b else -j) for e, j, (a, b) in zip(E, J, PAIRS, strict=True)]
        return tuple(E)

    @cached_property
    def angular(self) -> tuple[Vector, ...]:
        """Angular momentum K_i about the root per unit rate of each coordinate (eqs. 10, 13)."""
        momenta: list[Vector] = []
        for i in range(self.beam.modes):
            x, y, z = (self._summed(self._momentum(i, a)) for a in range(3))
            momenta.append((x, y, z))
        return tuple(momenta)

    def _momentum(self, i: int, a: int) -> Iterator[Form]:
        """Parts of the angular momentum about axis a per unit rate of coordinate i."""
        r, b, c = self.shape.position, (a + 1) % 3, (a + 2) % 3

        def moment() -> Field:
            return r[b].times(r[c].by(i), self.order) - r[c].times(r[b].by(i), self.order)

        yield self._integral(("K", i, a), moment, self.beam.rhoA)
        for section in self._sections:
            spin = partial(section.axis[a].times, section.spins[i], self.order)
            yield self._integral(("K", i, a, section.about), spin, section.per_length)

    @cached_property
    def modal_masses(self) -> dict[tuple[int, int], Form]:
        """Modal mass M_ij for i <= j (eqs. 11, 13)."""
        pairs = combinations_with_replacement(range(self.beam.modes), 2)
        return {(i, j): self._summed(self._masses(i, j)) for i, j in pairs}

    def _masses(self, i: int, j: int) -> Iterator[Form]:
        """Parts of the modal mass of two coordinates."""
        for k, field in enumerate(self.shape.position):

            def product(field: Field = field) -> Field:
                return field.by(i).times(field.by(j), self.order)

            yield self._integral(("M", i, j, k), product, self.beam.rhoA)
        for section in self._sections:
            spins = partial(section.spins[i].times, section.spins[j], self.order)
            yield self._integral(("M", i, j, "spin", section.about), spins, section.per_length)

    @cached_property
    def strain_energy(self) -> Form:
        """Strain energy, half the integral of GJ k1^2 + EI_y k2^2 + EI_z k3^2 (eq. 7); cubic if every term is kept."""
        upto = 3 if self.order > 1 else 2
        beam, half = self.beam, self.along.g.constant(0.5)
        stiffness = (beam.GJ, beam.EI_y, beam.EI_z)
        curvatures = enumerate(zip(self.shape.curvatures, stiffness, strict=True))
        squares = (self._integral(("V", k), partial(kappa.times, kappa, upto), EI) for k, (kappa, EI) in curvatures)
        return self._summed(squares).scaled(half)

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
