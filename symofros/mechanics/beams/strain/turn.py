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
        """Rotation from the second section to the first, (c - 1) 1 + c ([a] + a a^T) (8)."""
        g, c = self.vector.g, self.factor
        scaled, rest = self.gibbs.scaled(c), g.sub(c, ONE)
        columns = []
        for unit, component in zip((Vec3.unit(g, k) for k in range(3)), self.gibbs, strict=True):
            columns.append(unit.scaled(rest) + scaled.cross(unit) + scaled.scaled(component))
        return Mat3.from_columns(g, columns)

    @cached_property
    def _slope(self) -> Edge:
        """Twice the derivative of `half` by the square of the angle."""
        return self.vector.g.mul(self.vector.g.constant(2.0), self.half[1])

    def along(self, R: Mat3) -> Vec3:
        """Rotation vector in the axes in which the first section has the rotation R; the second sees the same one."""
        return R.times(self.vector)

    def spinning(self, start: Mat3, end: Mat3) -> Mat3:
        """Matrix T = R D of (9), by (9a), from rates of the rotation vector to the angular velocity in B."""
        g, h = self.vector.g, self.half[0]
        share = g.mul(self.factor, g.sub(self._slope, g.mul(h, g.mul(h, h))))
        lengthwise = self.along(start).scaled(share)
        columns = [
            (end.column(k) + start.column(k)).scaled(h) + lengthwise.scaled(x) for k, x in enumerate(self.vector)
        ]
        return Mat3.from_columns(g, columns)

    def rates(self, change: Moments, start: Mat3, spinning: Mat3) -> tuple[Vec3, Vec3]:
        """Angular velocity of the second section relative to the first, and its rate, in B (11).

        Args:
            change: Rates of the moments of the strains, which are constant.
            start: Rotation of the first section.
            spinning: Matrix T of (9a).
        """
        g, x, c, (h, _, bend) = self.vector.g, self.vector, self.factor, self.half
        slope = self._slope
        x1, x2 = self.vector_change(change), self._vector_bend(change)
        turning, relative = x.dot(x1), spinning.times(x1)
        ratio = g.div(slope, h)
        of_spin = g.sub(g.add(ratio, ratio), g.mul(g.mul(c, h), g.add(h, g.mul(slope, x.dot(x)))))
        of_square = g.sub(g.mul(g.constant(4.0), bend), g.mul(g.constant(2.0), g.mul(slope, ratio)))
        lengthwise = g.add(g.mul(slope, x1.dot(x1)), g.mul(of_square, g.mul(turning, turning)))
        rate = spinning.times(x2) + relative.scaled(g.mul(of_spin, turning))
        return relative, rate + self.along(start).scaled(g.mul(c, lengthwise))


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
