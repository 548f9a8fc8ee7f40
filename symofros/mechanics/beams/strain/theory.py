"""Geometrically exact beams, rods: what is known of one, its number of sections, and these in numbers (rods.md)."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from symofros.description.beams.beam import MAX_SECTIONS, Beam
from symofros.description.beams.elastic import PRE_STRAINS, STRAINS, Direction
from symofros.description.beams.shapes import Family, UserShape
from symofros.description.values import Value
from symofros.expr.edges import Edge
from symofros.expr.expression import evaluate
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import Evaluation
from symofros.expr.program import Program
from symofros.expr.vector import Mat3
from symofros.mechanics.beams.fields import Field
from symofros.mechanics.beams.integrals import Lower
from symofros.mechanics.beams.piecewise import Piecewise
from symofros.mechanics.beams.strain.planar import strain_equations
from symofros.mechanics.beams.strain.section_law import section_law
from symofros.mechanics.beams.strain.strains import AXES, TURNING, strain_functions, strains_of
from symofros.mechanics.beams.theory import Array, BeamEquations, BeamShape, BeamTheory, Interpolated, Judged

# Stations at which the shapes of a rod by its own sections and by twice as many are compared.
_COMPARED = tuple(k / 8 for k in range(1, 9))


class StrainShape(BeamShape):
    """Where sections of a rod are, for given strain coordinates (docs/theory/rods.md, section 3).

    Args:
        beam: The rod as described.
        values: Number of each parameter.
        stations: Stations x/L (S).
    """

    def __init__(self, beam: Beam, values: Mapping[str, float], stations: Sequence[float]) -> None:
        g = Graph()

        def lower(value: Value) -> Edge:
            return g.constant(evaluate(value, values))

        rod = strain_equations(g, lower, beam, tuple(g.input("q", i) for i in range(beam.modes)))
        inverse = g.div(g.constant(1.0), rod.along.L)
        edges: list[Edge] = []
        for xi in stations:
            edges += [*rod.position(xi).scaled(inverse), *rod.section_at(xi).R_BS.entries]
        self._evaluate = Evaluation(Program(beam.name, g, {"q": beam.modes}, ()), edges, {})
        self._stations = len(stations)

    def sections(self, q: Array) -> tuple[Array, Array]:
        """Positions over the length (..., S, 3) and rotations R_BS (..., S, 3, 3) for coordinates (..., n)."""
        flat = np.reshape(q, (-1, q.shape[-1]))
        values = self._evaluate({"q": flat})
        table = np.empty((len(flat), len(values)))
        for k, value in enumerate(values):
            table[:, k] = value
        table = table.reshape(*q.shape[:-1], self._stations, 12)
        return table[..., :3], table[..., 3:].reshape(*q.shape[:-1], self._stations, 3, 3)

    def points(self, length: float, q: Array) -> Array:
        """p_BS of the stations, in the axes of the root (..., S, 3) [m]."""
        return length * self.sections(q)[0]

    def axes(self, length: float, q: Array) -> Array:
        """R_BS of the sections (..., S, 3, 3)."""
        return self.sections(q)[1]


class IntegrationError:
    """Error of a rod's shape by its number of sections, as the difference to that of twice as many, or of half.

    Args:
        beam: The rod as described.
        values: Number of each parameter.
    """

    def __init__(self, beam: Beam, values: Mapping[str, float]) -> None:
        points = strains_of(beam).points
        # Of half as many, which err by more, where twice as many are more than a rod may have.
        compared = 2 * points if 2 * points <= MAX_SECTIONS else points // 2
        self._own = StrainShape(beam, values, _COMPARED)
        self._other = StrainShape(replace(beam, sections=compared), values, _COMPARED)

    def __call__(self, q: Array) -> float:
        """Largest error of a position over the length, for coordinates (n)."""
        (own, _), (other, _) = (shape.sections(np.asarray(q, dtype=np.float64)) for shape in (self._own, self._other))
        return float(np.linalg.norm(own - other, axis=-1).max())


Number = Callable[[Value, float], float]
# Bound of the distance between frames within the rod and where its strains without stress put them, over its length: a
# fifth of what a note begins at, and less than two functions a strain leave of Bathe's arc.
_BOUND = 2e-3
# Stations at which strains without stress are looked at.
_STATIONS = 33


def with_sections(beam: Beam, number: Number) -> Beam:
    """The same rod; where its sections are left to the generator, with those that its own curvature needs, too.

    Args:
        beam: Rod of a checked system.
        number: The number of a value at a station x [m]; NaN where it has none.
    """
    if not beam.modes or beam.sections:
        return beam
    needed = sections_of_turn(*_turn(beam, number))
    if needed <= 2:
        return beam
    chosen = len(strains_of(beam).sections.stations) - 1
    return replace(beam, sections=min(MAX_SECTIONS, chosen + needed - 2))


def sections_of_turn(turn: float, amplitude: float) -> int:
    """Sections, at least 2, through which a tangent that turns is interpolated to the bound.

    Args:
        turn: Angle by which the sections turn from the root to the tip [rad].
        amplitude: Share of the tangent that turns.
    """
    count, error = 2, amplitude * (0.25 * turn) ** 3 / 6.0
    while error > _BOUND:
        count += 1
        error *= 0.25 * turn / (count + 1)
    return count


def _turn(beam: Beam, number: Number) -> tuple[float, float]:
    """Angle by which the sections turn without stress, and the largest share of that which bends the axis."""
    length = number(beam.length, 0.0)
    if all(isinstance(getattr(beam, label), (int, float)) and not getattr(beam, label) for label in PRE_STRAINS):
        return 0.0, 0.0
    rows = np.array(
        [[number(getattr(beam, label), float(x)) for label in PRE_STRAINS] for x in np.linspace(0.0, length, _STATIONS)]
    )
    if not np.all(np.isfinite(rows)):
        return 0.0, 0.0
    rates = np.linalg.norm(rows, axis=1)
    largest = float(rates.max())
    if largest == 0.0:
        return 0.0, 0.0
    bends = float(np.linalg.norm(rows[:, 1:], axis=1).max())
    turn = length * float((0.5 * (rates[1:] + rates[:-1])).mean())
    return (turn, bends / largest) if math.isfinite(turn) else (0.0, 0.0)


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
    def strains(self) -> Mapping[int, Field]:
        """Changes of the strains."""
        strains = strains_of(self.beam)
        return {axis: strains.strain(axis) for axis in sorted({axis for axis, _ in strains.axes})}

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
