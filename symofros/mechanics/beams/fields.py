"""Fields along a beam and their integrals, as polynomials in the elastic coordinates.

A Field is a function of the station whose coefficients multiply products of coordinates; integrating it gives a Form,
a polynomial whose coefficients are edges that depend on parameters only. Truncation is a bound on the degree, and
stands in one place: `Form.value`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import combinations_with_replacement
from typing import NamedTuple

from symofros.expr.edges import ZERO, Edge
from symofros.expr.graph import Graph
from symofros.mechanics.beams.piecewise import Number, Piecewise, polynomial

Monomial = tuple[int, ...]  # Indices of the coordinates that are multiplied, in rising order.
EVERY_DEGREE = math.inf


@dataclass(frozen=True)
class Field:
    """A sum over monomials of (function of xi) L^p (product of coordinates).

    Attributes:
        power: Exponent p of the monomial of degree 0.
        lengths: Whether each coordinate is a displacement; each such factor in a monomial lowers p by one.
        terms: Function of xi by monomial.
    """

    power: int
    lengths: tuple[bool, ...]
    terms: Mapping[Monomial, Piecewise]

    def __add__(self, other: Field) -> Field:
        assert self.power == other.power
        terms = dict(self.terms)
        for mono, f in other.terms.items():
            terms[mono] = terms[mono] + f if mono in terms else f
        return Field(self.power, self.lengths, terms)

    def __neg__(self) -> Field:
        return self.scaled(-1)

    def __sub__(self, other: Field) -> Field:
        return self + -other

    def scaled(self, factor: Number) -> Field:
        """Factor times the field."""
        return Field(self.power, self.lengths, {mono: f.scaled(factor) for mono, f in self.terms.items()})

    def times(self, other: Field, upto: float = EVERY_DEGREE) -> Field:
        """The product, without monomials above a degree."""
        terms: dict[Monomial, Piecewise] = {}
        for a, f in self.terms.items():
            for b, h in other.terms.items():
                if len(a) + len(b) <= upto:
                    mono = tuple(sorted(a + b))
                    terms[mono] = terms[mono] + f * h if mono in terms else f * h
        return Field(self.power + other.power, self.lengths, {m: f for m, f in terms.items() if not f.is_zero})

    @cached_property
    def _derivatives(self) -> dict[int, Field]:
        """Derivatives that were asked for, by coordinate: products of them are formed by pairs."""
        return {}

    def by(self, i: int) -> Field:
        """The derivative with respect to coordinate i."""
        if i not in self._derivatives:
            terms: dict[Monomial, Piecewise] = {}
            for mono, f in self.terms.items():
                count = mono.count(i)
                if count:
                    at = mono.index(i)
                    terms[mono[:at] + mono[at + 1 :]] = f.scaled(count)
            self._derivatives[i] = Field(self.power - self.lengths[i], self.lengths, terms)
        return self._derivatives[i]

    def along(self) -> Field:
        """The derivative with respect to x."""
        terms = {mono: f.derivative() for mono, f in self.terms.items()}
        return Field(self.power - 1, self.lengths, {m: f for m, f in terms.items() if not f.is_zero})

    def from_root(self) -> Field:
        """The integral over x from the root to the station."""
        return Field(self.power + 1, self.lengths, {mono: f.antiderivative() for mono, f in self.terms.items()})

    def exponent(self, mono: Monomial) -> int:
        """The power of L that goes with a monomial."""
        return exponent(self.power, self.lengths, mono)

    def at(self, g: Graph, coordinates: Sequence[Edge], L: Edge, xi: float) -> Form:
        """The value of the field at one station, as a form."""
        station = Fraction(xi)  # Exact: stations are doubles.
        values = {mono: float(f(station)) for mono, f in self.terms.items()}
        return Form(
            g,
            tuple(coordinates),
            {mono: g.mul(g.constant(x), length_power(g, L, self.exponent(mono))) for mono, x in values.items() if x},
        )


def exponent(power: int, lengths: tuple[bool, ...], mono: Monomial) -> int:
    """The power of L that goes with a monomial.

    Args:
        power: Exponent of the monomial of degree 0.
        lengths: Whether each coordinate is a displacement.
        mono: Monomial.
    """
    return power - sum(lengths[i] for i in mono)


def length_power(g: Graph, L: Edge, exponent: int) -> Edge:
    """A power of L with a whole exponent."""
    return g.power(L, g.constant(float(exponent)))


class UnitIntegral(NamedTuple):
    """The integral of a field over xi, for sections that do not change.

    Attributes:
        power: Exponent of the length of the monomial of degree 0, that of dx included.
        lengths: Whether each coordinate is a displacement.
        terms: Number by monomial.
    """

    power: int
    lengths: tuple[bool, ...]
    terms: Mapping[Monomial, float]

    @classmethod
    def of(cls, field: Field, start: Number = 0) -> UnitIntegral:
        """The integral of a field from a station to the tip."""
        terms = {mono: float(_integral(f, start)) for mono, f in field.terms.items()}
        return cls(field.power + 1, field.lengths, terms)


def _integral(f: Piecewise, start: Number) -> Number:
    return f.integral() - f.antiderivative()(start) if start else f.integral()


@dataclass(frozen=True)
class Form:
    """A polynomial in the elastic coordinates with edges as coefficients.

    Attributes:
        g: The graph.
        coordinates: Edges of the elastic coordinates.
        terms: Coefficient by monomial.
    """

    g: Graph
    coordinates: tuple[Edge, ...]
    terms: Mapping[Monomial, Edge]

    def __add__(self, other: Form) -> Form:
        terms = dict(self.terms)
        for mono, edge in other.terms.items():
            terms[mono] = self.g.add(terms.get(mono, ZERO), edge)
        return Form(self.g, self.coordinates, terms)

    def __neg__(self) -> Form:
        return Form(self.g, self.coordinates, {mono: -edge for mono, edge in self.terms.items()})

    def __sub__(self, other: Form) -> Form:
        return self + -other

    def scaled(self, factor: Edge) -> Form:
        """Factor times the form."""
        return Form(self.g, self.coordinates, {mono: self.g.mul(factor, edge) for mono, edge in self.terms.items()})

    def by(self, i: int) -> Form:
        """The derivative with respect to coordinate i."""
        g = self.g
        terms: dict[Monomial, Edge] = {}
        for mono, edge in self.terms.items():
            if i in mono:
                at = mono.index(i)
                terms[mono[:at] + mono[at + 1 :]] = g.mul(g.constant(float(mono.count(i))), edge)
        return Form(g, self.coordinates, terms)

    def second_derivatives(self) -> list[list[Edge]]:
        """The second derivatives where all coordinates are zero."""
        n, g = len(self.coordinates), self.g
        matrix = [[ZERO] * n for _ in range(n)]
        for mono, edge in self.terms.items():
            if len(mono) == 2:
                i, j = mono
                matrix[i][j] = g.add(matrix[i][j], edge)
                matrix[j][i] = g.add(matrix[j][i], edge)
        return matrix

    def without_constant(self) -> Form:
        """The form without its term of degree 0."""
        return Form(self.g, self.coordinates, {mono: edge for mono, edge in self.terms.items() if mono})

    def upto(self, degree: float) -> Form:
        """The form without monomials above a degree."""
        return Form(self.g, self.coordinates, {mono: edge for mono, edge in self.terms.items() if len(mono) <= degree})

    @cached_property
    def gradient(self) -> tuple[Form, ...]:
        """The derivatives with respect to each coordinate."""
        return tuple(self.by(i) for i in range(len(self.coordinates)))

    def value(self, upto: float = EVERY_DEGREE) -> Edge:
        """The polynomial's value without the monomials above a degree: the one place where orders are cut."""
        return self._nested({mono: edge for mono, edge in self.upto(upto).terms.items() if edge != ZERO})

    def _nested(self, terms: Mapping[Monomial, Edge]) -> Edge:
        """The sum as c + sum_i x_i (c_i + sum_(j >= i) x_j (...)): each monomial costs one product."""
        g = self.g
        total = terms.get((), ZERO)
        grouped: dict[int, dict[Monomial, Edge]] = {}
        for mono, edge in terms.items():
            if mono:
                grouped.setdefault(mono[0], {})[mono[1:]] = edge
        for i in sorted(grouped):
            total = g.add(total, g.mul(self.coordinates[i], self._nested(grouped[i])))
        return total

    def rate(self, speeds: Sequence[Edge], upto: float = EVERY_DEGREE) -> Edge:
        """The time derivative with given rates of the coordinates; the degree counts coordinates and rates."""
        g = self.g
        parts = zip(self.gradient, speeds, strict=True)
        return g.sum(g.mul(part.value(upto - 1), x) for part, x in parts if x != ZERO)

    def second_rate(self, speeds: Sequence[Edge], upto: float = EVERY_DEGREE) -> Edge:
        """The part of the second time derivative that is quadratic in the rates."""
        g = self.g
        total = ZERO
        moving = [i for i, speed in enumerate(speeds) if speed != ZERO]
        for i, j in combinations_with_replacement(moving, 2):
            part = self.gradient[i].gradient[j].value(upto - 2)
            if part != ZERO:
                product = g.mul(speeds[i], speeds[j])
                total = g.add(total, g.mul(part, product if i == j else g.add(product, product)))
        return total


def no_form(g: Graph, coordinates: Sequence[Edge]) -> Form:
    """The form that vanishes."""
    return Form(g, tuple(coordinates), {})


def unit_field(lengths: tuple[bool, ...]) -> Field:
    """The field that is one everywhere."""
    return Field(0, lengths, {(): polynomial(1)})
