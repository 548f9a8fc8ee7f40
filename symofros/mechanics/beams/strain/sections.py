"""Mass and stiffness of a geometrically exact beam in a graph, by its sections (docs/theory/rods.md, 2 and 4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from symofros.description.beams.beam import STATION
from symofros.description.values import Term, Value, symbols
from symofros.expr.edges import Edge
from symofros.expr.vector import Vec3
from symofros.mechanics.beams.fields import Form, no_form
from symofros.mechanics.beams.strain.frames import SectionFrames


@dataclass(frozen=True)
class InertiaAxis:
    """One axis about which one section has inertia.

    Attributes:
        section: Index of the section.
        inertia: Moment of inertia about the axis, of the section's share of the rod [kg m^2].
        direction: Vector along the axis, in B, of unit length unless the inertia is that of a product (14a).
    """

    section: int
    inertia: Edge
    direction: Vec3


@dataclass(frozen=True, eq=False)
class BeamSections(SectionFrames):
    """Mass and stiffness of the sections of a rod."""

    @cached_property
    def _arms(self) -> tuple[Vec3, ...]:
        """Vectors from the axis to the mass centres of the sections, in B; none where these are on the axis."""
        if self.mass_center is None:
            return ()
        y, z = self.mass_center
        return tuple(
            section.R_BS.column(1).scaled(self._at(y, xi)) + section.R_BS.column(2).scaled(self._at(z, xi))
            for xi, section in zip(self.strains.sections.stations, self.sections, strict=True)
        )

    @cached_property
    def mass_vectors(self) -> tuple[Vec3, ...]:
        """Vectors that span the mass positions in B: the tangents, then the arms of the mass centres (12a)."""
        return self.tangents + self._arms

    @cached_property
    def partial_mass_vectors(self) -> tuple[tuple[Vec3, ...], ...]:
        """Derivatives of these by each coordinate: one row a coordinate."""
        return tuple(
            row + tuple(section.spins[i].cross(arm) for section, arm in zip(self.sections, self._arms, strict=False))
            for i, row in enumerate(self.partial_tangents)
        )

    def mass_positions(self, vectors: Sequence[Vec3]) -> list[Vec3]:
        """Positions of the stations of masses, by the mass vectors or others in their place."""
        count = len(self.sections)
        positions = [self.combined(row, vectors[:count]).scaled(self.along.L) for row in self.strains.positions]
        if self.mass_center is None:
            return positions
        arms = (self.combined(row, vectors[count:]) for row in self.strains.interpolation)
        return [position + arm for position, arm in zip(positions, arms, strict=True)]

    @cached_property
    def mass_points(self) -> tuple[tuple[Edge, ...], ...]:
        """Weights of the mass vectors in points that have the second moments of the rod, each of unit mass (12), (12a).

        The root of the mass is in the weights, which depend on parameters alone.
        """
        g, L = self.g, self.along.L
        if STATION not in symbols(self.beam.rhoA) and self.mass_center is None:
            rows, masses = self.strains.mass_points, (self.mass,) * len(self.sections)
        else:
            rows, masses = self.strains.positions, self.masses()
        roots = [g.sqrt(mass) for mass in masses]
        arms = self.strains.interpolation if self.mass_center is not None else ((),) * len(rows)
        return tuple(
            tuple(g.mul(g.constant(x), long) for x in row) + tuple(g.mul(g.constant(x), root) for x in arm)
            for row, arm, root, long in zip(rows, arms, roots, (g.mul(root, L) for root in roots), strict=True)
        )

    def masses(self, weights: Sequence[float] | None = None) -> tuple[Edge, ...]:
        """Mass at each of the stations of masses; of a part, with its weights."""
        nodes = self.strains.masses
        return self.shares(self.beam.rhoA, nodes.stations, weights or nodes.weights)

    def shares(self, weight: Value, stations: Sequence[float], weights: Sequence[float]) -> tuple[Edge, ...]:
        """Integral of a property of the section over the length, by stations."""
        g, shares = self.g, []
        for xi, w in zip(stations, weights, strict=True):
            shares.append(g.mul(g.constant(w), g.mul(self._at(weight, xi), self.along.L)))
        return tuple(shares)

    @cached_property
    def point_positions(self) -> tuple[Vec3, ...]:
        """Positions of the mass points times the roots of their masses, in B."""
        return tuple(self.weighted(row, self.mass_vectors) for row in self.mass_points)

    @cached_property
    def point_partials(self) -> tuple[tuple[Vec3, ...], ...]:
        """Derivatives of these positions by each coordinate: one row a coordinate."""
        return tuple(
            tuple(self.weighted(row, partial) for row in self.mass_points) for partial in self.partial_mass_vectors
        )

    @cached_property
    def inertia_axes(self) -> tuple[InertiaAxis, ...]:
        """Axes about which the sections have inertia: their own x axis, with rotary inertia all three."""
        return self.inertia_axes_of(self.strains.sections.weights)

    def inertia_axes_of(self, weights: Sequence[float]) -> tuple[InertiaAxis, ...]:
        """The same of a part of the rod, by its weights of the sections."""
        axes, stations = [], self.strains.sections.stations
        for axis, per_length, skew in self._inertias:
            shares = self.shares(per_length, stations, weights)
            for k, (section, xi, share) in enumerate(zip(self.sections, stations, shares, strict=True)):
                direction = section.R_BS.column(axis)
                if skew != 0.0:
                    direction = direction + section.R_BS.column(2).scaled(self._at(skew, xi))
                axes.append(InertiaAxis(k, share, direction))
        return tuple(axes)

    @property
    def _inertias(self) -> list[tuple[int, Value, Value]]:
        """Axis of the section, moment of inertia per length about it, and the share of z that is added to it (14a)."""
        beam = self.beam
        stated: list[tuple[int, Value, Value]] = [(0, beam.rhoJ, 0.0)]
        if beam.rotary_inertia:
            about_z: Value = beam.rhoI_z
            skew: Value = 0.0
            if beam.rhoI_yz != 0.0:
                share = Term(beam.rhoI_yz) / Term(beam.rhoI_y)
                about_z = (Term(beam.rhoI_z) - share * Term(beam.rhoI_yz)).value
                skew = (Term(0.0) - share).value
            stated += [(1, beam.rhoI_y, skew), (2, about_z, 0.0)]
        return [item for item in stated if item[1] != 0.0]

    @cached_property
    def mass(self) -> Edge:
        """The rod's mass."""
        if STATION not in symbols(self.beam.rhoA):
            return self.g.mul(self.along.lower(self.beam.rhoA), self.along.L)
        return self.g.sum(self.masses())

    def first_moment(self, vectors: Sequence[Vec3]) -> Vec3:
        """Mass times the position that vectors in place of the mass vectors give to the mass centre, S of section 4."""
        return self.weighted(self.first_moment_weights, vectors)

    @cached_property
    def first_moment_weights(self) -> tuple[Edge, ...]:
        """Weights of the vectors in `first_moment`."""
        g = self.g
        arms = zip(*self.strains.interpolation, strict=True) if self.mass_center is not None else ()
        of_arms = tuple(map(self._mass_weighted, arms))
        if STATION not in symbols(self.beam.rhoA):
            whole = g.mul(self.mass, self.along.L)
            return tuple(g.mul(g.constant(weight), whole) for weight in self.strains.first_moments) + of_arms
        columns = zip(*self.strains.positions, strict=True)
        return tuple(g.mul(self._mass_weighted(column), self.along.L) for column in columns) + of_arms

    def _mass_weighted(self, column: Sequence[float]) -> Edge:
        """The sum of the masses, each times a number."""
        g = self.g
        return g.sum(g.mul(g.constant(number), mass) for number, mass in zip(column, self.masses(), strict=True))

    @cached_property
    def strain_energy(self) -> Form:
        """Strain energy: half the integral of stiffnesses times squares of the changes of strain (2)."""
        total = no_form(self.g, self.coordinates)
        for (a, b), stiffness in self.law.stiffness.items():
            total = total + self.along.integral(self.strains.strain(a).times(self.strains.strain(b)), stiffness)
        return total.scaled(self.g.constant(0.5))

    def damping_energy(self, speeds: tuple[Edge, ...]) -> Form:
        """Rayleigh's dissipation function: damping times the strain energy of the rates (section 2)."""
        quadratic = self.strain_energy.scaled(self.along.lower(self.beam.damping))
        return Form(self.g, speeds, quadratic.terms)
