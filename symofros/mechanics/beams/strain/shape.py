"""The sections of a geometrically exact beam in numbers, from the frames that its equations come from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from symofros.description.beams.beam import MAX_SECTIONS, Beam
from symofros.description.values import Value
from symofros.expr.edges import Edge
from symofros.expr.expression import evaluate
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import Evaluation
from symofros.expr.program import Program
from symofros.mechanics.beams.strain.planar import strain_equations
from symofros.mechanics.beams.strain.strains import strains_of
from symofros.mechanics.beams.theory import Array, BeamShape

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
