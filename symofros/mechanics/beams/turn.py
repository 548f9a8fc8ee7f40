"""The turn from one section of a rod to the next, by Magnus's series to fourth order (docs/theory/rods.md, 5 to 11)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from symofros.expr.edges import ONE, Edge
from symofros.expr.graph import Graph
from symofros.expr.vector import Mat3, Vec3


@dataclass(frozen=True)
class Turn:
    """The turn between two stations, in the axes of the first (5)-(8).

    Attributes:
        zeroth: Integral of the strains between the stations.
        first: First moment of the strains about the middle, over the distance.
        tables: Derivatives of both by each coordinate, about the coordinate's own axis.
        vector: Rotation vector.
        half: Half the ratio of the tangent of half the angle to half the angle, and its first two derivatives by the
            square of the angle.
        gibbs: Gibbs vector, `half` times the rotation vector.
        factor: Factor 2/(1 + a.a) of the angular velocity, a the Gibbs vector.
    """

    zeroth: Vec3
    first: Vec3
    tables: tuple[tuple[float, ...], tuple[float, ...]]
    vector: Vec3
    half: tuple[Edge, Edge, Edge]
    gibbs: Vec3
    factor: Edge

    @staticmethod
    def of(zeroth: Vec3, first: Vec3, tables: tuple[tuple[float, ...], tuple[float, ...]]) -> Turn:
        """The turn by its moments of the strains, and their derivatives by each coordinate."""
        g = zeroth.g
        vector = zeroth + zeroth.cross(first)
        half = _half_tangent(g, vector.dot(vector))
        gibbs = vector.scaled(half[0])
        factor = g.div(g.constant(2.0), g.add(ONE, gibbs.dot(gibbs)))
        return Turn(zeroth, first, tables, vector, half, gibbs, factor)

    @cached_property
    def rotation(self) -> Mat3:
        """Rotation from the second section to the first, 1 + c ([a] + [a]^2) (8)."""
        g, a = self.vector.g, self.gibbs
        columns = []
        for unit in (Vec3.unit(g, k) for k in range(3)):
            over = a.cross(unit)
            columns.append(unit + (over + a.cross(over)).scaled(self.factor))
        return Mat3.from_columns(g, columns)

    @cached_property
    def spinning(self) -> Mat3:
        """Matrix D of (9), from rates of the rotation vector to the angular velocity in the axes of the first section.

        It is c ([a] h + h + 2 h' x x^T), with a = h x.
        """
        g, a = self.vector.g, self.gibbs
        along = g.mul(g.mul(g.constant(2.0), self.half[1]), self.factor)
        across = g.mul(self.half[0], self.factor)
        columns = []
        for k, unit in enumerate(Vec3.unit(g, k) for k in range(3)):
            column = (unit + a.cross(unit)).scaled(across)
            columns.append(column + self.vector.scaled(g.mul(along, tuple(self.vector)[k])))
        return Mat3.from_columns(g, columns)

    def rates(self, zeroth: Vec3, first: Vec3) -> tuple[Vec3, Vec3]:
        """Angular velocity of the second section relative to the first, and its rate (11).

        Args:
            zeroth: Rate of the integral of the strains, which is constant.
            first: Rate of their first moment.
        """
        g, x, a = self.vector.g, self.vector, self.gibbs
        two, (h, slope, bend) = g.constant(2.0), self.half
        x1 = zeroth + zeroth.cross(self.first) + self.zeroth.cross(first)
        both = zeroth.cross(first)
        x2 = both + both
        square1 = g.mul(two, x.dot(x1))
        square2 = g.mul(two, g.add(x1.dot(x1), x.dot(x2)))
        h1 = g.mul(slope, square1)
        h2 = g.add(g.mul(bend, g.mul(square1, square1)), g.mul(slope, square2))
        a1 = x1.scaled(h) + x.scaled(h1)
        a2 = x2.scaled(h) + x1.scaled(g.add(h1, h1)) + x.scaled(h2)
        relative = (a1 + a.cross(a1)).scaled(self.factor)
        rate = (a2 + a.cross(a2) - relative.scaled(a.dot(a1))).scaled(self.factor)
        return relative, rate


def _half_tangent(g: Graph, square: Edge) -> tuple[Edge, Edge, Edge]:
    """tan(theta/2)/theta as a rational function of theta^2, and its first two derivatives by theta^2 (7)."""
    s = g.mul(g.constant(0.25), square)
    below = g.add(g.constant(210.0), g.mul(s, g.sub(g.add(s, s), g.constant(90.0))))
    inverse = g.div(ONE, below)
    value = g.mul(g.sub(g.constant(105.0), g.mul(g.constant(10.0), s)), inverse)
    # Of value * below = 105 - 10 s, with below' = 4 s - 90.
    below_rate = g.sub(g.mul(g.constant(4.0), s), g.constant(90.0))
    slope = g.mul(g.sub(g.constant(-10.0), g.mul(value, below_rate)), inverse)
    twice = g.add(slope, slope)
    bend = -g.mul(g.add(g.mul(twice, below_rate), g.mul(g.constant(4.0), value)), inverse)
    return value, g.mul(g.constant(0.25), slope), g.mul(g.constant(0.0625), bend)
