"""A scalar formula as the user stated it: an immutable syntax tree over numbers, symbols and the op table."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field

from symofros.base.arguments import check_argument
from symofros.base.names import QUOTE, RESERVED, is_rate_symbol, quoted, symbol_of
from symofros.errors import SymofrosError, UnknownNameError, did_you_mean
from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.expr.numerics.extended import Extended, extended_context, extended_rule
from symofros.expr.ops import FUNCTIONS

CONSTANTS: dict[str, float] = {"pi": 3.141592653589793}
_PRECEDENCE = {"add": 1, "sub": 1, "mul": 2, "div": 2, "neg": 3, "pow": 4}
_SIGN = {"add": " + ", "sub": " - ", "mul": "*", "div": "/", "pow": "^"}

# What stands in formulas without backquotes: identifiers between points, and an index.
PLAIN_NAME = r"[A-Za-z_][A-Za-z0-9_]*(?:\.[A-Za-z_][A-Za-z0-9_]*)*(?:\[\d{1,6}\])?"
DUNDER = re.compile(r"(?:^|\.)__|__(?:$|\.)")
_PLAIN = re.compile(PLAIN_NAME, re.ASCII)
_QUOTED_RESERVED = frozenset(map(symbol_of, RESERVED))


@dataclass(frozen=True, slots=True)
class Expression:
    """One node of a formula.

    Attributes:
        kind: "number", "symbol", "add", "sub", "mul", "div", "pow", "neg", or a function's name.
        args: Operands.
        number: The value of a "number".
        name: The name of a "symbol"; of a coordinate or input called t or pi, "`t`" or "`pi`".
        written: The text that a user wrote, of the whole of a formula alone; formulas are equal whatever it is.
    """

    kind: str
    args: tuple[Expression, ...] = ()
    number: float = 0.0
    name: str = ""
    written: str = field(default="", compare=False, repr=False)

    def __str__(self) -> str:
        """The formula in the notation that the parser reads."""
        return self.text(spelled)

    def text(self, spelling: Callable[[str], str]) -> str:
        """The formula with its symbols, constants left out, in a spelling of the caller's."""
        return _text(self, 0, spelling)

    def symbols(self) -> frozenset[str]:
        """The names this formula depends on; `pi` is a number, not a name."""
        return frozenset(node.name for node in walk(self) if node.kind == "symbol" and node.name not in CONSTANTS)


def walk(expression: Expression) -> Iterator[Expression]:
    """Every node of a formula, without recursion."""
    stack = [expression]
    while stack:
        node = stack.pop()
        yield node
        stack.extend(node.args)


def spelled(symbol: str) -> str:
    """A symbol as formulas have it: between backquotes unless it is a plain name without another meaning."""
    if symbol in _QUOTED_RESERVED or is_rate_symbol(symbol):
        return symbol
    plain = _PLAIN.fullmatch(symbol) and symbol not in FUNCTIONS and not DUNDER.search(symbol)
    return symbol if plain else quoted(symbol)


def always_quoted(symbol: str) -> str:
    """The same with backquotes where they would not be needed, too."""
    is_quoted = spelled(symbol) == symbol and symbol.endswith(QUOTE)
    return symbol if is_quoted or symbol in RESERVED else quoted(symbol)  # `t` is of who is called t, and not time.


def needs_quotes(symbols: Iterable[str]) -> list[str]:
    """Symbols that formulas have between backquotes, the longest first."""
    return sorted((name for name in symbols if spelled(name) != name), key=lambda name: (-len(name), name))


def _text(node: Expression, outer: int, spelling: Callable[[str], str]) -> str:
    if node.kind == "number":
        text = repr(node.number).removesuffix(".0")
        return f"({text})" if text.startswith("-") and outer > 1 else text
    if node.kind == "symbol":
        return node.name if node.name in CONSTANTS else spelling(node.name)
    own = _PRECEDENCE.get(node.kind)
    if own is None:
        return f"{node.kind}({', '.join(_text(arg, 0, spelling) for arg in node.args)})"
    if node.kind == "neg":
        text = "-" + _text(node.args[0], own, spelling)
    else:
        left, right = node.args
        # Subtraction and division associate to the left, powers to the right.
        raise_left, raise_right = (1, 0) if node.kind == "pow" else (0, 1)
        text = _text(left, own + raise_left, spelling) + _SIGN[node.kind] + _text(right, own + raise_right, spelling)
    return f"({text})" if own < outer else text


class NoValueError(SymofrosError, ArithmeticError):
    """A formula has a constant part that is no finite number, such as 1/(t - t)."""


def lower(expression: Expression, graph: Graph, bindings: Mapping[str, Edge]) -> Edge:
    """Put a formula into a graph.

    Raises:
        KeyError: A symbol has no binding.
        NoValueError: A constant part divides by zero, leaves a function's domain or has no end.
    """
    try:
        edge = _lowered(expression, graph, bindings)
        if _is_infinite(graph, edge):
            raise OverflowError(f"{expression!s:.80} is infinite")
    except ArithmeticError as error:
        raise NoValueError(
            f"formula '{expression!s:.80}' has no value",
            str(error),
            "constant parts are finite: no division by zero, each within the domain of its function",
            "mend the formula",
        ) from None
    return edge


def _lowered(expression: Expression, graph: Graph, bindings: Mapping[str, Edge]) -> Edge:
    """Lower without errors of our own: the graph's, and OverflowError for infinite constants beside variables."""
    kind = expression.kind
    if kind == "number":
        return graph.constant(expression.number)
    if kind == "symbol":
        if expression.name in CONSTANTS:
            return graph.constant(CONSTANTS[expression.name])
        return bindings[expression.name]
    args = [_lowered(arg, graph, bindings) for arg in expression.args]
    if kind == "neg":
        return -args[0]
    if kind == "pow":
        edge = graph.power(*args)
    elif kind in FUNCTIONS:
        edge = graph.call(kind, *args)
    else:
        edge = {"add": graph.add, "sub": graph.sub, "mul": graph.mul, "div": graph.div}[kind](*args)
    if not graph.is_constant(edge):
        for arg, stated in zip(args, expression.args, strict=True):
            if _is_infinite(graph, arg):
                raise OverflowError(f"{stated!s:.80} is infinite")
    return edge


def _is_infinite(graph: Graph, edge: Edge) -> bool:
    return math.isinf(graph.number(edge) or 0.0)


def evaluate(expression: Expression | float, values: Mapping[str, float]) -> float:
    """The number of a formula, by the graph's own constant folding.

    Args:
        expression: The formula, or a number already.
        values: The number of each symbol.

    Raises:
        ArgumentError: It is no formula, or no mapping.
        UnknownNameError: A symbol has no value.
        ArithmeticError: Division by zero, or outside a function's domain.
    """
    if isinstance(expression, float):
        return expression
    if not isinstance(expression, Expression) or not isinstance(values, Mapping):
        check_argument("evaluate: expression", expression, Expression | float)
        check_argument("evaluate: values", values, Mapping[str, float])
        return float(expression)
    missing = expression.symbols() - values.keys()
    if missing:
        name = min(missing)
        rule, remedy = "each symbol of a formula has a value", did_you_mean(name, values)
        raise UnknownNameError(f"'{name}' has no value", ", ".join(map(str, values)) or "none", rule, remedy)
    used = sorted(expression.symbols())
    for name in used:
        if not isinstance(values[name], float):
            check_argument(f"evaluate: the value of '{name}'", values[name], float)
    if expression.kind == "symbol" and expression.name not in CONSTANTS:
        return values[expression.name]
    graph = Graph()
    number = graph.number(_lowered(expression, graph, {name: graph.constant(values[name]) for name in used}))
    assert number is not None  # Everything was a number, and numbers fold.
    return number


def evaluate_extended(expression: Expression | float, values: Mapping[str, Extended]) -> Extended:
    """The value of a formula in extended precision.

    Raises:
        KeyError: A symbol has no value.
        ArithmeticError: Division by zero, or outside a function's domain.
    """
    if isinstance(expression, float):
        return extended_context().mpf(expression)
    kind = expression.kind
    if kind == "number":
        return extended_context().mpf(expression.number)
    if kind == "symbol":
        known = CONSTANTS.get(expression.name)
        return values[expression.name] if known is None else extended_context().mpf(known)
    args = [evaluate_extended(arg, values) for arg in expression.args]
    if kind == "neg":
        return -args[0]
    value = args[0] - args[1] if kind == "sub" else extended_rule(kind)(*args)
    if not isinstance(value, extended_context().mpf) or not extended_context().isfinite(
        value
    ):  # mpmath has complex roots and logarithms.
        raise ArithmeticError(f"{expression} is not a finite number")
    return value
