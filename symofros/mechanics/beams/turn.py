"""The turn from one section of a rod to the next, by Magnus's series (docs/theory/rods.md, 5 to 11)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from symofros.expr.edges import ONE, Edge
from symofros.expr.graph import Graph
from symofros.expr.vector import Mat3, Vec3

# Factors of the commutators of fifth and sixth order (6).
_INNER, _OUTER, _SECOND = 1.0 / 60.0, 0.6, 6.0


@dataclass(frozen=True)
class Moments:
    """Moments of the strains between two stations, or a change of them (5).

    Attributes:
        zeroth: Integral of the strains.
        first: First moment about the middle, over the distance.
        second: Second moment about the middle, over the square of the distance, beyond that of constant strains; None
            where the series ends with the fourth order.
    """

    zeroth: Vec3
    first: Vec3
    second: Vec3 | None


@dataclass(frozen=True)
class Turn:
    """The turn between two stations, in the axes of the first (5)-(8).

    Attributes:
        moments: Moments of the strains between the stations.
        tables: Derivatives of the three moments by each coordinate, about the coordinate's own axis.
        vector: Rotation vector.
        half: Half the ratio of the tangent of half the angle to half the angle, and its first two derivatives by the
            square of the angle.
        gibbs: Gibbs vector, `half` times the rotation vector.
        factor: Factor 2/(1 + a.a) of the angular velocity, a the Gibbs vector.
    """

    moments: Moments
    tables: tuple[tuple[float, ...], ...]
    vector: Vec3
    half: tuple[Edge, Edge, Edge]
    gibbs: Vec3
    factor: Edge

    @staticmethod
    def of(moments: Moments, tables: tuple[tuple[float, ...], ...]) -> Turn:
        """The turn by its moments of the strains, and their derivatives by each coordinate."""
        g, b = moments.zeroth.g, moments
        moved = b.zeroth.cross(b.first)
        if b.second is None:
            vector = b.zeroth + moved
        else:
            outer = moved.scaled(g.constant(_OUTER)) - b.second.scaled(g.constant(_SECOND))
            vector = b.zeroth + moved.scaled(_inner(b)) + outer.cross(b.first)
            vector = vector + b.zeroth.cross(b.zeroth.cross(b.second)).scaled(g.constant(0.5))
        half = _half_tangent(g, vector.dot(vector))
        gibbs = vector.scaled(half[0])
        factor = g.div(g.constant(2.0), g.add(ONE, gibbs.dot(gibbs)))
        return Turn(moments, tables, vector, half, gibbs, factor)

    def vector_change(self, change: Moments) -> Vec3:
        """Derivative of the rotation vector by a change of the moments (6a)."""
        b = self.moments
        g, (u, v, n) = b.zeroth.g, (change.zeroth, change.first, change.second)
        moved, moved_change = b.zeroth.cross(b.first), u.cross(b.first) + b.zeroth.cross(v)
        if b.second is None or n is None:
            return u + moved_change
        outer, second = g.constant(_OUTER), g.constant(_SECOND)
        total = u + moved_change.scaled(_inner(b)) + moved.scaled(g.mul(g.constant(2.0 * _INNER), b.zeroth.dot(u)))
        total = total + (moved_change.scaled(outer) - n.scaled(second)).cross(b.first)
        total = total + (moved.scaled(outer) - b.second.scaled(second)).cross(v)
        bent = u.cross(b.zeroth.cross(b.second)) + b.zeroth.cross(u.cross(b.second) + b.zeroth.cross(n))
        return total + bent.scaled(g.constant(0.5))

    def _vector_bend(self, change: Moments) -> Vec3:
        """Second derivative of the rotation vector along a change of the moments (6b)."""
        b = self.moments
        g, (u, v, n) = b.zeroth.g, (change.zeroth, change.first, change.second)
        moved, moved_change = b.zeroth.cross(b.first), u.cross(b.first) + b.zeroth.cross(v)
        both = u.cross(v)
        both = both + both
        if b.second is None or n is None:
            return both
        outer, second = g.constant(_OUTER), g.constant(_SECOND)
        total = both.scaled(_inner(b)) + moved_change.scaled(g.mul(g.constant(4.0 * _INNER), b.zeroth.dot(u)))
        total = total + moved.scaled(g.mul(g.constant(2.0 * _INNER), u.dot(u))) + both.scaled(outer).cross(b.first)
        across = (moved_change.scaled(outer) - n.scaled(second)).cross(v)
        bent = u.cross(u.cross(b.second) + b.zeroth.cross(n)) + b.zeroth.cross(u.cross(n))
        return total + (across + across) + bent

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

    def rates(self, change: Moments) -> tuple[Vec3, Vec3]:
        """Angular velocity of the second section relative to the first, and its rate (11).

        Args:
            change: Rates of the moments of the strains, which are constant.
        """
        g, x, a = self.vector.g, self.vector, self.gibbs
        two, (h, slope, bend) = g.constant(2.0), self.half
        x1, x2 = self.vector_change(change), self._vector_bend(change)
        square1 = g.mul(two, x.dot(x1))
        square2 = g.mul(two, g.add(x1.dot(x1), x.dot(x2)))
        h1 = g.mul(slope, square1)
        h2 = g.add(g.mul(bend, g.mul(square1, square1)), g.mul(slope, square2))
        a1 = x1.scaled(h) + x.scaled(h1)
        a2 = x2.scaled(h) + x1.scaled(g.add(h1, h1)) + x.scaled(h2)
        relative = (a1 + a.cross(a1)).scaled(self.factor)
        rate = (a2 + a.cross(a2) - relative.scaled(a.dot(a1))).scaled(self.factor)
        return relative, rate


def _inner(b: Moments) -> Edge:
    """Factor of B0 x B1 in the rotation vector."""
    g = b.zeroth.g
    return g.add(ONE, g.mul(g.constant(_INNER), b.zeroth.dot(b.zeroth)))


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
