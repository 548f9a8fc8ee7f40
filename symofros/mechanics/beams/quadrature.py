"""Quadrature over the length of a beam, by intervals between knots, and the polynomials through its nodes.

Nodes and weights are numbers formed by sums, products and quotients in extended precision: the same on every machine.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise

from symofros.expr.numerics.extended import Extended, extended_context
from symofros.mechanics.beams.piecewise import Number

Rule = tuple[tuple[float, ...], tuple[float, ...]]

# Newton's method doubles the digits: from two of them, for the quadrature of two points, to a double's.
_NEWTON_STEPS = 5


@lru_cache(maxsize=16)
def gauss(points: int) -> Rule:
    """Nodes, rising, and weights of Gauss-Legendre quadrature on [0, 1]."""
    upper = [_gauss_node(points, i) for i in range((points + 1) // 2)]
    lower = [(-x, w) for x, w in upper[: points // 2]]
    rule = lower + upper[::-1]
    return tuple(float((1 + x) / 2) for x, _ in rule), tuple(float(w / 2) for _, w in rule)


def _gauss_node(n: int, i: int) -> tuple[Extended, Extended]:
    """Root i of the Legendre polynomial P_n, from the largest, and its weight, by Newton's method."""
    x: Extended = math.cos(math.pi * (4 * i + 3) / (4 * n + 2))  # Abramowitz & Stegun 22.16.6.
    for _ in range(_NEWTON_STEPS):
        value, slope = _legendre(n, x)
        x -= value / slope
    # From a double's digits to all that count in two steps more, wherever the first ones ended.
    x = extended_context().mpf(x)
    for _ in range(2):
        value, slope = _legendre(n, x)
        x -= value / slope
    return x, 2 / ((1 - x * x) * slope * slope)


def _legendre(n: int, x: Extended) -> tuple[Extended, Extended]:
    """P_n(x) and P_n'(x)."""
    before, value = 1, x
    for k in range(2, n + 1):
        before, value = value, ((2 * k - 1) * x * value - (k - 1) * before) / k
    return value, n * (before - x * value) / (1 - x * x)


@lru_cache(maxsize=16)
def radau(points: int) -> Rule:
    """Nodes, rising from 0, and weights of the Gauss-Radau quadrature on [0, 1] that has a node at 0."""
    nodes, weights = [0.0], [float(extended_context().mpf(1) / points**2)]
    for i in range(1, points):
        x, before = _radau_node(points, i)
        nodes.append(float((1 + x) / 2))
        weights.append(float((1 - x) / (2 * (points * before) ** 2)))
    return tuple(nodes), tuple(weights)


def _radau_node(n: int, i: int) -> tuple[Extended, Extended]:
    """Root i > 0 of P_(n-1) + P_n, rising from -1, by Newton's method, and P_(n-1) there."""
    x: Extended = -math.cos(2 * math.pi * i / (2 * n - 1))  # The same of Chebyshev's polynomials.
    for step in range(_NEWTON_STEPS + 2):
        if step == _NEWTON_STEPS:
            x = extended_context().mpf(x)
        (before, before_slope), (value, slope) = _legendre(n - 1, x), _legendre(n, x)
        x -= (before + value) / (before_slope + slope)
    return x, _legendre(n - 1, x)[0]


@dataclass(frozen=True)
class Nodes:
    """Nodes of a quadrature on every interval between knots, and Lagrange's polynomials through those of each.

    Attributes:
        knots: Ends of the intervals, from 0 to 1.
        rules: Nodes on [0, 1] and weights of each interval, exact for products of two of their polynomials.
    """

    knots: tuple[Number, ...]
    rules: tuple[Rule, ...]

    @cached_property
    def stations(self) -> tuple[float, ...]:
        """Stations xi of the nodes, rising."""
        intervals = zip(pairwise(self.knots), self.rules, strict=True)
        return tuple(float(a) + float(b - a) * node for (a, b), (nodes, _) in intervals for node in nodes)

    @cached_property
    def weights(self) -> tuple[float, ...]:
        """Weights of the nodes."""
        intervals = zip(pairwise(self.knots), self.rules, strict=True)
        return tuple(float(b - a) * weight for (a, b), (_, weights) in intervals for weight in weights)

    def from_root(self, xi: float) -> tuple[float, ...]:
        """Weights of the nodes in the integral from the root to a station, by the polynomials through them (10)."""
        row: list[float] = []
        for (a, b), (nodes, weights) in zip(pairwise(map(float, self.knots)), self.rules, strict=True):
            upto = min(max((xi - a) / (b - a), 0.0), 1.0)
            shares = (_partial_weight(len(nodes), node, upto) for node in nodes)
            row += [(b - a) * weight * share for weight, share in zip(weights, shares, strict=True)]
        return tuple(row)

    def through(self, xi: float) -> tuple[float, ...]:
        """Weights of the nodes in the value at a station inside an interval, by the polynomials through its nodes."""
        row: list[float] = []
        for (a, b), (nodes, weights) in zip(pairwise(map(float, self.knots)), self.rules, strict=True):
            inside = a < xi < b
            polynomials = (_polynomial(len(nodes), node, (xi - a) / (b - a)) if inside else 0.0 for node in nodes)
            row += [weight * value for weight, value in zip(weights, polynomials, strict=True)]
        return tuple(row)

    def beyond(self, xi: float) -> tuple[float, ...]:
        """Weights of the nodes in the integral from a station to the tip, by the polynomials through them."""
        return tuple(w - a for w, a in zip(self.weights, self.from_root(xi), strict=True))


def stations(knots: Sequence[Number], points: int) -> tuple[list[float], list[float]]:
    """Gauss nodes and weights on every interval between knots.

    Args:
        knots: Ends of the intervals, from 0 to 1.
        points: Number of nodes an interval.
    """
    nodes = Nodes(tuple(knots), (gauss(points),) * (len(knots) - 1))
    return list(nodes.stations), list(nodes.weights)


def _partial_weight(points: int, node: float, upto: float) -> float:
    """The integral from 0 to a station of a node's polynomial of Lagrange, over the node's weight.

    It is the sum of (2 n + 1) P_n(node) P_n over n < points, and the integral of P_n is a difference of neighbours.
    """
    at, end = _legendre_values(points + 1, 2.0 * node - 1.0), _legendre_values(points + 1, 2.0 * upto - 1.0)
    return upto + sum(at[n] * 0.5 * (end[n + 1] - end[n - 1]) for n in range(1, points))


def _polynomial(points: int, node: float, xi: float) -> float:
    """A node's polynomial of Lagrange at a station, over the node's weight."""
    at, end = _legendre_values(points, 2.0 * node - 1.0), _legendre_values(points, 2.0 * xi - 1.0)
    return sum((2 * n + 1) * at[n] * end[n] for n in range(points))


def _legendre_values(count: int, z: float) -> list[float]:
    """P_0(z) to P_count(z)."""
    values = [1.0, z]
    for k in range(2, count + 1):
        values.append(((2 * k - 1) * z * values[-1] - (k - 1) * values[-2]) / k)
    return values
