"""SymPy -> Expression: the only module that reads SymPy; exports/equations/formulas.py writes it."""

from __future__ import annotations

from functools import reduce

import sympy

from symofros.expr.expression import Expression

# SymPy's class name -> name in the op table. Anything else is refused: it has no C text.
_FUNCTIONS = {
    "sin": "sin",
    "cos": "cos",
    "tan": "tan",
    "asin": "asin",
    "acos": "acos",
    "atan": "atan",
    "atan2": "atan2",
    "sinh": "sinh",
    "cosh": "cosh",
    "tanh": "tanh",
    "exp": "exp",
    "log": "log",
    "Abs": "abs",
    "sign": "sign",
    "Min": "min",
    "Max": "max",
}


def freeze(expression: sympy.Expr) -> Expression:
    """Turn a SymPy expression into an Expression, term by term, without expanding or simplifying it.

    Args:
        expression: Numbers, symbols, sums, products, powers and the functions of the op table.

    Raises:
        ValueError: The expression holds something without a C equivalent, such as an integral or a complex number.
    """
    if not isinstance(expression, sympy.Expr):
        raise ValueError(f"a {type(expression).__name__} of SymPy is no expression")
    if expression.is_Symbol:
        return Expression("symbol", name=str(expression.name))
    if expression.is_number and (expression.is_Number or expression.is_NumberSymbol):
        return _constant(expression)
    args = tuple(freeze(arg) for arg in expression.args)
    if expression.is_Add:
        return reduce(lambda a, b: Expression("add", (a, b)), args)
    if expression.is_Mul:
        return reduce(lambda a, b: Expression("mul", (a, b)), args)
    if expression.is_Pow:
        if expression.exp == -1:
            return Expression("div", (_number(1.0), args[0]))
        return Expression("pow", args)
    name = _FUNCTIONS.get(type(expression).__name__)
    if name is None or not args:
        raise ValueError(f"'{expression}' has no C equivalent: {type(expression).__name__}")
    if name in ("min", "max"):
        return reduce(lambda a, b: Expression(name, (a, b)), args)
    return Expression(name, args)


def _constant(number: sympy.Expr) -> Expression:
    if not number.is_finite:
        raise ValueError(f"{number} is not a finite number")
    if number is sympy.pi:
        return Expression("symbol", name="pi")
    if number.is_Rational and number.q != 1:
        return Expression("div", (_number(number.p), _number(number.q)))
    return _number(float(number))


def _number(value: float) -> Expression:
    return Expression("number", number=float(value))
