"""Families of shape functions of a clamped beam, over xi = x/L (docs/theory/beams.md, section 2).

Bending functions satisfy phi(0) = phi'(0) = 0, twist functions phi(0) = 0. What each family's coordinates mean:

| family | functions | coordinate |
|---|---|---|
| spline | cubic B-splines, uniform knots | coefficient [m, rad]; only the last moves the tip |
| polynomial | xi^2, xi^3, ... (twist: xi, xi^2, ...) | share of the tip's displacement [m] or angle [rad] |
| legendre | xi^2 (twist: xi) times Jacobi polynomials, orthogonal over the beam, 1 at the tip | likewise |
| clamped_free | modes of the uniform cantilever (twist: of the shaft), mean square 1 | modal amplitude [m, rad] |
| hermite | cubics of tip displacement and slope (twist: linear) | tip displacement [m], slope [rad]; angle [rad] |
| user | formulas of xi, or sampled values | amplitude [m, rad] |
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cache, lru_cache
from itertools import pairwise
from typing import NamedTuple

from symofros.description.beams.elastic import Direction
from symofros.description.beams.shapes import UserShape
from symofros.expr.expression import Expression, evaluate_extended
from symofros.expr.numerics.extended import Extended, extended_context
from symofros.mechanics.beams.piecewise import XI, Number, Piecewise, fitted, polynomial

MAX_MODES = 40
# Intervals on which a formula is interpolated.
_FORMULA_PIECES = 16
# Value and slope at the root, as a share of the function's size, that count as rounding of the formula's numbers.
_ROOT_TOLERANCE = 1e-8
# Newton's method doubles the digits, from one for the lowest root to more than extended numbers have.
_NEWTON_STEPS = 9

ExtendedFunction = Callable[[Extended], Extended]


class Shape(NamedTuple):
    """One shape function.

    Attributes:
        phi: The function of xi.
        length: Whether the coordinate is a displacement [m], rather than an angle [rad].
    """

    phi: Piecewise
    length: bool


class FamilyError(ValueError):
    """A family has no such functions; the message says why."""


@lru_cache(maxsize=256)
def shapes(family: str, direction: Direction, count: int, user: tuple[UserShape, ...] = ()) -> tuple[Shape, ...]:
    """The first functions of a family.

    Args:
        family: Name of the family.
        direction: "bend_y", "bend_z" or "twist".
        count: Number of functions.
        user: Functions stated by the user, for family "user".

    Raises:
        FamilyError: The family has none, or not as many.
    """
    if not 0 <= count <= MAX_MODES:
        raise FamilyError(f"{count} functions asked for; 0 to {MAX_MODES} can be had")
    bending = direction != "twist"
    if family == "user":
        if len(user) != count:
            raise FamilyError(f"{count} functions asked for, {len(user)} given")
        return tuple(Shape(_user(shape, bending), bending) for shape in user)
    if family == "hermite":
        return _hermite(bending, count)
    make: dict[str, Callable[[bool, int], list[Piecewise]]] = {
        "spline": _splines,
        "polynomial": _monomials,
        "legendre": _orthogonal,
        "clamped_free": _eigenmodes,
    }
    return tuple(Shape(phi, bending) for phi in make[family](bending, count))


def _monomials(bending: bool, count: int) -> list[Piecewise]:
    first = 2 if bending else 1
    return [polynomial(*([0] * (first + k)), 1) for k in range(count)]


def _orthogonal(bending: bool, count: int) -> list[Piecewise]:
    """xi^m P_k^(0, 2m)(2 xi - 1): orthogonal on [0, 1], rational, 1 at the tip, by the three-term recurrence."""
    m = 2 if bending else 1
    b = Fraction(2 * m)
    x = polynomial(-1, 2)
    functions: list[Piecewise] = []
    before, now = polynomial(0), polynomial(1)
    for k in range(count):
        functions.append(now * _monomials(bending, 1)[0])
        # Jacobi's recurrence with alpha = 0 (Abramowitz & Stegun 22.7.1), normalised to 1 at the tip by alpha = 0.
        n = Fraction(k)
        if k == 0:
            following = polynomial(-b / 2, 0) + x.scaled((b + 2) / 2)
        else:
            s = 2 * n + b
            lead = 2 * (n + 1) * (n + b + 1) * s
            following = x.scaled((s + 1) * (s + 2) * s) + polynomial(-(b * b) * (s + 1))
            following = (following * now + before.scaled(-2 * n * (n + b) * (s + 2))).scaled(1 / lead)
        before, now = now, following
    return functions


def _hermite(bending: bool, count: int) -> tuple[Shape, ...]:
    cubic = (Shape(polynomial(0, 0, 3, -2), True), Shape(polynomial(0, 0, -1, 1), False))
    available = cubic if bending else (Shape(XI, False),)
    if count not in (0, len(available)):
        meaning = "tip displacement and slope: 2 functions" if bending else "the tip angle: 1 function"
        raise FamilyError(f"{count} functions asked for; hermite has {meaning}, all or none")
    return available[:count]


def _splines(bending: bool, count: int) -> list[Piecewise]:
    """Clamped cubic B-splines on uniform knots, without those that move or turn the root."""
    return b_splines(2 if bending else 1, count)


def b_splines(dropped: int, count: int) -> list[Piecewise]:
    """B-splines on uniform knots without the first ones: cubic, or of a lower degree where they are few.

    Args:
        dropped: Number of the first ones that are left out.
        count: Number of the others.
    """
    degree = min(3, count + dropped - 1)
    spans = count + dropped - degree
    knots = [Fraction(0)] * degree + [Fraction(k, spans) for k in range(spans + 1)] + [Fraction(1)] * degree
    return [_b_spline(knots, degree, i, spans) for i in range(dropped, count + dropped)]


def _b_spline(knots: list[Fraction], degree: int, index: int, spans: int) -> Piecewise:
    """One B-spline by the recurrence of Cox and de Boor, on each span."""
    zero = polynomial(0)
    pieces = []
    for span in range(spans):
        left, right = Fraction(span, spans), Fraction(span + 1, spans)
        values = {
            i: polynomial(1) if knots[i] <= left and right <= knots[i + 1] else zero for i in range(len(knots) - 1)
        }
        for p in range(1, degree + 1):
            raised = {}
            for i in range(len(knots) - 1 - p):
                total = zero
                for low, high, sign, shifted in (
                    (knots[i], knots[i + p], 1, i),
                    (knots[i + 1], knots[i + p + 1], -1, i + 1),
                ):
                    if high > low:
                        start = low if sign > 0 else high
                        # In the span's own variable: (xi - low)/(high - low), or (high - xi)/(high - low).
                        ramp = polynomial(sign * (left - start) / (high - low), sign / (high - low))
                        total = total + ramp * values[shifted]
                raised[i] = total
            values = raised
        pieces.append(values[index].pieces[0])
    return Piecewise.of([Fraction(k, spans) for k in range(spans + 1)], pieces)


def _eigenmodes(bending: bool, count: int) -> list[Piecewise]:
    if bending:
        return [_integrated(_cantilever_curvature(k), 2, 3 + k) for k in range(count)]
    return [_integrated(_shaft_slope(k), 1, 2 + k) for k in range(count)]


def _shaft_slope(k: int) -> ExtendedFunction:
    """The derivative of shaft mode k (from 0), sqrt(2) sin(b xi) with b = (k + 1/2) pi."""
    context = extended_context()
    b = (k + context.mpf(0.5)) * context.pi
    amplitude = context.sqrt(2) * b
    return lambda xi: amplitude * context.cos(b * xi)


@cache
def cantilever_root(k: int) -> Extended:
    """Root number k (from 0) of cos(b) cosh(b) = -1, by Newton's method on cos(b) + 1/cosh(b)."""
    context = extended_context()
    cos, sin, sech, tanh = context.cos, context.sin, context.sech, context.tanh
    b = (k + context.mpf(0.5)) * context.pi
    for _ in range(_NEWTON_STEPS):
        b += (cos(b) + sech(b)) / (sin(b) + tanh(b) * sech(b))
    return b


def _cantilever_curvature(k: int) -> ExtendedFunction:
    """The second derivative of cantilever mode k with mean square 1, in a form without differences of large numbers."""
    b, context = cantilever_root(k), extended_context()
    c_b, s_b = context.cos_sin(b)
    # sigma = (sinh b - sin b)/(cosh b + cos b); 1 - sigma is exponentially small and written without cancellation.
    e = context.exp(-b)
    scale = 1 + e * e + 2 * e * c_b
    sigma = (1 - e * e - 2 * e * s_b) / scale
    half_rest = (e * c_b + e * e + e * s_b) / scale

    def curvature(xi: Extended) -> Extended:
        # cosh - sigma sinh = e^(-b xi) + (1 - sigma) sinh(b xi), and the second term as a difference of exponentials.
        decaying = context.exp(-b * xi)
        growing = half_rest * (1 / decaying - decaying)
        c, s = context.cos_sin(b * xi)
        return b * b * (decaying + growing + c - sigma * s)

    return curvature


def _integrated(derivative: ExtendedFunction, times: int, pieces: int) -> Piecewise:
    """A function that vanishes at 0 with its first derivatives, from its derivative of that order."""
    phi = fitted(derivative, pieces)
    for _ in range(times):
        phi = phi.antiderivative()
    return phi


def _user(shape: UserShape, bending: bool) -> Piecewise:
    if isinstance(shape, Expression | float):
        phi = fitted(formula_of_station(shape), _FORMULA_PIECES)
    else:
        phi = _through(shape.xi, shape.values, bending)
    slope = phi.derivative()
    scale = max(abs(float(phi(k / 16))) for k in range(17)) or 1.0
    root = [float(f(Fraction(0))) for f in (phi, slope)[: 2 if bending else 1]]
    if any(abs(x) > _ROOT_TOLERANCE * scale for x in root):
        rule = "phi(0) = phi'(0) = 0" if bending else "phi(0) = 0"
        raise FamilyError(f"a function has {', '.join(f'{x:.3g}' for x in root)} at the root; {rule}")
    return phi + _root_correction(phi.knots, root) if any(root) else phi


def _root_correction(knots: tuple[Number, ...], root: list[float]) -> Piecewise:
    """The cubic on the first interval that cancels a value and a slope (zero where none is given) at the root.

    It ends with value and slope zero, so that the rest of the beam keeps its values.
    """
    h = float(knots[1] - knots[0])
    value, slope = -root[0], -(root[1] if len(root) > 1 else 0.0)
    if len(root) > 1:
        cubic = (value, slope, -3 * value / h**2 - 2 * slope / h, 2 * value / h**3 + slope / h**2)
    else:
        cubic = (value, -value / h, 0.0, 0.0)  # A straight line: twist may have a kink.
    return Piecewise.of(knots, (cubic, *((0.0,) for _ in knots[2:])))


def formula_of_station(formula: Expression | float) -> ExtendedFunction:
    """A user's formula of xi as a function of extended numbers, which raises FamilyError where it has no value."""

    def value(xi: Extended) -> Extended:
        try:
            return evaluate_extended(formula, {"xi": xi})
        except KeyError as error:
            raise FamilyError(f"the formula '{formula}' uses {error}; it may use xi only") from None
        except ArithmeticError:
            raise FamilyError(f"the formula '{formula}' is not a number at xi = {float(xi):.3g}") from None

    return value


def _through(xi: Sequence[float], values: Sequence[float], bending: bool) -> Piecewise:
    """The cubic spline through sampled values, which is the cubic itself where a cubic was sampled.

    In bending it has no slope at the root. Elsewhere nothing is known of the ends: the two intervals there share one
    cubic (docs/theory/beams.md, section 2).
    """
    x, y = ([extended_context().mpf(number) for number in numbers] for numbers in (xi, values))
    h = [b - a for a, b in pairwise(x)]
    chords = [(b - a) / step for (a, b), step in zip(pairwise(y), h, strict=True)]
    curvatures = _spline_curvatures(h, chords, bending)
    pieces: list[tuple[Number, ...]] = []
    for value, chord, step, (left, right) in zip(y, chords, h, pairwise(curvatures), strict=False):
        slope = chord - step * (2 * left + right) / 6
        pieces.append(tuple(map(float, (value, slope, left / 2, (right - left) / (6 * step)))))
    return Piecewise.of(xi, pieces)


def _spline_curvatures(h: Sequence[Extended], chords: Sequence[Extended], clamped: bool) -> list[Extended]:
    """Second derivatives at the samples that make the spline's slope continuous.

    Args:
        h: Distances between samples (n - 1), three at least.
        chords: Slopes of the straight lines between them (n - 1).
        clamped: Whether the spline has no slope at its first sample; else its first two intervals share one cubic.
    """
    # Row i is lower c_(i-1) + diagonal c_i + upper c_(i+1) = right (equations (5a) and (5b) of the theory).
    rows = [[h[i - 1], 2 * (h[i - 1] + h[i]), h[i], 6 * (chords[i] - chords[i - 1])] for i in range(1, len(h))]
    # One cubic on two intervals: c_n = (1 + r) c_(n-1) - r c_(n-2), put into the last row; the same at the root.
    r = h[-1] / h[-2]
    rows[-1] = _without_end(rows[-1], 2, 0, r)
    if clamped:
        rows.insert(0, [extended_context().zero, 2 * h[0], h[0], 6 * chords[0]])
    else:
        rows[0] = _without_end(rows[0], 0, 2, h[0] / h[1])
    c = _tridiagonal(rows)
    if not clamped:
        c.insert(0, c[0] + (c[0] - c[1]) * h[0] / h[1])
    return [*c, c[-1] + (c[-1] - c[-2]) * r]


def _without_end(row: list[Extended], end: int, inner: int, r: Extended) -> list[Extended]:
    """A row without the unknown at its end, which is (1 + r) times the middle one less r times the inner one."""
    reduced = list(row)
    reduced[1] += (1 + r) * row[end]
    reduced[inner] -= r * row[end]
    reduced[end] = extended_context().zero
    return reduced


def _tridiagonal(rows: Sequence[Sequence[Extended]]) -> list[Extended]:
    """The unknowns of a tridiagonal system of rows (lower, diagonal, upper, right), diagonally dominant."""
    reduced: list[tuple[Extended, Extended]] = []  # (upper, right) of rows with a unit diagonal and nothing below.
    above = (extended_context().zero, extended_context().zero)
    for lower, diagonal, upper, right in rows:
        pivot = diagonal - lower * above[0]
        above = (upper / pivot, (right - lower * above[1]) / pivot)
        reduced.append(above)
    unknowns = [extended_context().zero]
    for upper, right in reversed(reduced):
        unknowns.append(right - upper * unknowns[-1])
    return unknowns[:0:-1]
