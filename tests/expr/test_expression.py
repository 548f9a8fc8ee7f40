from __future__ import annotations

import pytest
import sympy

import symofros as sf
from symofros.description.parser import parse
from symofros.expr.expression import evaluate, lower
from symofros.expr.freeze import freeze
from symofros.expr.graph import Graph

a, b, x = sympy.symbols("a b x")


@pytest.mark.parametrize(
    "expression",
    [
        a / 2,
        a - b,
        -a * b,
        a**2 + b**3,
        1 / a,
        sympy.sqrt(a),
        sympy.Rational(1, 3) * a,
        sympy.pi * a,
        sympy.sin(a) * sympy.cos(b) - sympy.tan(a * b),
        sympy.atan2(a, b),
        sympy.exp(-a) + sympy.log(b),
        sympy.Abs(a - b),
        sympy.Max(a, b, 1),
        sympy.Min(a, b),
        a ** sympy.Rational(3, 2),
        sympy.tanh(a),
        sympy.E * a,
    ],
    ids=str,
)
def test_frozen_sympy_expressions_evaluate_equally(expression: sympy.Expr) -> None:
    values = {"a": 0.7, "b": 1.3}
    expected = float(expression.subs(values).evalf())
    assert evaluate(freeze(expression), values) == pytest.approx(expected, rel=1e-14)
    # And it survives being written down and read again.
    assert evaluate(parse(str(freeze(expression))), values) == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize("expression", [sympy.I * a, sympy.Integral(a, a), sympy.gamma(a), sympy.oo])
def test_expressions_without_c_form_are_refused(expression: sympy.Expr) -> None:
    with pytest.raises(ValueError):
        freeze(expression)


def test_symbols_exclude_pi() -> None:
    assert parse("pi*r^2 + sin(q1)").symbols() == {"r", "q1"}


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("x + 1/(t - t)", "division by the constant zero"),
        ("x*sqrt(-1)", "sqrt(-1.0) is not a number"),
        ("x + log(0)", "log(0) is infinite"),
        ("exp(1000)", "exp(1000) is infinite"),
    ],
)
def test_constant_parts_without_a_value_are_refused_in_words(text: str, found: str) -> None:
    g = Graph()
    with pytest.raises(sf.SymofrosError) as refused:
        lower(parse(text), g, {"x": g.input("q", 0), "t": g.input("t", 0)})
    problem = refused.value.problem
    assert problem.what == f"formula '{text}' has no value" and problem.found == found
    assert problem.rule and problem.remedy
    assert lower(parse("1/exp(1000)"), g, {}) == 0


def test_evaluate_refuses_division_by_zero() -> None:
    with pytest.raises(ArithmeticError):
        sf.evaluate(parse("1/(a - a)"), {"a": 1.0})


def test_sympy_expressions_are_accepted_in_descriptions() -> None:
    inertia = sf.Inertia(mass=a, center_of_mass=(a / 2, 0, sympy.pi), moments=(1, 1, 1))
    assert str(inertia.mass) == "a"
    assert sf.evaluate(inertia.center_of_mass[0], {"a": 3.0}) == 1.5
