"""The op table: everything that can be computed, one row an operation.

The graph's constant folding, the interpreter, the C printer and the operation counter all read these rows, so
they can't disagree. The interpreter must match compiled C bit for bit, and NumPy's own vectorised functions differ from
libm in the last bit: sine and cosine are the polynomials that generated C uses (trigonometry.py), the other
transcendental rules go through the C library, one element at a time.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from symofros.expr.numerics import trigonometry

Array = npt.NDArray[np.float64]
Parity = Literal["odd", "even", ""]
Cost = Literal["add", "mul", "div", "call", "none"]


@dataclass(frozen=True, slots=True)
class Op:
    """One operation.

    Attributes:
        name: Name in graphs, text dumps and, for functions, in expressions.
        arity: Number of operands.
        rule: NumPy arrays in, NumPy array out; IEEE semantics, no exceptions. The caller turns NumPy's warnings off.
        c: C text with holes {0}, {1}.
        derivative: (graph, operands, result, i) -> partial derivative by operand i, as edges.
        cost: Category under which the operation counter books it.
        parity: Rule by which a sign on the only operand moves outside: f(-x) = -f(x) or f(x).
        is_function: Callable by this name in expressions.
    """

    name: str
    arity: int
    rule: Callable[..., Any]
    c: str
    derivative: Callable[[Any, tuple[int, ...], int, int], int]
    cost: Cost = "call"
    parity: Parity = ""
    is_function: bool = True


def _libm(function: Callable[..., float]) -> Callable[..., Any]:
    """Apply a C library function elementwise, with IEEE results where Python would raise."""

    def scalar(*x: float) -> float:
        try:
            return function(*x)
        except ValueError:  # Outside the domain.
            return math.nan
        except OverflowError:
            return math.inf

    def rule(*x: Any) -> Any:
        if all(isinstance(operand, float) for operand in x):
            return scalar(*x)
        return np.asarray(np.frompyfunc(scalar, len(x), 1)(*x), dtype=np.float64)

    return rule


def _polynomial(function: Callable[[float], float], rule: Callable[[Array], Array]) -> Callable[[Any], Any]:
    """A single number by the C library, arrays as generated C does it."""

    def either(x: Any) -> Any:
        if not isinstance(x, float):
            return rule(np.asarray(x))
        return function(x) if math.isfinite(x) else math.nan

    return either


def _log(x: float) -> float:
    return -math.inf if x == 0.0 else math.log(x)


def _sinh(x: float) -> float:
    return math.copysign(math.inf, x) if abs(x) > 711.0 else math.sinh(x)


def _step(x: Any) -> Any:
    return np.where(np.isnan(x), x, np.greater_equal(x, 0.0).astype(np.float64))


ADD, MUL, DIV, STOP_GRADIENT = "add", "mul", "div", "stop_gradient"

# Derivative rules: (graph, operand edges, edge of the result, i) -> partial derivative by operand i. Edges are ints;
# the graph is passed in, because it is itself built on this table.


def _d_product(g: Any, x: tuple[int, ...], y: int, i: int) -> int:
    return x[1 - i]


def _d_quotient(g: Any, x: tuple[int, ...], y: int, i: int) -> int:
    return int(g.div(1, x[1])) if i == 0 else -int(g.div(y, x[1]))


def _d_power(g: Any, x: tuple[int, ...], y: int, i: int) -> int:
    base, exponent = x
    if i == 0:
        return int(g.mul(exponent, g.power(base, g.sub(exponent, 1))))
    return int(g.mul(y, g.call("log", base)))


def _d_atan2(g: Any, x: tuple[int, ...], y: int, i: int) -> int:
    length2 = g.add(g.mul(x[0], x[0]), g.mul(x[1], x[1]))
    return int(g.div(x[1], length2)) if i == 0 else -int(g.div(x[0], length2))


def _d_choice(sign: int) -> Callable[[Any, tuple[int, ...], int, int], int]:
    """The derivative of min (sign 1) and max (sign -1): one for the chosen operand, half for each on a tie."""

    def rule(g: Any, x: tuple[int, ...], y: int, i: int) -> int:
        larger = sign * g.call("sign", g.sub(x[1 - i], x[i]))
        return int(g.mul(g.constant(0.5), g.add(1, larger)))

    return rule


def _one_minus_square(g: Any, x: int) -> int:
    return int(g.sub(1, g.mul(x, x)))


OPS: dict[str, Op] = {
    op.name: op
    for op in (
        Op(ADD, 2, np.add, "{0} + {1}", lambda g, x, y, i: 1, "add", is_function=False),
        Op(MUL, 2, np.multiply, "{0} * {1}", _d_product, "mul", is_function=False),
        Op(DIV, 2, np.divide, "{0} / {1}", _d_quotient, "div", is_function=False),
        Op("pow", 2, _libm(math.pow), "pow({0}, {1})", _d_power),
        Op("sqrt", 1, np.sqrt, "sqrt({0})", lambda g, x, y, i: g.div(g.constant(0.5), y), "div"),
        Op("exp", 1, _libm(math.exp), "exp({0})", lambda g, x, y, i: y),
        Op("log", 1, _libm(_log), "log({0})", lambda g, x, y, i: g.div(1, x[0])),
        Op(
            "sin",
            1,
            _polynomial(math.sin, trigonometry.sine),
            "sin({0})",
            lambda g, x, y, i: g.call("cos", x[0]),
            parity="odd",
        ),
        Op(
            "cos",
            1,
            _polynomial(math.cos, trigonometry.cosine),
            "cos({0})",
            lambda g, x, y, i: -g.call("sin", x[0]),
            parity="even",
        ),
        Op("tan", 1, _libm(math.tan), "tan({0})", lambda g, x, y, i: g.add(1, g.mul(y, y)), parity="odd"),
        Op(
            "asin",
            1,
            _libm(math.asin),
            "asin({0})",
            lambda g, x, y, i: g.div(1, g.sqrt(_one_minus_square(g, x[0]))),
            parity="odd",
        ),
        Op("acos", 1, _libm(math.acos), "acos({0})", lambda g, x, y, i: -g.div(1, g.sqrt(_one_minus_square(g, x[0])))),
        Op(
            "atan",
            1,
            _libm(math.atan),
            "atan({0})",
            lambda g, x, y, i: g.div(1, g.add(1, g.mul(x[0], x[0]))),
            parity="odd",
        ),
        Op("atan2", 2, _libm(math.atan2), "atan2({0}, {1})", _d_atan2),
        Op("sinh", 1, _libm(_sinh), "sinh({0})", lambda g, x, y, i: g.call("cosh", x[0]), parity="odd"),
        Op("cosh", 1, _libm(math.cosh), "cosh({0})", lambda g, x, y, i: g.call("sinh", x[0]), parity="even"),
        Op("tanh", 1, _libm(math.tanh), "tanh({0})", lambda g, x, y, i: _one_minus_square(g, y), parity="odd"),
        Op("abs", 1, np.fabs, "fabs({0})", lambda g, x, y, i: g.call("sign", x[0]), "add", parity="even"),
        Op("sign", 1, np.sign, "sym_sign({0})", lambda g, x, y, i: 0, "add", parity="odd"),
        Op("min", 2, np.fmin, "fmin({0}, {1})", _d_choice(1), "add"),
        Op("max", 2, np.fmax, "fmax({0}, {1})", _d_choice(-1), "add"),
        Op("floor", 1, np.floor, "floor({0})", lambda g, x, y, i: 0, "add", is_function=False),
        # One where the operand is not negative, else zero.
        Op("step", 1, _step, "sym_step({0})", lambda g, x, y, i: 0, "add", is_function=False),
        # The operand, which derivatives take for a constant.
        Op(STOP_GRADIENT, 1, np.positive, "{0}", lambda g, x, y, i: 0, "none", parity="odd", is_function=False),
    )
}

FUNCTIONS: dict[str, Op] = {name: op for name, op in OPS.items() if op.is_function}
