"""Extended precision: constants that are the nearest doubles, whatever the C library of the machine makes of them."""

from __future__ import annotations

import math
import subprocess
import sys

import mpmath
import numpy as np
import pytest

from symofros.description.parser import parse
from symofros.expr.expression import evaluate_extended
from symofros.expr.graph import Graph
from symofros.expr.numerics.extended import extended_context, extended_rule, nearest
from symofros.expr.ops import FUNCTIONS, OPS

# Where sines, exponentials and powers of glibc 2.36 differ between processors with and without fused multiply-adds.
OPERANDS = np.random.default_rng(7).uniform(0.05, 0.95, 200).tolist()


@pytest.mark.parametrize("name", [name for name, op in FUNCTIONS.items() if op.arity == 1])
def test_a_constant_is_the_nearest_double(name: str) -> None:
    """Against 60 digits, from half of which the nearest double to a value between two is known."""
    with mpmath.workdps(60):
        function = getattr(mpmath, {"abs": "fabs"}.get(name, name))
        for x in OPERANDS:
            exact = function(mpmath.mpf(x))
            value = nearest(name, x)
            assert abs(exact - value) <= min(abs(exact - math.nextafter(value, to)) for to in (-math.inf, math.inf))


def test_powers_and_angles_are_the_nearest_doubles() -> None:
    with mpmath.workdps(60):
        for x, y in zip(OPERANDS, OPERANDS[1:], strict=False):
            assert nearest("pow", x, y) == float(mpmath.mpf(x) ** mpmath.mpf(y))
            assert nearest("atan2", -x, y) == float(mpmath.atan2(-x, y))


@pytest.mark.parametrize("name", OPS)
def test_every_operation_has_a_rule_that_agrees_with_that_of_doubles(name: str) -> None:
    for x in OPERANDS[:20]:
        operands = [x, *OPERANDS[20 : 19 + OPS[name].arity]]
        exact = extended_rule(name)(*map(extended_context().mpf, operands))
        assert float(exact) == pytest.approx(float(OPS[name].rule(*operands)), rel=1e-14)


def test_function_values_at_limits_match_the_c_library() -> None:
    assert nearest("exp", 1000.0) == math.inf
    assert nearest("log", 0.0) == -math.inf
    assert nearest("exp", -1000.0) == 0.0
    for outside in (("log", -1.0), ("asin", 2.0), ("pow", -1.0, 0.5), ("sin", math.inf)):
        assert math.isnan(nearest(*outside))  # type: ignore[arg-type]


def test_atan2_ignores_the_sign_of_zero() -> None:
    """Zeros of graphs have none: an angle must not depend on how its zero came about."""
    assert nearest("atan2", -0.0, -1.0) == nearest("atan2", 0.0, -1.0) == math.pi


def test_graphs_fold_to_the_nearest_double() -> None:
    g = Graph()
    for x in OPERANDS:
        assert g.number(g.call("exp", g.constant(x))) == nearest("exp", x)


@pytest.mark.parametrize("text", ["xi^2*exp(-xi)", "1 - cos(pi*xi/2)", "max(xi, 0.2) - min(-xi, 1/3)", "atan2(xi, 2)"])
def test_a_formula_has_the_digits_of_the_context(text: str) -> None:
    xi = extended_context().mpf(0.3)
    step = extended_context().mpf(2) ** -90  # Far below a double's rounding of 0.3, and seen.
    low, high = (evaluate_extended(parse(text), {"xi": x}) for x in (xi, xi + step))
    assert low != high and float(low) == float(high)


@pytest.mark.parametrize("text", ["sqrt(xi - 1)", "log(xi - 1)", "1/(xi - xi)", "log(xi - xi)", "acos(xi + 1)"])
def test_formulas_outside_their_domain_raise(text: str) -> None:
    with pytest.raises(ArithmeticError):
        evaluate_extended(parse(text), {"xi": extended_context().mpf(0.3)})


def test_the_first_constant_within_a_loop_of_numpy_raises_no_warning() -> None:
    """In a process of its own, where mpmath is loaded in the loop: what it raises is no error of the loop."""
    script = """
import warnings, numpy as np
from symofros.expr.graph import Graph
from symofros.expr.terms import terms
warnings.simplefilter("error")
g = Graph()
np.arctan2(terms(g, [g.constant(0.53)]), terms(g, [g.constant(0.85)]))
"""
    subprocess.run([sys.executable, "-c", script], check=True)
