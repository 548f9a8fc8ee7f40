"""Couplings by formula as polynomials of one coordinate in another."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

import symofros as sf
from symofros.exports.interchange.couplings import PolynomialCoupling, polynomial_coupling
from symofros.mechanics.topology.numbers import Numbers

COEFFICIENTS = st.lists(st.floats(-10.0, 10.0).map(lambda x: round(x, 3) + 0.0), min_size=1, max_size=5)
NAMES = {"a", "b", "c"}


def polynomial(residual: str) -> PolynomialCoupling | None:
    numbers = Numbers(sf.System("machine", (), parameters=(sf.Parameter("k", 2.0),)))
    return polynomial_coupling(sf.Coupling("gear", residual), numbers, NAMES)


@given(COEFFICIENTS, st.floats(0.1, 10.0), st.sampled_from(["sum", "horner", "negative", "quotient"]))
def test_equivalent_polynomials_give_the_same_coefficients(c: list[float], slope: float, form: str) -> None:
    powers = " + ".join(f"({x!r})*b^{i}" for i, x in enumerate(c))
    horner = "0"
    for x in reversed(c):
        horner = f"({horner})*b + ({x!r})"
    residual = {
        "sum": f"{slope!r}*(a - ({powers}))",
        "horner": f"a - ({horner})",
        "negative": f"-(-a + ({powers}))",
        "quotient": f"(a - ({powers}))/k",
    }[form]
    coupling = polynomial(residual)
    assert coupling is not None
    assert coupling.follower == "a"
    assert coupling.leader == ("b" if any(c[1:]) else None)
    padded = [*coupling.coefficients, *[0.0] * 5][:5]
    assert padded == pytest.approx([*c, *[0.0] * 5][:5], rel=1e-14, abs=1e-300)


@pytest.mark.parametrize(
    ("residual", "follower", "leader", "coefficients"),
    [
        ("b - 3*a", "b", "a", (0.0, 3.0)),
        ("3*a - b", "a", "b", (0.0, 1.0 / 3.0)),
        ("a^2 - b", "b", "a", (0.0, 0.0, 1.0)),
        ("b^2 - k*a", "a", "b", (0.0, 0.0, 0.5)),
        ("a - k", "a", None, (2.0,)),
        ("(a - b)^2 - a^2 - b^2 + 2*a*b + a - pi", "a", None, (math.pi,)),
    ],
)
def test_the_eligible_coordinate_becomes_the_follower(
    residual: str, follower: str, leader: str | None, coefficients: tuple[float, ...]
) -> None:
    coupling = polynomial(residual)
    assert coupling is not None
    assert (coupling.follower, coupling.leader) == (follower, leader)
    assert coupling.coefficients == pytest.approx(coefficients, rel=1e-15)


@pytest.mark.parametrize(
    "residual",
    [
        "a*b - 1",
        "a^2 - b^2",
        "a - b^5",
        "a - b^k*b^k*b",
        "a - sin(b)",
        "a - 1/b",
        "a - b^0.5",
        "a - k^b",
        "a + b + c",
        "a - stranger",
        "a - a + b*a",
        "0*a - b^2",
    ],
)
def test_other_constraints_are_not_recognised_as_polynomials(residual: str) -> None:
    assert polynomial(residual) is None
