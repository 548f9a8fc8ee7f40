"""Formulas of conditions, evaluated together."""

from __future__ import annotations

import numpy as np

import symofros as sf
from symofros.expr.expression import Expression
from symofros.mechanics.topology.conditions import Formulas


def test_sums_over_a_long_mechanism_are_evaluated_however_deeply_they_are_nested() -> None:
    b, short, double = sf.formula("b"), sf.formula("a*b"), sf.formula("2*b")
    total = sf.formula("a")
    for k in range(5000):
        total = Expression("add", args=(total, b if k % 2 else double))
    formulas = Formulas([total, short, 3.0, total])
    values = formulas({"a": np.array([1.0, 2.0]), "b": 0.5})
    np.testing.assert_array_equal(values[0], np.array([1.0, 2.0]) + 3750.0)
    np.testing.assert_array_equal(values[1], [0.5, 1.0])
    assert values[2] == 3.0 and formulas.results[0] == formulas.results[3]
    assert formulas.symbols == {"a", "b"}
