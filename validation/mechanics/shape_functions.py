"""Shape functions of beams written anew with NumPy and SciPy: value, slope, curvature over x [m].

Nothing is shared with `symofros.mechanics.beams`: families are stated by their textbook definitions (docs/theory/
beams.md, section 2), as polynomials, splines and modes over the whole length.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import scipy.interpolate
import scipy.optimize
import scipy.special

from .geometry import Array

# Arrays in, arrays out; polynomials and splines of NumPy and SciPy are not typed more narrowly.
Curve = Callable[[Any], Any]


class Shape(NamedTuple):
    """A function of x and its first two derivatives."""

    value: Curve
    slope: Curve
    curvature: Curve


def stretched(value: Curve, slope: Curve, curvature: Curve, L: float, factor: float = 1.0) -> Shape:
    """Factor times a function of xi = x/L."""
    return Shape(
        lambda x: factor * value(np.asarray(x) / L),
        lambda x: factor / L * slope(np.asarray(x) / L),
        lambda x: factor / L**2 * curvature(np.asarray(x) / L),
    )


def shape_of_polynomial(p: np.polynomial.Polynomial, L: float, factor: float = 1.0) -> Shape:
    """Factor times a polynomial of xi."""
    return stretched(p, p.deriv(), p.deriv(2), L, factor)


def monomials(first: int, count: int, L: float) -> tuple[Shape, ...]:
    """Powers of xi from `first` on."""
    return tuple(shape_of_polynomial(np.polynomial.Polynomial.basis(first + k), L) for k in range(count))


def legendre(first: int, count: int, L: float) -> tuple[Shape, ...]:
    """xi^first times Jacobi polynomials of weight xi^(2 first), 1 at the tip."""
    return tuple(_jacobi(first, k, L) for k in range(count))


def _jacobi(m: int, k: int, L: float) -> Shape:
    """Shape function xi^m P_k(2 xi - 1); P by recurrence: powers of xi cancel digits from eight functions on."""

    def P(x: Any, order: int) -> Any:
        """The derivative of that order: a product of (k + 2 m + i)/2 and a Jacobi polynomial of lower degree."""
        if order > k:
            return 0.0 * x
        factor = np.prod([(k + 2 * m + i) / 2 for i in range(1, order + 1)])
        return factor * scipy.special.eval_jacobi(k - order, order, 2 * m + order, 2 * x - 1)

    return stretched(
        lambda x: x**m * P(x, 0),
        lambda x: m * x ** (m - 1) * P(x, 0) + 2 * x**m * P(x, 1),
        lambda x: m * (m - 1) * x ** max(m - 2, 0) * P(x, 0) + 4 * m * x ** (m - 1) * P(x, 1) + 4 * x**m * P(x, 2),
        L,
    )


def hermite(L: float) -> tuple[Shape, ...]:
    """Tip displacement, tip slope."""
    one, other = np.polynomial.Polynomial([0, 0, 3, -2]), np.polynomial.Polynomial([0, 0, -1, 1])
    return shape_of_polynomial(one, L), shape_of_polynomial(other, L, L)


def splines(dropped: int, count: int, L: float) -> tuple[Shape, ...]:
    """Cubic B-splines on uniform knots without the first few; of lower degree where there are too few for cubics."""
    degree = min(3, count + dropped - 1)
    inner = np.linspace(0.0, 1.0, count + dropped - degree + 1)
    knots = np.concatenate([[0.0] * degree, inner, [1.0] * degree])
    functions = []
    for i in range(dropped, dropped + count):
        b = scipy.interpolate.BSpline(knots, np.eye(count + dropped)[i], degree)
        # A single function of twist is a straight line, which SciPy differentiates only once.
        curvature = b.derivative(2) if degree > 1 else np.zeros_like
        functions.append(stretched(b, b.derivative(), curvature, L))
    return tuple(functions)


def spline_breaks(dropped: int, count: int, L: float) -> tuple[float, ...]:
    """Interior knots [m], where the pieces of splines meet."""
    spans = count + dropped - min(3, count + dropped - 1)
    return tuple(L * k / spans for k in range(1, spans))


def cantilever_roots(count: int) -> Array:
    """The first `count` positive roots of cos b cosh b = -1: the bending eigenvalues of a cantilever."""
    guess = [(k + 0.5) * np.pi for k in range(count)]
    return np.array(
        [scipy.optimize.brentq(lambda b: np.cos(b) + 1.0 / np.cosh(b), g - 0.5, g + 0.5, xtol=1e-15) for g in guess]
    )


def clamped_free(count: int, L: float) -> tuple[Shape, ...]:
    """Modes of a cantilever, mean square 1."""
    return tuple(_cantilever_mode(b, L) for b in cantilever_roots(count))


def _cantilever_mode(b: float, L: float) -> Shape:
    """Cantilever mode cosh b xi - cos b xi - s (sinh b xi - sin b xi).

    cosh - s sinh is written exp(-b xi) + k sinh b xi with k = 1 - s, which is small: nothing cancels.
    """
    k = (np.exp(-b) + np.cos(b) + np.sin(b)) / (np.cosh(b) + np.cos(b))
    s = 1.0 - k
    return stretched(
        lambda x: np.exp(-b * x) + k * np.sinh(b * x) - np.cos(b * x) + s * np.sin(b * x),
        lambda x: b * (k * np.cosh(b * x) - np.exp(-b * x) + np.sin(b * x) + s * np.cos(b * x)),
        lambda x: b**2 * (np.exp(-b * x) + k * np.sinh(b * x) + np.cos(b * x) - s * np.sin(b * x)),
        L,
    )


def clamped_free_twist(count: int, L: float) -> tuple[Shape, ...]:
    """Modes of a shaft that is held at its root, mean square 1."""
    return tuple(_shaft_mode((k + 0.5) * np.pi, L) for k in range(count))


def _shaft_mode(a: float, L: float) -> Shape:
    return stretched(lambda x: np.sin(a * x), lambda x: a * np.cos(a * x), lambda x: -(a**2) * np.sin(a * x), L, 2**0.5)


def through(xi: Sequence[float], values: Sequence[float], L: float, bending: bool = True) -> Shape:
    """The cubic spline through samples: without slope at the root in bending, and not-a-knot at all other ends."""
    s = scipy.interpolate.CubicSpline(xi, values, bc_type=((1, 0.0) if bending else "not-a-knot", "not-a-knot"))
    return stretched(s, s.derivative(), s.derivative(2), L)


def of_family(family: str, count: int, L: float, bending: bool) -> tuple[tuple[Shape, ...], tuple[float, ...]]:
    """The functions of a family in one direction, and where Gauss' intervals must end.

    Args:
        family: Family of shape functions, any but "user".
        count: Number of functions.
        L: Length of the beam [m].
        bending: Whether for a displacement; else for twist.
    """
    first = 2 if bending else 1
    if family == "spline":
        return splines(first, count, L), spline_breaks(first, count, L)
    if family == "clamped_free":
        # Modes are smooth; a quarter wave an interval is what Gauss' nodes integrate to rounding.
        spans = 2 * count
        breaks = tuple(L * k / spans for k in range(1, spans))
        return (clamped_free if bending else clamped_free_twist)(count, L), breaks
    if family == "hermite":
        return (hermite(L) if bending else monomials(1, 1, L))[:count], ()
    return {"polynomial": monomials, "legendre": legendre}[family](first, count, L), ()


def strain_family(name: str, count: int) -> tuple[list[Curve], tuple[float, ...]]:
    """Strain functions of a rod over xi = x/L of any family but "user", and where they are not smooth."""
    if name == "legendre":
        return [np.polynomial.Legendre.basis(k, domain=[0, 1]) for k in range(count)], ()
    if name == "polynomial" or not count:
        return [np.polynomial.Polynomial.basis(k) for k in range(count)], ()
    degree = min(3, count - 1)
    spans = count - degree
    ends = np.linspace(0.0, 1.0, spans + 1)
    knots = np.concatenate([np.zeros(degree), ends, np.ones(degree)])
    return [scipy.interpolate.BSpline(knots, row, degree) for row in np.eye(count)], tuple(ends[1:-1].tolist())
