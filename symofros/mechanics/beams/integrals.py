"""Integrals over the length of a beam, or from a station to the tip: Fields weighted by sections become Forms.

A property that is the same along the beam stands before the integral, which is then exact (rational where the shape
functions are). One that changes is taken at Gauss stations on every interval between knots, where fields are rounded
once: a product of polynomials of high degree has coefficients that cancel, twelve digits of them for eight functions.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

from symofros.description.beams.beam import STATION, Beam
from symofros.description.values import Value, symbols
from symofros.expr.edges import ZERO, Edge
from symofros.expr.expression import Expression
from symofros.expr.graph import Graph
from symofros.mechanics.beams.fields import Field, Form, Monomial, UnitIntegral, exponent, length_power
from symofros.mechanics.beams.piecewise import Number, Piecewise
from symofros.mechanics.beams.quadrature import stations

# Gauss nodes an interval for properties that change along the beam, exact to degree 31: what pieces of splines and of
# fitted functions ask for. Polynomials over the whole length get as many more as their own degree takes.
POINTS = 16

Lower = Callable[[Value], Edge]


@dataclass(frozen=True)
class LengthIntegrator:
    """Integration over the length of one beam.

    Attributes:
        g: The graph.
        lower: Lowering of values of the description to edges.
        length: Length as described [m].
        coordinates: Edges of the elastic coordinates.
        knots: Stations xi where pieces of the shape functions meet.
        points: Number of Gauss nodes an interval.
        start: Station xi from which integrals are taken, to the tip.
    """

    g: Graph
    lower: Lower
    length: Value
    coordinates: tuple[Edge, ...]
    knots: tuple[Number, ...]
    points: int = POINTS
    start: Number = 0

    @property
    def _ends(self) -> tuple[Number, ...]:
        """Ends of the intervals that are integrated over."""
        return (self.start, *(knot for knot in self.knots if knot > self.start))

    @cached_property
    def L(self) -> Edge:
        """Length as an edge."""
        return self.lower(self.length)

    def integral(self, field: Field, weight: Value) -> Form:
        """The integral of weight times field over the length."""
        g = self.g
        if is_uniform(weight):
            return self.uniform(UnitIntegral.of(field, self.start), weight)
        assert isinstance(weight, Expression)
        xi, w = stations(self._ends, self.points)
        values = [self.lower(at_station(weight, self.length, x)) for x in xi]
        terms = {mono: _weighted(g, f, xi, w, values) for mono, f in field.terms.items()}
        return self._scaled(field.power + 1, field.lengths, terms)

    def uniform(self, integral: UnitIntegral, weight: Value) -> Form:
        """The integral of a field whose weight does not change along the beam."""
        g, factor = self.g, self.lower(weight)
        terms = {mono: g.mul(g.constant(number), factor) for mono, number in integral.terms.items()}
        return self._scaled(integral.power, integral.lengths, terms)

    def shares(self, weight: Value) -> list[tuple[float, Edge]]:
        """Gauss stations, each with its share of the weight's integral: for integrands that are not polynomials."""
        g = self.g
        shares = []
        for xi, w in zip(*stations(self._ends, self.points), strict=True):
            value = at_station(weight, self.length, xi) if isinstance(weight, Expression) else weight
            shares.append((xi, g.mul(g.constant(w), g.mul(self.lower(value), self.L))))
        return shares

    def at(self, field: Field, xi: float) -> Form:
        """The field at one station."""
        return field.at(self.g, self.coordinates, self.L, xi)

    def _scaled(self, power: int, lengths: tuple[bool, ...], terms: dict[Monomial, Edge]) -> Form:
        g = self.g
        return Form(
            g,
            self.coordinates,
            {
                mono: g.mul(edge, length_power(g, self.L, exponent(power, lengths, mono)))
                for mono, edge in terms.items()
                if edge != ZERO
            },
        )


def is_uniform(weight: Value) -> bool:
    """Whether a property is the same along the beam."""
    return STATION not in symbols(weight)


def _weighted(g: Graph, f: Piecewise, xi: Sequence[float], w: Sequence[float], values: Sequence[Edge]) -> Edge:
    return g.sum(g.mul(g.constant(a * x), value) for a, x, value in zip(w, f.rounded(xi), values, strict=True))


def points_for(functions: Sequence[Piecewise]) -> int:
    """Number of Gauss nodes an interval that integrates every field of the functions times a weight of degree 15.

    The field of highest degree is u^2 in the second moments, 4 d - 2 for functions of degree d.
    """
    if any(len(phi.pieces) > 1 for phi in functions):
        return POINTS
    return max(POINTS, 2 * max((phi.degree for phi in functions), default=0) + 7)


def at_middle(section: Value, beam: Beam) -> Value:
    """A section property at mid-length."""
    return at_station(section, beam.length, 0.5) if isinstance(section, Expression) else section


def at_station(formula: Expression, length: Value, xi: float) -> Expression:
    """A formula of the station x with x = xi times the length."""
    if formula.kind == "symbol" and formula.name == STATION:
        whole = length if isinstance(length, Expression) else Expression("number", number=length)
        return Expression("mul", (Expression("number", number=xi), whole))
    if not formula.args:
        return formula
    return Expression(
        formula.kind, tuple(at_station(arg, length, xi) for arg in formula.args), formula.number, formula.name
    )
