"""None"""

from __future__ import annotations

import numpy as np
import pytest

from symofros.description.parser import parse
from symofros.expr.derivative import adjoint, partials
from symofros.expr.expression import lower
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import evaluate_edges
from symofros.expr.ops import STOP_GRADIENT
from symofros.expr.program import Program

# Every row of the op table, at points inside its domain and away from kinks.
FORMULAS = [
    "x + y",
    "x*y",
    "x/y",
    "x^y",
    "x^3",
    "x^(-2)",
    "sqrt(x)",
    "exp(x*y)",
    "log(x + y)",
    "sin(x*y)",
    "cos(x - y)",
    "tan(x)",
    "asin(x/3)",
    "acos(y/4)",
    "atan(x*y)",
    "atan2(x, y)",
    "sinh(x)",
    "cosh(y)",
    "tanh(x - y)",
    "abs(x - y)*x",
    "sign(x - y)*y",
    "min(x, y)*x",
    "max(x, 2*y)*y",
    "-x*sin(-y)/(x + 3*y)^2",
]
STEP = 1e-6


@pytest.mark.parametrize("formula", FORMULAS)
def test_derivatives_equal_central_differences(formula: str) -> None:
    g = Graph()
    x, y = g.input("q", 0), g.input("q", 1)
    edge = lower(parse(formula), g, {"x": x, "y": y})
    (row,) = partials(g, [edge], [x, y])
    program = Program("p", g, {}, ())
    points = np.random.default_rng(0).uniform(0.5, 2.0, (20, 2))

    def value(e: int, at: np.ndarray) -> np.ndarray:
        return np.broadcast_to(evaluate_edges(program, [e], {"q": at}, {})[0], 20)

    for k in range(2):
        d = np.zeros(2)
        d[k] = STEP
        measured = (value(edge, points + d) - value(edge, points - d)) / (2 * STEP)
        np.testing.assert_allclose(value(row[k], points), measured, rtol=1e-8, atol=1e-8)


@pytest.mark.parametrize("formula", ["min(x, y)", "max(x, y)"])
def test_where_operands_are_equal_the_lesser_and_the_greater_have_the_mean_of_the_derivatives_beside(
    formula: str,
) -> None:
    """Along (1, 1) both operands move alike, and so does the chosen one, whichever it is."""
    g = Graph()
    x, y = g.input("q", 0), g.input("q", 1)
    (row,) = partials(g, [lower(parse(formula), g, {"x": x, "y": y})], [x, y])
    values = evaluate_edges(Program("p", g, {}, ()), row, {"q": np.full((3, 2), 0.7)}, {})
    assert [np.unique(value).tolist() for value in values] == [[0.5], [0.5]]


def test_nothing_is_formed_of_what_derivatives_take_for_constant() -> None:
    """x sin(y cos(x)) with the sine held: its derivatives are there already, and no rate of what it is made of."""
    g = Graph()
    x, y = g.input("q", 0), g.input("q", 1)
    held = g.call(STOP_GRADIENT, g.call("sin", g.mul(y, g.call("cos", x))))
    edge, before = g.mul(x, held), len(g)
    assert partials(g, [edge], [x, y]) == [[held, 0]]
    assert adjoint(g, [edge], [1], [x, y]) == [held, 0]
    assert (len(g), g.packs) == (before, [])


@pytest.mark.parametrize("formula", FORMULAS)
def test_reverse_mode_equals_forward_mode(formula: str) -> None:
    g = Graph()
    x, y, w = g.input("q", 0), g.input("q", 1), g.input("v", 0)
    edge = lower(parse(formula), g, {"x": x, "y": y})
    edges, weights = [edge, -edge, g.mul(edge, x)], [w, g.constant(0.25), g.constant(-2.0)]
    reverse = adjoint(g, edges, weights, [x, -y])
    forward = partials(g, edges, [x, y])
    at = {"q": np.random.default_rng(0).uniform(0.5, 2.0, (20, 2)), "v": np.full((20, 1), 0.7)}

    def values(of: list[int]) -> np.ndarray:
        return np.array([np.broadcast_to(value, 20) for value in evaluate_edges(Program("p", g, {}, ()), of, at, {})])

    w_of = values(weights)
    for k, sign in enumerate((1, -1)):
        expected = sum(weight * rate for weight, rate in zip(w_of, values([row[k] for row in forward]), strict=True))
        np.testing.assert_allclose(values(reverse)[k], sign * expected, rtol=1e-13, atol=1e-13)
