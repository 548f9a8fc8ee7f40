"""Piecewise polynomials on [0, 1]: exact with fractions, to rounding with floats.

Every shape function is one of these, whatever its family: products, integrals and antiderivatives are then the same
few lines, and exact where the coefficients are rational.
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, cached_property, lru_cache
from itertools import chain, pairwise, zip_longest
from typing import cast

from symofros.expr.numerics.extended import Extended, extended_context

Number = Fraction | float | int
Coefficients = tuple[Number, ...]

# Degree of the polynomials that stand for a smooth function on one piece.
_FIT_DEGREE = 14
# Share of a piece's largest coefficient below which one counts as zero: its second derivative, times 14^2 and the
# square of the number of pieces, is still far below a double's rounding.
_NEGLIGIBLE = 1e-24
# Sets of knots beside which a function remembers what it is.
_KEPT = 64


class Knots(tuple[Number, ...]):
    """Ends of the intervals of functions, with what sums over them ask for many times."""

    @cached_property
    def key(self) -> int:
        """A number that equal knots share and others hardly do: fractions are slow to compare."""
        return hash(self)

    @cached_property
    def whole_widths(self) -> tuple[int, tuple[int, ...]]:
        """A denominator of the knots, and the widths of the intervals times it."""
        ends = [Fraction(knot) for knot in self]
        span = math.lcm(*(knot.denominator for knot in ends))
        return span, tuple(int((b - a) * span) for a, b in pairwise(ends))

    def equal(self, other: Knots) -> bool:
        """Whether these are the same numbers."""
        return self is other or (self.key == other.key and self == other)


def _as_knots(ends: Sequence[Number]) -> Knots:
    return ends if isinstance(ends, Knots) else _shared(tuple(ends), tuple(map(type, ends)))


@lru_cache(maxsize=256)
def _shared(knots: tuple[Number, ...], _: tuple[type, ...]) -> Knots:
    """One object for equal knots of the same types."""
    return Knots(knots)


@dataclass(frozen=True)
class Piecewise:
    """A function of xi in [0, 1]: polynomials on consecutive intervals.

    Exact ones hold whole numbers over one denominator, which is many times faster than fractions.

    Attributes:
        knots: Ends of the intervals, from 0 to 1.
        numerators: Coefficients times the denominator, in the distance from the interval's left end, constant first,
            for each interval; whole numbers all, or floats over 1.
        denominator: Denominator of all coefficients, without a factor that they share.
    """

    knots: Knots
    numerators: tuple[Coefficients, ...]
    denominator: int = 1

    @classmethod
    def of(cls, knots: Sequence[Number], pieces: Sequence[Sequence[Number]]) -> Piecewise:
        """The function of these coefficients; of floats where one of them is."""
        ends = _as_knots(knots)
        if any(isinstance(c, float) for piece in pieces for c in piece):
            return cls(ends, tuple(tuple(float(c) for c in piece) for piece in pieces))
        exact = [[Fraction(c) for c in piece] for piece in pieces]
        common = math.lcm(*(c.denominator for piece in exact for c in piece))
        whole = tuple(tuple(c.numerator * (common // c.denominator) for c in piece) for piece in exact)
        return cls._reduced(ends, whole, common)

    @classmethod
    def _reduced(cls, knots: Knots, numerators: tuple[Coefficients, ...], denominator: int) -> Piecewise:
        """The function without factors that its numbers share."""
        if isinstance(numerators[0][0], float):
            return cls(knots, numerators)
        whole = cast(tuple[tuple[int, ...], ...], numerators)
        factor = math.gcd(denominator, *chain.from_iterable(whole))
        if factor == 1:
            return cls(knots, numerators, denominator)
        return cls(knots, tuple([tuple([c // factor for c in piece]) for piece in whole]), denominator // factor)

    @property
    def pieces(self) -> tuple[Coefficients, ...]:
        """Coefficients for each interval: fractions, or floats."""
        if self.is_float:
            return self.numerators
        return tuple(tuple(Fraction(int(c), self.denominator) for c in piece) for piece in self.numerators)

    @cached_property
    def is_float(self) -> bool:
        """Whether its coefficients are floats."""
        return isinstance(self.numerators[0][0], float)

    @property
    def is_zero(self) -> bool:
        """Whether it vanishes identically."""
        return not any(map(any, self.numerators))

    @property
    def degree(self) -> int:
        """The largest degree of its pieces."""
        return max(map(len, self.numerators)) - 1

    def __add__(self, other: Piecewise) -> Piecewise:
        a, b = _aligned(self, other)
        common = math.lcm(a.denominator, b.denominator)
        x, y = (f.scaled_numerators(common // f.denominator) for f in (a, b))
        return self._reduced(a.knots, tuple(map(_sum, x, y)), common)

    def __mul__(self, other: Piecewise) -> Piecewise:
        a, b = _aligned(self, other)
        products = tuple(map(_product, a.numerators, b.numerators))
        return self._reduced(a.knots, products, a.denominator * b.denominator)

    def scaled_numerators(self, factor: Number) -> tuple[Coefficients, ...]:
        """The numerators times a factor."""
        return self.numerators if factor == 1 else tuple(tuple(factor * c for c in p) for p in self.numerators)

    def scaled(self, factor: Number) -> Piecewise:
        """Factor times the function."""
        if self.is_float or isinstance(factor, float):
            return Piecewise.of(self.knots, tuple(tuple(factor * c for c in piece) for piece in self.pieces))
        return self._reduced(
            self.knots, self.scaled_numerators(factor.numerator), self.denominator * factor.denominator
        )

    def derivative(self) -> Piecewise:
        """The derivative, piece by piece."""
        slopes = (tuple(k * c for k, c in enumerate(p))[1:] or (p[0] * 0,) for p in self.numerators)
        return self._reduced(self.knots, tuple(slopes), self.denominator)

    def antiderivative(self) -> Piecewise:
        """The continuous antiderivative that vanishes at 0."""
        start: Number = 0.0 if self.is_float else Fraction(0)
        pieces: list[Coefficients] = []
        for (a, b), piece in zip(pairwise(self.knots), self.pieces, strict=True):
            raised = (start, *(_divided(c, k + 1) for k, c in enumerate(piece)))
            pieces.append(raised)
            start = _value(raised, b - a)
        return Piecewise.of(self.knots, pieces)

    def integral(self) -> Number:
        """The integral from 0 to 1."""
        if self.is_float:
            total: Number = Fraction(0)
            for (a, b), piece in zip(pairwise(self.knots), self.numerators, strict=True):
                h = b - a
                total += h * _value(tuple(_divided(c, k + 1) for k, c in enumerate(piece)), h)
            return total
        # Over one denominator as well: of the coefficients, of 1/(k + 1), of the powers of the intervals.
        count = self.degree + 1
        span, widths = self.knots.whole_widths
        by_width: dict[int, list[tuple[int, ...]]] = {}
        for width, piece in zip(widths, cast(tuple[tuple[int, ...], ...], self.numerators), strict=True):
            by_width.setdefault(width, []).append(piece)
        shares, whole = math.lcm(*range(1, count + 1)), 0
        for width, pieces in by_width.items():
            sums = [sum(column) for column in zip_longest(*pieces, fillvalue=0)]
            value, scale = 0, span ** (count - len(sums))
            for k in reversed(range(len(sums))):
                value = value * width + sums[k] * (shares // (k + 1)) * scale
                scale *= span
            whole += value * width
        return Fraction(whole, self.denominator * shares * span**count)

    def __call__(self, xi: Number) -> Number:
        """The value at a station; at a knot, that of the interval to its left."""
        i = 0
        while i < len(self.numerators) - 1 and xi > self.knots[i + 1]:
            i += 1
        coefficients = self.numerators[i]
        if not self.is_float:
            coefficients = tuple(Fraction(int(c), self.denominator) for c in coefficients)
        return _value(coefficients, xi - self.knots[i])

    def rounded(self, stations: Sequence[float]) -> list[float]:
        """Values at stations, rounded once where coefficients and knots are rational, whatever cancels in between."""
        values = []
        for xi in stations:
            i = max(bisect_left(self.knots, xi) - 1, 0)
            values.append(self._rounded(self.numerators[i], Fraction(xi) - self.knots[i]))
        return values

    def _rounded(self, numerators: Coefficients, s: Number) -> float:
        """The value of a piece as the nearest double, in whole numbers over one denominator."""
        if not isinstance(s, Fraction) or self.is_float:
            return float(_value(tuple(c / self.denominator for c in numerators), float(s)))
        total, scale = 0, 1
        for c in reversed(numerators):
            # total/scale is what Horner's rule has so far, times the denominator.
            total = total * s.numerator + int(c) * scale * s.denominator
            scale *= s.denominator
        return total / (self.denominator * scale)

    @cached_property
    def _alignments(self) -> list[tuple[Knots, Piecewise]]:
        """What it is beside functions on other knots, found by identity: a factor of many products meets few."""
        return []

    def beside(self, other: Knots) -> Piecewise:
        """The same function on its own and some other knots."""
        for known, aligned in self._alignments:
            if known is other:
                return aligned
        knots = _merged(*sorted((self.knots, other)))
        aligned = next((f for _, f in self._alignments if f.knots is knots), None) or self.refined(knots)
        if len(self._alignments) < _KEPT:
            self._alignments.append((other, aligned))
        return aligned

    def refined(self, finer: Sequence[Number]) -> Piecewise:
        """The same function on finer knots, which contain its own."""
        owners, i, knots = [], 0, _as_knots(finer)
        for a in knots[:-1]:
            while i < len(self.numerators) - 1 and a >= self.knots[i + 1]:
                i += 1
            owners.append((i, Fraction(a) - Fraction(self.knots[i])))
        if self.is_float:
            return Piecewise.of(knots, [_shifted(self.numerators[i], float(shift)) for i, shift in owners])
        # In the variable q xi, q the denominator of all shifts, these are whole numbers.
        q, n = math.lcm(*(shift.denominator for _, shift in owners)), self.degree
        powers = [q**k for k in range(n + 1)]
        pieces = []
        for i, shift in owners:
            piece = tuple(c * powers[n - k] for k, c in enumerate(self.numerators[i]))
            moved = _shifted(piece, int(shift * q))
            pieces.append(tuple(c * powers[k] for k, c in enumerate(moved)))
        return self._reduced(knots, tuple(pieces), self.denominator * powers[n])


def polynomial(*coefficients: Number | int) -> Piecewise:
    """One polynomial on [0, 1], constant first."""
    return Piecewise.of((Fraction(0), Fraction(1)), (coefficients,))


ONE = polynomial(1)
XI = polynomial(0, 1)


def fitted(function: Callable[[Extended], Extended], pieces: int) -> Piecewise:
    """A smooth function by interpolation at Chebyshev points on equal intervals, in extended precision.

    Returns:
        The interpolant with coefficients rounded to doubles; what is below the interpolation's own rounding is zero,
        so that a polynomial comes back as one of the same degree.
    """
    points, weights = _interpolation()
    interpolants = []
    for k in range(pieces):
        values = [function((k + t) / pieces) for t in points]
        coefficients = [extended_context().fdot(row, values) for row in weights]
        negligible = _NEGLIGIBLE * max(map(abs, coefficients))
        kept = [c * pieces**n if abs(c) > negligible else 0 for n, c in enumerate(coefficients)]
        while len(kept) > 1 and not kept[-1]:
            kept.pop()
        interpolants.append(tuple(map(float, kept)))
    return Piecewise.of([*(k / pieces for k in range(pieces)), 1.0], interpolants)


@cache
def _interpolation() -> tuple[list[Extended], list[list[Extended]]]:
    """Chebyshev points on [0, 1], and the matrix from values there to coefficients of 1, t, t^2, ..."""
    n = _FIT_DEGREE + 1
    angles = [extended_context().pi * (2 * j + 1) / (2 * n) for j in range(n)]
    cosines = [[extended_context().cos(m * angle) for angle in angles] for m in range(n)]
    # Rows of coefficients of the shifted Chebyshev polynomials T_m(2 t - 1), by T_(m+1) = 2 (2 t - 1) T_m - T_(m-1).
    chebyshev = [[1], [-1, 2]]
    for _ in range(2, n):
        last, before = chebyshev[-1], chebyshev[-2]
        raised = [0, *(4 * c for c in last)]
        chebyshev.append([r - 2 * c - b for r, c, b in zip_longest(raised, last, before, fillvalue=0)])
    weights = [
        [sum(chebyshev[m][k] * cosines[m][j] * (2 if m else 1) for m in range(k, n)) / n for j in range(n)]
        for k in range(n)
    ]
    return [(1 + cosine) / 2 for cosine in cosines[1]], weights


def _aligned(a: Piecewise, b: Piecewise) -> tuple[Piecewise, Piecewise]:
    """Two functions on the same knots, both exact or both of floats."""
    if a.is_float != b.is_float:
        a, b = (Piecewise.of(f.knots, [[float(c) for c in piece] for piece in f.pieces]) for f in (a, b))
    if a.knots.equal(b.knots):
        return a, b
    return a.beside(b.knots), b.beside(a.knots)


@lru_cache(maxsize=256)
def _merged(first: Knots, second: Knots) -> Knots:
    """The knots of both, as one object for equal ones."""
    return _as_knots(sorted({*first, *second}))


def _sum(a: Coefficients, b: Coefficients) -> Coefficients:
    short, long = sorted((a, b), key=len)
    return tuple(x + y for x, y in zip(short, long, strict=False)) + long[len(short) :]


def _product(a: Coefficients, b: Coefficients) -> Coefficients:
    zero = a[0] * b[0] * 0
    if not any(a) or not any(b):
        return (zero,)
    total = [zero] * (len(a) + len(b) - 1)
    for i, x in enumerate(a):
        if x:
            for j, y in enumerate(b):
                total[i + j] += x * y
    return tuple(total)


def _value(coefficients: Coefficients, s: Number) -> Number:
    total: Number = Fraction(0)
    for c in reversed(coefficients):
        total = total * s + c
    return total


def _divided(c: Number, k: int) -> Number:
    return Fraction(c.numerator, c.denominator * k) if isinstance(c, Fraction) else c / k


def _shifted(coefficients: Coefficients, s: Number) -> Coefficients:
    """The same polynomial in the distance from a point further on (Taylor's formula by repeated synthetic division)."""
    if not s:
        return coefficients
    c = list(coefficients)
    for i in range(len(c) - 1):
        for j in range(len(c) - 2, i - 1, -1):
            c[j] = c[j] + s * c[j + 1]
    return tuple(c)
