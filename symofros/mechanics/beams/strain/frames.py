"""A geometrically exact beam in a graph: its sections' frames and their partial velocities (docs/theory/rods.md)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

from symofros.description.beams.beam import STATION
from symofros.description.beams.elastic import PRE_STRAINS
from symofros.description.values import Value, symbols
from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.expression import Expression
from symofros.expr.vector import Mat3, Vec3
from symofros.mechanics.beams.integrals import at_station
from symofros.mechanics.beams.quadrature import gauss
from symofros.mechanics.beams.strain.section_law import SectionLaw, section_law
from symofros.mechanics.beams.strain.strains import TURNING, Strains
from symofros.mechanics.beams.strain.turn import Moments, Turn
from symofros.mechanics.beams.theory import BeamEquations

# Gauss nodes for the integral of a pre-strain between two sections.
_PRE_STRAIN_POINTS = 4


@dataclass(frozen=True)
class SectionFrame:
    """One section S of a rod, seen from the root's frame B.

    Attributes:
        R_BS: Rotation.
        spins: Partial angular velocities in B, one a coordinate.
    """

    R_BS: Mat3
    spins: tuple[Vec3, ...]


@dataclass(frozen=True, eq=False)
class SectionFrames(BeamEquations):
    """Frames of the sections of one geometrically exact beam, a rod, and positions along its axis.

    Attributes:
        strains: Strain fields, with their tables at the sections.
    """

    strains: Strains

    @cached_property
    def axis(self) -> int | None:
        """The one axis that all sections turn about, if there is one: the turn is then a sine and a cosine."""
        pre = {k for k, label in enumerate(PRE_STRAINS) if getattr(self.beam, label) != 0.0}
        axes = pre | {k for k, _ in self.strains.axes if k < TURNING}
        return axes.pop() if len(axes) == 1 else None

    @cached_property
    def law(self) -> SectionLaw:
        """Section stiffness, and the stretch and shear that follow from bending and twist (2), (2a)."""
        return section_law(self.beam, {axis for axis, _ in self.strains.axes})

    @property
    def mass_center(self) -> tuple[Value, Value] | None:
        """Mass centre (y, z) of the sections, where it is not on the axis."""
        return self.beam.mass_center if self.beam.mass_center != (0.0, 0.0) else None

    # Sections.

    @cached_property
    def root(self) -> SectionFrame:
        """The section at the root."""
        return SectionFrame(Mat3.identity(self.g), tuple(Vec3(self.g) for _ in self.coordinates))

    @cached_property
    def sections(self) -> tuple[SectionFrame, ...]:
        """The sections at which the motion is integrated, from the root on."""
        if self.axis is not None:
            return tuple(map(self.section_at, self.strains.sections.stations))
        chain = [self.root]
        for step in self._steps:
            chain.append(self._after(chain[-1], step))
        return tuple(chain)

    def section_at(self, xi: float) -> SectionFrame:
        """The section at any station."""
        if self.axis is not None:
            return self._turned(self.axis, xi)
        stations = self.strains.sections.stations
        before = sum(station <= xi for station in stations)
        start, section = stations[before - 1], self.sections[before - 1]
        return self._after(section, self._step(start, xi)) if xi > start else section

    def _turned(self, axis: int, xi: float) -> SectionFrame:
        """The section at a station of a rod whose sections turn about one axis (4)."""
        g = self.g
        (row,) = self.strains.turns([xi])
        angle = self._pre_moments(axis, 0.0, xi)[0]
        for q, turn in zip(self.coordinates, row, strict=True):
            angle = g.add(angle, g.mul(g.constant(turn), q))
        c, s = g.call("cos", angle), g.call("sin", angle)
        i, j = (axis + 1) % 3, (axis + 2) % 3
        entries = list(Mat3.identity(g).entries)
        entries[3 * i + i] = entries[3 * j + j] = c
        entries[3 * i + j], entries[3 * j + i] = -s, s
        spins = tuple(Vec3.unit(g, axis).scaled(g.constant(turn)) for turn in row)
        return SectionFrame(Mat3(g, tuple(entries)), spins)

    @cached_property
    def _steps(self) -> tuple[Turn, ...]:
        return tuple(self._step(a, b) for a, b in pairwise(self.strains.sections.stations))

    def _step(self, a: float, b: float) -> Turn:
        """The turn between two stations, by Magnus's series (5)-(7)."""
        tables = self.strains.moments(a, b)[: self._moments_counted]
        pre = [self._pre_moments(axis, a, b) for axis in range(3)]
        starts = list(zip(*pre, strict=True))
        return Turn.of(self._moments(tables, self.coordinates, starts), tables)

    @cached_property
    def _moments_counted(self) -> int:
        """Number of moments of the strains in a step: three for the sixth order, two for the fourth.

        The fourth serves strains that are at most linear, at the sections chosen for them: what such functions leave
        out is more.
        """
        beam = self.beam
        varies = beam.family == "user" or any(STATION in symbols(getattr(beam, label)) for label in PRE_STRAINS)
        return 3 if varies or beam.sections or max(beam.counts[:TURNING]) > 2 else 2

    def _moments(
        self,
        tables: Sequence[Sequence[float]],
        values: Sequence[Edge],
        starts: Sequence[Sequence[Edge]] = ((ZERO, ZERO, ZERO),) * 3,
    ) -> Moments:
        """Moments of the strains of coordinates or of their rates."""
        vectors = [
            Vec3(self.g, *(self._superposition(axis, table, values, start[axis]) for axis in range(3)))
            for table, start in zip(tables, starts, strict=False)
        ]
        return Moments(vectors[0], vectors[1], vectors[2] if len(vectors) == 3 else None)

    def _superposition(self, axis: int, table: Sequence[float], values: Sequence[Edge], start: Edge) -> Edge:
        """The sum of coordinates or their rates about one axis, with weights."""
        g = self.g
        for (k, _), value, number in zip(self.strains.axes, values, table, strict=True):
            if k == axis:
                start = g.add(start, g.mul(g.constant(number), value))
        return start

    def _pre_moments(self, axis: int, a: float, b: float) -> tuple[Edge, Edge, Edge]:
        """Moments of a pre-strain over an interval, as of the functions (5)."""
        g, stated = self.g, getattr(self.beam, PRE_STRAINS[axis])
        if STATION not in symbols(stated):
            return g.mul(g.constant(b - a), g.mul(self.along.lower(stated), self.along.L)), ZERO, ZERO
        assert isinstance(stated, Expression)
        moments = [ZERO, ZERO, ZERO]
        for node, weight in zip(*gauss(_PRE_STRAIN_POINTS), strict=True):
            value = self.along.lower(at_station(stated, self.along.length, a + (b - a) * node))
            share = g.mul(g.constant(weight * (b - a)), g.mul(value, self.along.L))
            for k, factor in enumerate((1.0, node - 0.5, (node - 0.5) ** 2 - 1.0 / 12.0)):
                moments[k] = g.add(moments[k], g.mul(g.constant(factor), share))
        zeroth, first, second = moments
        return zeroth, first, second

    def _after(self, section: SectionFrame, step: Turn) -> SectionFrame:
        """The section at the end of a step (8), (9)."""
        g, none = self.g, Vec3(self.g)
        end = section.R_BS @ step.rotation
        T = step.spinning(section.R_BS, end)
        spins = list(section.spins)
        of_axis = {}
        for axis in sorted({axis for axis, _ in self.strains.axes if axis < TURNING}):
            e = Vec3.unit(g, axis)
            changes = Moments(e, none, none), Moments(none, e, none), Moments(none, none, e)
            of_axis[axis] = [T.times(step.vector_change(change)) for change in changes[: len(step.tables)]]
        for i, ((axis, _), *weights) in enumerate(zip(self.strains.axes, *step.tables, strict=True)):
            if axis in of_axis:
                spins[i] = spins[i] + self.combined(weights, of_axis[axis])
        return SectionFrame(end, tuple(spins))

    # Positions: sums of tangents, with weights that are numbers.

    @cached_property
    def tangents(self) -> tuple[Vec3, ...]:
        """Tangents of the axis at the sections, in B: derivatives of the position by x (10)."""
        return tuple(
            section.R_BS.column(0) + shift
            for section, shift in zip(self.sections, self.shifted(self.coordinates), strict=True)
        )

    @cached_property
    def _slips(self) -> tuple[tuple[dict[int, Edge], ...], ...]:
        """Stretch (0) and shears (1, 2) of each section by a unit of each coordinate, where there are any (1b)."""
        g, sections = self.g, []
        per_length = g.div(ONE, self.along.L)
        for xi, row in zip(self.strains.sections.stations, self.strains.values, strict=True):
            slips: list[dict[int, Edge]] = []
            for (axis, _), value in zip(self.strains.axes, row, strict=True):
                unit = g.constant(value)
                own = {axis - TURNING: unit} if axis >= TURNING and value else {}
                if axis < TURNING:
                    unit = g.mul(unit, per_length)
                followed = {
                    k - TURNING: g.mul(self._at(share, xi), unit)
                    for (k, by), share in self.law.following.items()
                    if by == axis
                }
                slips.append(own | {k: edge for k, edge in followed.items() if edge != ZERO})
            sections.append(tuple(slips))
        return tuple(sections)

    def _at(self, value: Value, xi: float) -> Edge:
        """A property of the section at a station."""
        return self.along.lower(at_station(value, self.along.length, xi) if isinstance(value, Expression) else value)

    def shifted(self, values: Sequence[Edge]) -> list[Vec3]:
        """Stretch and shear of the sections by coordinates, or by their rates at constant sections, in B."""
        g, vectors = self.g, []
        for section, slips in zip(self.sections, self._slips, strict=True):
            vector = Vec3(g)
            for k in range(3):
                total = g.sum(g.mul(slip[k], value) for slip, value in zip(slips, values, strict=True) if k in slip)
                vector = vector + section.R_BS.column(k).scaled(total)
            vectors.append(vector)
        return vectors

    @cached_property
    def partial_slips(self) -> tuple[tuple[Vec3, ...], ...]:
        """Derivatives of stretch and shear, where sections do not turn, by each coordinate: one row a coordinate."""
        rows = []
        for i in range(len(self.coordinates)):
            row = []
            for section, slips in zip(self.sections, self._slips, strict=True):
                vector = Vec3(self.g)
                for k, unit in slips[i].items():
                    vector = vector + section.R_BS.column(k).scaled(unit)
                row.append(vector)
            rows.append(tuple(row))
        return tuple(rows)

    @cached_property
    def partial_tangents(self) -> tuple[tuple[Vec3, ...], ...]:
        """Derivatives of the tangents at the sections by each coordinate: one row a coordinate."""
        rows = []
        for i, ((axis, _), slips) in enumerate(zip(self.strains.axes, self.partial_slips, strict=True)):
            if axis < TURNING:
                turned = (s.spins[i].cross(t) for s, t in zip(self.sections, self.tangents, strict=True))
                rows.append(tuple(spin + slip for spin, slip in zip(turned, slips, strict=True)))
            else:
                rows.append(slips)
        return tuple(rows)

    def combined(self, row: Sequence[float], vectors: Sequence[Vec3]) -> Vec3:
        """A sum of vectors with weights that are numbers."""
        return self.weighted(tuple(map(self.g.constant, row)), vectors)

    def weighted(self, row: Sequence[Edge], vectors: Sequence[Vec3]) -> Vec3:
        """A sum of vectors with weights."""
        total = Vec3(self.g)
        for weight, vector in zip(row, vectors, strict=True):
            total = total + vector.scaled(weight)
        return total

    def position(self, xi: float) -> Vec3:
        """Position p_BS of the section at a station (10)."""
        return self.combined(self.strains.sections.from_root(xi), self.tangents).scaled(self.along.L)

    def partial_position(self, xi: float, i: int) -> Vec3:
        """Derivative of the position at a station by a coordinate."""
        return self.combined(self.strains.sections.from_root(xi), self.partial_tangents[i]).scaled(self.along.L)

    def angular_rates(self, w: Vec3, alpha: Vec3, speeds: Sequence[Edge]) -> list[tuple[Vec3, Vec3]]:
        """Angular velocity of each section in the world, and its rate at constant speeds, in B (11)."""
        if self.axis is not None:
            spins = [self.spin(section, speeds) for section in self.sections]
            return [(w + spin, alpha + w.cross(spin)) for spin in spins]
        rates, section = [(w, alpha)], self.root
        for step, following in zip(self._steps, self.sections[1:], strict=True):
            change = self._moments(step.tables, speeds)
            spinning = step.spinning(section.R_BS, following.R_BS)  # The nodes that partial velocities are made of.
            relative, relative_rate = step.rates(change, section.R_BS, spinning)
            alpha = alpha + (w.cross(relative) + relative_rate)
            w, section = w + relative, following
            rates.append((w, alpha))
        return rates

    def spin(self, section: SectionFrame, speeds: Sequence[Edge]) -> Vec3:
        """Angular velocity of a section in B."""
        total = Vec3(self.g)
        for spin, speed in zip(section.spins, speeds, strict=True):
            total = total + spin.scaled(speed)
        return total
