"""Fields and forms: polynomials in elastic coordinates, checked by their values."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.mechanics.beams.fields import Field, Form, no_form, unit_field
from symofros.mechanics.beams.piecewise import polynomial

L = 1.7
LENGTHS = (True, False, True)
Q = np.array([0.3, -0.2, 0.5])
RATES = np.array([1.1, 0.4, -0.7])
XI = Fraction(3, 8)
# Central differences with this step, of polynomials of size one.
STEP, DIFFERENCE = 1e-5, 1e-9

A = Field(1, LENGTHS, {(): polynomial(0, 1), (0,): polynomial(0, 0, 1), (1, 2): polynomial(1, -2)})
B = Field(0, LENGTHS, {(1,): polynomial(0, 1), (0, 0): polynomial(2), (0, 1): polynomial(0, 3, 1)})


def at(field: Field, q: np.ndarray = Q, x: float = float(XI) * L) -> float:
    """The value of a field, by its definition."""
    terms = ((mono, float(f(x / L))) for mono, f in field.terms.items())
    return sum(value * L ** field.exponent(mono) * float(np.prod(q[list(mono)])) for mono, value in terms)


def form(field: Field, q: np.ndarray = Q) -> tuple[Graph, Form]:
    """The field at one station, with numbers for its coordinates."""
    g = Graph()
    return g, field.at(g, [g.constant(x) for x in q], g.constant(L), float(XI))


def number(g: Graph, edge: Edge) -> float:
    found = g.number(edge)
    assert found is not None
    return found


def test_sums_and_products_of_fields_match_their_values() -> None:
    assert at(A + A.scaled(3)) == pytest.approx(4 * at(A))
    assert at(A - A) == 0.0
    assert at(A.times(B)) == pytest.approx(at(A) * at(B))
    assert A.times(B).power == A.power + B.power


@pytest.mark.parametrize("i", range(3))
def test_fields_are_differentiated_by_coordinates(i: int) -> None:
    for field in (A, B, A.times(B), B.times(B)):
        step = STEP * np.eye(3)[i]
        assert at(field.by(i)) == pytest.approx(
            (at(field, Q + step) - at(field, Q - step)) / (2 * STEP), abs=DIFFERENCE
        )
        assert field.by(i).power == field.power - LENGTHS[i]


def test_fields_are_differentiated_and_integrated_over_x() -> None:
    x = float(XI) * L
    for field in (A, B):
        slope = (at(field, x=x + STEP) - at(field, x=x - STEP)) / (2 * STEP)
        assert at(field.along()) == pytest.approx(slope, abs=DIFFERENCE)
        assert at(field.from_root().along()) == pytest.approx(at(field))
        assert at(field.from_root(), x=0.0) == 0.0


@pytest.mark.parametrize("degree", range(5))
def test_values_are_truncated_at_a_degree(degree: int) -> None:
    field = A.times(B)
    g, found = form(field)
    kept = Field(field.power, LENGTHS, {mono: f for mono, f in field.terms.items() if len(mono) <= degree})
    assert number(g, found.value(degree)) == pytest.approx(at(kept), rel=1e-14)
    assert number(g, found.upto(degree).value()) == pytest.approx(at(kept), rel=1e-14)


def test_rates_are_derivatives_along_the_motion() -> None:
    field = A.times(B)
    g, found = form(field)
    speeds = [g.constant(x) for x in RATES]
    values = [at(field, Q + step * RATES) for step in (-STEP, STEP)]
    assert number(g, found.rate(speeds)) == pytest.approx((values[1] - values[0]) / (2 * STEP), abs=DIFFERENCE)
    coarse = 1e-3  # Second differences divide rounding by the step squared.
    values = [at(field, Q + step * RATES) for step in (-coarse, 0.0, coarse)]
    curvature = (values[0] - 2 * values[1] + values[2]) / coarse**2
    assert number(g, found.second_rate(speeds)) == pytest.approx(curvature, rel=1e-5)


def test_forms_are_added_subtracted_and_scaled() -> None:
    g = Graph()
    coordinates = [g.constant(x) for x in Q]
    one, other = (field.at(g, coordinates, g.constant(L), float(XI)) for field in (A, A.times(unit_field(LENGTHS))))
    assert number(g, (one + other).value()) == pytest.approx(2 * at(A))
    assert number(g, (one - other).value()) == pytest.approx(0.0)
    assert number(g, (no_form(g, coordinates) + one).scaled(g.constant(2.0)).value()) == pytest.approx(2 * at(A))
    assert number(g, one.without_constant().value()) == pytest.approx(at(A) - float(XI) * L)
