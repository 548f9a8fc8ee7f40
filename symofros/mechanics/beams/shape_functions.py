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

import math
from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from symofros.description.beam import Direction, UserShape
from symofros.expr.expression import Expression, evaluate
from symofros.mechanics.beams.piecewise import XI, Number, Piecewise, fitted, polynomial

MAX_MODES = 40


class Shape(NamedTuple):
    """One shape function.

    Attributes:
        phi: Its values over xi.
        length: Whether its coordinate is a displacement [m], rather than an angle.
    """

    phi: Piecewise
    length: bool


class FamilyError(ValueError):
    """A family has no such functions; the message says why."""


@lru_cache(maxsize=256)
def shapes(family: str, direction: Direction, count: int, user: tuple[UserShape, ...] = ()) -> tuple[Shape, ...]:
    """The first functions of a family.

    Args:
        family: Its name.
        direction: "bend_y", "bend_z" or "twist".
        count: How many.
        user: The user's own, for family "user".

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
    found: list[Piecewise] = []
    before, now = polynomial(0), polynomial(1)
    for k in range(count):
        found.append(now * _monomials(bending, 1)[0])
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
    return found


def _hermite(bending: bool, count: int) -> tuple[Shape, ...]:
    cubic = (Shape(polynomial(0, 0, 3, -2), True), Shape(polynomial(0, 0, -1, 1), False))
    available = cubic if bending else (Shape(XI, False),)
    if count not in (0, len(available)):
        meaning = "tip displacement and slope: 2 functions" if bending else "the tip angle: 1 function"
        raise FamilyError(f"{count} functions asked for; hermite has {meaning}, all or none")
    return available[:count]


def _splines(bending: bool, count: int) -> list[Piecewise]:
    """Clamped cubic B-splines on uniform knots, without those that move or turn the root."""
    dropped = 2 if bending else 1
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
    return Piecewise(tuple(Fraction(k, spans) for k in range(spans + 1)), tuple(pieces))


def _eigenmodes(bending: bool, count: int) -> list[Piecewise]:
    if not bending:
        return [_integrated(_shaft_slope((k + 0.5) * math.pi), 1, 2 + k) for k in range(count)]
    return [_integrated(_cantilever_curvature(k), 2, 3 + k) for k in range(count)]


def _shaft_slope(b: float) -> Callable[[np.ndarray], np.ndarray]:
    return lambda xi: math.sqrt(2.0) * b * np.cos(b * xi)


def cantilever_root(k: int) -> float:
    """Root number k (from 0) of cos(b) cosh(b) = -1, by Newton's method on cos(b) + 1/cosh(b)."""
    b = (k + 0.5) * math.pi if k else 1.8751
    for _ in range(50):
        step = (math.cos(b) + 1.0 / math.cosh(b)) / (-math.sin(b) - math.tanh(b) / math.cosh(b))
        b -= step
        if abs(step) < 1e-15 * b:
            break
    return b


def _cantilever_curvature(k: int) -> Callable[[np.ndarray], np.ndarray]:
    """The second derivative of cantilever mode k with mean square 1, in a form without differences of large numbers."""
    b = cantilever_root(k)
    # sigma = (sinh b - sin b)/(cosh b + cos b); 1 - sigma is exponentially small and written without cancellation.
    e = math.exp(-b)
    sigma = (1.0 - e * e - 2.0 * e * math.sin(b)) / (1.0 + e * e + 2.0 * e * math.cos(b))
    rest = 2.0 * (e * math.cos(b) + e * e + e * math.sin(b)) / (1.0 + e * e + 2.0 * e * math.cos(b))

    def curvature(xi: np.ndarray) -> np.ndarray:
        # cosh - sigma sinh = e^(-b xi) + (1 - sigma) sinh(b xi), and the second term as a difference of exponentials.
        growing = rest / 2.0 * (np.exp(b * xi) - np.exp(-b * xi))
        return b * b * (np.exp(-b * xi) + growing + np.cos(b * xi) - sigma * np.sin(b * xi))

    return curvature


def _integrated(derivative: Callable[[np.ndarray], np.ndarray], times: int, pieces: int) -> Piecewise:
    """A function that vanishes at 0 with its first derivatives, from its derivative of that order."""
    found = fitted(derivative, pieces)
    for _ in range(times):
        found = found.antiderivative()
    return found


def _user(shape: UserShape, bending: bool) -> Piecewise:
    order = 2 if bending else 1
    if isinstance(shape, Expression | float):
        phi = fitted(_formula(shape), 16)
    else:
        phi = _through(shape.xi, shape.values, bending)
    slope = phi.derivative()
    scale = max(abs(float(phi(k / 16))) for k in range(17)) or 1.0
    root = [phi(Fraction(0)), slope(Fraction(0))][:order]
    if any(abs(float(x)) > 1e-8 * scale for x in root):
        rule = "phi(0) = phi'(0) = 0" if bending else "phi(0) = 0"
        raise FamilyError(f"a function has {', '.join(f'{float(x):.3g}' for x in root)} at the root; {rule}")
    return phi + _root_correction(phi.knots, [float(x) for x in root])


def _root_correction(knots: tuple[Number, ...], root: list[float]) -> Piecewise:
    """What takes a value and a slope (zero where none is given) out at the root, within the first interval alone.

    The slope there is rounding of the interpolant's derivative, a thousand times its values': taken out as a straight
    line it would spoil those.
    """
    h = float(knots[1] - knots[0])
    value, slope = -root[0], -(root[1] if len(root) > 1 else 0.0)
    if len(root) > 1:
        cubic = (value, slope, -3 * value / h**2 - 2 * slope / h, 2 * value / h**3 + slope / h**2)
    else:
        cubic = (value, -value / h, 0.0, 0.0)
    return Piecewise(knots, (cubic, *((0.0,) for _ in knots[2:])))


def _formula(formula: Expression | float) -> Callable[[np.ndarray], np.ndarray]:
    def value(xi: np.ndarray) -> np.ndarray:
        found = []
        for x in xi.tolist():
            try:
                found.append(evaluate(formula, {"xi": x}))
            except KeyError as error:
                raise FamilyError(f"the formula '{formula}' uses {error}; it may use xi only") from None
            except ArithmeticError:
                raise FamilyError(f"the formula '{formula}' is not a number at xi = {x:.3g}") from None
        return np.array(found)

    return value


def _through(xi: Sequence[float], values: Sequence[float], bending: bool) -> Piecewise:
    """The cubic spline through sampled values: no slope at the root if clamped, no curvature at the free end."""
    x, y = np.array(xi), np.array(values)
    n, h = len(x), np.diff(x)
    A, b = np.zeros((n, n)), np.zeros(n)  # For the second derivatives at the samples.
    for i in range(1, n - 1):
        A[i, i - 1 : i + 2] = h[i - 1], 2 * (h[i - 1] + h[i]), h[i]
        b[i] = 6 * ((y[i + 1] - y[i]) / h[i] - (y[i] - y[i - 1]) / h[i - 1])
    A[n - 1, n - 1] = A[0, 0] = 1.0
    if bending:
        A[0, :2] = 2 * h[0], h[0]
        b[0] = 6 * (y[1] - y[0]) / h[0]
    curvature = np.linalg.solve(A, b)
    pieces: list[tuple[Number, ...]] = []
    for i in range(n - 1):
        slope = (y[i + 1] - y[i]) / h[i] - h[i] * (2 * curvature[i] + curvature[i + 1]) / 6
        cubic = (curvature[i + 1] - curvature[i]) / (6 * h[i])
        pieces.append((float(y[i]), float(slope), float(curvature[i]) / 2, float(cubic)))
    return Piecewise(tuple(x.tolist()), tuple(pieces))
