from __future__ import annotations

import mpmath
import pytest

from symofros.description.parser import parse
from symofros.expr.expression import lower
from symofros.expr.graph import Graph
from symofros.expr.numerics.precise import evaluate_precisely
from symofros.expr.program import Function, Output, Program
from tests.expr.test_derivative import FORMULAS


@pytest.mark.parametrize("formula", FORMULAS)
def test_precise_evaluation_matches_mpmath_to_thirty_digits(formula: str) -> None:
    """The same formula by mpmath itself."""
    g = Graph()
    edge = lower(parse(formula), g, {"x": g.input("q", 0), "y": g.input("q", 1)})
    function = Function("f", "", ("q",), (Output("y", (), (edge,)),))
    with mpmath.workdps(40):
        x, y = mpmath.mpf(3) / 4, mpmath.mpf(5) / 8
        names = {name: getattr(mpmath, name) for name in dir(mpmath)} | {"abs": abs, "min": min, "max": max}
        expected = eval(formula.replace("^", "**"), {}, names | {"x": x, "y": y})
        ((value,),) = evaluate_precisely(Program("p", g, {}, (function,)), function, {"q": [x, y]})
        assert abs(value - expected) < mpmath.mpf(10) ** -36
