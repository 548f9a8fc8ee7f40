"""Piecewise polynomials: the algebra that modal integrals rest on, exact with fractions."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from symofros.expr.numerics.extended import extended_context
from symofros.mechanics.beams.piecewise import XI, Piecewise, fitted, polynomial

THIRDS = tuple(Fraction(k, 3) for k in range(4))
HALVES = tuple(Fraction(k, 2) for k in range(3))
STATIONS = [Fraction(k, 24) for k in range(25)]


def some(knots: tuple[Fraction, ...], seed: int, degree: int = 3) -> Piecewise:
    """Random fractions as coefficients."""
    rng = np.random.default_rng(seed)
    numbers = rng.integers(-9, 10, (len(knots) - 1, degree + 1)).tolist()
    return Piecewise.of(knots, tuple(tuple(Fraction(c, 7) for c in piece) for piece in numbers))


ONE, OTHER = some(THIRDS, 1), some(HALVES, 2)


@pytest.mark.parametrize("xi", STATIONS)
def test_algebra_of_piecewise_polynomials_is_exact(xi: Fraction) -> None:
    assert (ONE + OTHER)(xi) == ONE(xi) + OTHER(xi)
    assert (ONE * OTHER)(xi) == ONE(xi) * OTHER(xi)
    assert ONE.scaled(Fraction(2, 3))(xi) == Fraction(2, 3) * ONE(xi)
    assert ONE.refined(tuple(Fraction(k, 6) for k in range(7)))(xi) == ONE(xi)
    assert ONE.antiderivative().derivative()(xi) == ONE(xi)


def test_exact_functions_stay_exact_on_knots_that_are_floats() -> None:
    """Knots of fitted functions equal those of splines as numbers, and must not change what a spline is."""
    floats = tuple(float(k) for k in HALVES)
    refined = XI.refined(floats)
    assert not refined.is_float and refined(Fraction(3, 4)) == Fraction(3, 4)
    assert (refined * OTHER).integral() == (XI * OTHER).integral()
    fitted_one = fitted(lambda x: x, 2)
    assert float((fitted_one * OTHER).integral()) == pytest.approx(float((XI * OTHER).integral()), rel=1e-15)


def test_cancelled_sums_are_recognised_as_zero() -> None:
    assert (ONE + ONE.scaled(-1)).is_zero
    assert (ONE * polynomial(0)).is_zero
    assert polynomial(3).derivative().is_zero
    assert not ONE.is_zero
    assert polynomial(1, 0, 2).degree == 2


@pytest.mark.parametrize("pieces", [1, 3])
def test_a_smooth_function_is_interpolated_to_rounding(pieces: int) -> None:
    f = fitted(lambda x: extended_context().exp(x) * extended_context().cos(3 * x), pieces)
    xi = np.linspace(0, 1, 97)
    expected = np.exp(xi) * np.cos(3 * xi)
    # Three terms of the Taylor series of exp(x) cos(3 x) are left out of degree 14 where one piece spans the beam.
    np.testing.assert_allclose([float(f(x)) for x in xi], expected, atol=1e-13)


def test_the_second_derivative_of_an_interpolant_keeps_its_digits() -> None:
    """It is what stiffness is made of: in doubles, interpolation would leave ten digits of it."""
    curvature = fitted(lambda x: extended_context().exp(-x) * x**2, 16).derivative().derivative()
    xi = np.linspace(0, 1, 97)
    np.testing.assert_allclose([float(curvature(x)) for x in xi], (2 - 4 * xi + xi**2) * np.exp(-xi), atol=5e-15)


def test_values_are_rounded_once_whatever_cancels() -> None:
    """A Chebyshev polynomial of degree 40, 1 at most, with coefficients up to 1e15; knots of their own are kept."""
    chebyshev = np.polynomial.chebyshev.Chebyshev.basis(40, domain=[0, 1])
    one, two = polynomial(1), polynomial(-1, 2)
    for _ in range(39):
        one, two = two, polynomial(-2, 4) * two + one.scaled(-1)
    xi = [0.0, 0.1, 0.35, 0.5, 0.77, 1.0]
    np.testing.assert_allclose(two.rounded(xi), chebyshev(np.array(xi)), atol=1e-13)
    assert two.rounded(xi) == [float(two(Fraction(x))) for x in xi]
    assert max(abs(float(two(x)) - y) for x, y in zip(xi, two.rounded(xi), strict=True)) > 1.0
    refined = two.refined((Fraction(0), Fraction(1, 3), Fraction(1, 2), Fraction(1)))
    assert refined.rounded(xi) == two.rounded(xi)
