"""Families of shape functions: conditions at the root, meaning at the tip, orthogonality, what they are good for."""

from __future__ import annotations

from fractions import Fraction

import mpmath
import numpy as np
import pytest
import scipy.linalg
import sympy

import symofros as sf
from symofros.description.beams.elastic import Direction
from symofros.mechanics.beams.piecewise import Piecewise
from symofros.mechanics.beams.shape_functions import MAX_MODES, FamilyError, cantilever_root, shapes
from validation.mechanics.shape_functions import clamped_free, legendre, monomials, splines

FAMILIES = {"spline": 6, "polynomial": 5, "legendre": 6, "clamped_free": 5, "hermite": 2}
RATIONAL = ("spline", "polynomial", "legendre", "hermite")


def derivative(f: Piecewise, times: int) -> Piecewise:
    for _ in range(times):
        f = f.derivative()
    return f


def made(family: str, count: int, direction: Direction = "bend_y") -> list[Piecewise]:
    return [shape.phi for shape in shapes(family, direction, count)]


def gram(functions: list[Piecewise]) -> np.ndarray:
    return np.array([[float((a * b).integral()) for b in functions] for a in functions])


def frequencies(family: str, count: int, direction: Direction = "bend_y") -> np.ndarray:
    """Ritz frequencies of the uniform cantilever, or shaft, in a basis."""
    functions = made(family, count, direction)
    curved = [derivative(f, 1 if direction == "twist" else 2) for f in functions]
    return np.sqrt(scipy.linalg.eigh(gram(curved), gram(functions), eigvals_only=True))


@pytest.mark.parametrize("family", RATIONAL)
def test_coefficients_are_exact(family: str) -> None:
    for direction, count in (("bend_y", FAMILIES[family]), ("twist", 1)):
        for phi in made(family, count, direction):  # type: ignore[arg-type]
            assert all(isinstance(c, Fraction) for piece in phi.pieces for c in piece)
            assert isinstance((phi * phi).integral(), Fraction)


def test_hermite_coordinates_are_tip_displacement_and_slope() -> None:
    first, second = shapes("hermite", "bend_y", 2)
    assert (first.phi(1), first.phi.derivative()(1), first.length) == (1, 0, True)
    assert (second.phi(1), second.phi.derivative()(1), second.length) == (0, 1, False)
    (angle,) = shapes("hermite", "twist", 1)
    assert (angle.phi(1), angle.length) == (1, False)


@pytest.mark.parametrize("direction", ["bend_y", "twist"])
def test_legendre_functions_are_orthogonal_exactly(direction: Direction) -> None:
    functions = made("legendre", 7, direction)
    for i, a in enumerate(functions):
        for b in functions[:i]:
            assert (a * b).integral() == 0
        # The norm of xi^m P_k^(0, 2m)(2 xi - 1) over [0, 1] (Abramowitz & Stegun 22.2.1).
        assert (a * a).integral() == Fraction(1, 2 * i + 1 + (4 if direction == "bend_y" else 2))


@pytest.mark.parametrize("direction", ["bend_y", "twist"])
def test_eigenmodes_are_orthonormal_and_free_at_the_tip(direction: Direction) -> None:
    functions = made("clamped_free", 13, direction)
    np.testing.assert_allclose(gram(functions), np.eye(13), atol=1e-12)
    for k, phi in enumerate(functions):
        orders = (2, 3) if direction == "bend_y" else (1,)
        wave = float(cantilever_root(k)) if direction == "bend_y" else (k + 0.5) * np.pi
        for order in orders:
            assert abs(float(derivative(phi, order)(1)) / wave**order) < 1e-10
        if direction == "bend_y":
            assert float(phi(1)) == pytest.approx(2.0 * (-1) ** k, rel=1e-12)


def test_high_eigenmodes_keep_their_digits() -> None:
    """The textbook form cosh - sigma sinh has none left by mode 13."""
    phi = made("clamped_free", 20)[-1]
    assert float(phi(1)) == pytest.approx(-2.0, rel=1e-11)
    assert float((phi * phi).integral()) == pytest.approx(1.0, rel=1e-13)


@pytest.mark.parametrize(
    ("family", "expected"),
    [
        ("spline", splines(2, 5, 1.0)),
        ("polynomial", monomials(2, 5, 1.0)),
        ("legendre", legendre(2, 5, 1.0)),
        ("clamped_free", clamped_free(3, 1.0)),
    ],
)
def test_shape_functions_match_scipy_and_textbooks(family: str, expected: tuple[object, ...]) -> None:
    xi = np.linspace(0, 1, 41)
    for phi, known in zip(made(family, len(expected)), expected, strict=True):
        for order, tolerance in ((0, 1e-10), (1, 1e-9), (2, 1e-8)):
            f = derivative(phi, order)
            # Both sides of a spline's knots give one value: cubic splines have continuous curvature.
            np.testing.assert_allclose([float(f(x)) for x in xi], known[order](xi), atol=tolerance)  # type: ignore[index]


@pytest.mark.parametrize(
    ("family", "count", "error"), [("clamped_free", 3, 1e-12), ("legendre", 8, 1e-5), ("spline", 8, 2e-4)]
)
def test_shaft_frequencies_match_theory(family: str, count: int, error: float) -> None:
    found = frequencies(family, count, "twist")[:3] / ((np.arange(3) + 0.5) * np.pi) - 1.0
    assert np.all(found < error) and np.all(found > -1e-12), found


@pytest.mark.parametrize("text", ["1 - cos(pi*xi/2)", "xi^2*exp(-xi)", "cosh(3*xi) - 1", "xi^2/(1 + xi)"])
def test_mass_and_stiffness_of_a_formula_keep_their_digits(text: str) -> None:
    """Integrals of phi^2 and phi''^2 against quadrature of the formula's own derivatives in thirty digits."""
    ((phi, _),) = shapes("user", "bend_y", 1, (sf.formula(text),))
    xi = sympy.Symbol("xi")
    formula = sympy.sympify(text.replace("^", "**").replace("pi", f"({Fraction(np.pi)})"))
    for order in (0, 2):
        square = sympy.lambdify(xi, sympy.diff(formula, xi, order) ** 2, "mpmath")
        with mpmath.workdps(30):
            expected = float(mpmath.quad(square, [0, 1]))
        f = derivative(phi, order)
        assert float((f * f).integral()) == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize(
    ("family", "direction", "count", "user", "says"),
    [
        ("spline", "bend_y", MAX_MODES + 1, (), f"0 to {MAX_MODES}"),
        ("hermite", "bend_y", 1, (), "tip displacement and slope: 2 functions"),
        ("hermite", "twist", 2, (), "the tip angle: 1 function"),
        ("user", "bend_y", 2, (sf.formula("xi^2"),), "2 functions asked for, 1 given"),
        ("user", "bend_y", 1, (sf.formula("xi"),), r"phi\(0\) = phi'\(0\) = 0"),
        ("user", "twist", 1, (sf.formula("1 + xi"),), r"1 at the root; phi\(0\) = 0"),
        ("user", "bend_y", 1, (sf.formula("xi^2*log(xi - 2)"),), "not a number at xi"),
    ],
)
def test_invalid_shape_function_requests_are_refused(
    family: str, direction: Direction, count: int, user: tuple[sf.Expression, ...], says: str
) -> None:
    with pytest.raises(FamilyError, match=says):
        shapes(family, direction, count, user)
