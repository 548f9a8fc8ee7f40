"""Reverse mode: the gradient that forward mode gives."""

from __future__ import annotations

import numpy as np
import pytest

from symofros.description.parser import parse
from symofros.expr.adjoint import adjoint
from symofros.expr.derivative import partials
from symofros.expr.expression import lower
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import evaluate_edges
from symofros.expr.program import Program
from tests.expr.test_derivative import FORMULAS


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
