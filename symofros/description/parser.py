"""Formula text -> Expression, by a whitelist: a model file is untrusted input.

The grammar (powers bind tightest and to the right, a minus sign less tightly than a power):

    sum     = product (("+" | "-") product)*
    product = unary (("*" | "/") unary)*
    unary   = ("-" | "+") unary | power
    power   = atom (("^" | "**") unary)?
    atom    = number | name | quoted | function "(" sum ("," sum)* ")" | "(" sum ")"

A name is an identifier, with points and an index if need be: q1, wrist.qx, u[0]. Any other name stands between
backquotes, a backquote within it doubled: `left-hip`, `L/R`, `c d`. What belongs to it may stand outside: its speed is
d`left-hip` or `dleft-hip`, a component `left-hip`.qx or `left-hip.qx`. The same quotes tell names from what formulas
reserve: `t`, `pi`, `sin`.

Nothing is ever evaluated, looked up or imported; length, depth and size of numbers are bounded.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from functools import lru_cache

from symofros.base.names import QUOTE, QUOTED_NAME, symbol_in
from symofros.errors import Problem, SymofrosError, near_name
from symofros.expr.expression import DUNDER, PLAIN_NAME, Expression
from symofros.expr.ops import FUNCTIONS

Token = tuple[str, str, int]

MAX_LENGTH = 10_000
MAX_DEPTH = 100

# Of texts that are parsed once and kept; longer ones are rare, and would take memory.
_SHORT = 100
# Of the tree: 1 + 1 + 1 + … is a tower. What works on formulas recurses into them.
MAX_HEIGHT = 300

_TOKEN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?(?![A-Za-z0-9_.]))"
    rf"|(?P<quoted>{QUOTED_NAME})"
    rf"|(?P<name>{PLAIN_NAME})"
    r"|(?P<sign>\*\*|[-+*/^(),]))",
    re.ASCII,
)
_WORD = re.compile(r"\.?[0-9][A-Za-z0-9_.]*", re.ASCII)

# Functions of other languages, and what stands for them here: a name that only looks like one of ours is another
# function, as floor is no log.
_STEP, _BOUNDED = "(1 + sign(x))/2", "max(low, min(high, x))"
_RADIANS, _DEGREES = "x*pi/180", "x*180/pi"
_OTHERWISE = {
    **dict.fromkeys(("step", "heaviside"), _STEP),
    **dict.fromkeys(("sgn", "signum"), "sign(x)"),
    **dict.fromkeys(("clip", "clamp", "sat", "saturate", "saturation"), _BOUNDED),
    **dict.fromkeys(("rad", "radians", "deg2rad"), _RADIANS),
    **dict.fromkeys(("deg", "degrees", "rad2deg"), _DEGREES),
    **dict.fromkeys(("sqr", "square"), "x^2"),
    **{f"arc{name}": f"a{name}(x)" for name in ("sin", "cos", "tan")},
    "arctan2": "atan2(y, x)",
    "ln": "log(x)",
    "log10": "log(x)/log(10)",
    "log2": "log(x)/log(2)",
    "fabs": "abs(x)",
    "power": "x^y",
    "cbrt": "sign(x)*abs(x)^(1/3)",
    "hypot": "sqrt(x^2 + y^2)",
    "sec": "1/cos(x)",
    "csc": "1/sin(x)",
    "cot": "1/tan(x)",
    "asinh": "log(x + sqrt(x^2 + 1))",
    "acosh": "log(x + sqrt(x^2 - 1))",
    "atanh": "log((1 + x)/(1 - x))/2",
}

# What compares or joins conditions elsewhere, and what does here.
_COMPARING = "<>=!&|"
_CONDITIONS = "a condition is a formula that counts above zero: a - b for a > b, min(a, b) for and, max(a, b) for or"
_PRODUCTS = "write products with '*', and numbers without units: they are in SI, angles in radians"


class ExpressionError(SymofrosError, ValueError):
    """A text that is not a formula; says where and why."""

    def __init__(self, text: str, reason: str, position: int, remedy: str = "") -> None:
        self.text, self.reason, self.position, self.remedy = text, reason, position, remedy
        super().__init__(f"{reason} at character {position + 1} of '{self.excerpt}'")

    @property
    def excerpt(self) -> str:
        """The text around the fault, at most 60 characters."""
        start = max(0, self.position - 30)
        cut = self.text[start : start + 60]
        return ("…" if start else "") + cut + ("…" if start + 60 < len(self.text) else "")

    def problem_of(self, what: str, where: str = "") -> Problem:
        """The problem of the named object whose formula this is."""
        return Problem(
            f"{what}: {self.reason}",
            f"'{self.excerpt}' (character {self.position + 1})",
            "a formula holds numbers, names, + - * / ^ ( ) and functions such as sin, sqrt, max; nothing in it is run",
            self.remedy or "write a number, or a formula such as L1/2 + 0.1*cos(q1)",
            where,
        )


@dataclass
class _Reader:
    text: str
    tokens: list[Token]
    at: int = 0
    depth: int = 0

    @property
    def token(self) -> Token:
        return self.tokens[self.at]

    def fail(self, reason: str, remedy: str = "") -> ExpressionError:
        return ExpressionError(self.text, reason, self.token[2], remedy)

    def take(self, *signs: str) -> str:
        """The next sign if it is one of these, consumed; "" otherwise."""
        kind, text, _ = self.token
        if kind == "sign" and text in signs:
            self.at += 1
            return text
        return ""

    def sum(self) -> Expression:
        left = self.product()
        while sign := self.take("+", "-"):
            left = Expression("add" if sign == "+" else "sub", (left, self.product()))
        return left

    def product(self) -> Expression:
        left = self.unary()
        while sign := self.take("*", "/"):
            left = Expression("mul" if sign == "*" else "div", (left, self.unary()))
        return left

    def unary(self) -> Expression:
        # Every nested construct passes here, so this is where depth is counted.
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise self.fail(f"nested deeper than {MAX_DEPTH}", "split it with named parameters")
        try:
            sign = self.take("-", "+")
            if not sign:
                return self.power()
            operand = self.unary()
            if sign == "+":
                return operand
            if operand.kind == "number":
                return Expression("number", number=-operand.number)
            return Expression("neg", (operand,))
        finally:
            self.depth -= 1

    def power(self) -> Expression:
        base = self.atom()
        if self.take("^", "**"):
            return Expression("pow", (base, self.unary()))
        return base

    def atom(self) -> Expression:
        kind, text, _ = self.token
        if kind == "number":
            number = float(text)
            if not math.isfinite(number):
                raise self.fail("number too large for a double")
            self.at += 1
            return Expression("number", number=number)
        if kind == "name":
            self.at += 1
            if self.token[:2] == ("sign", "("):
                self.at -= 1
                return self.call(text)
            if text in FUNCTIONS:
                raise self.fail(
                    f"function '{text}' without its arguments",
                    f"write {text}(…); a joint or an input of that name is written {QUOTE}{text}{QUOTE}",
                )
            return Expression("symbol", name=text)
        if kind == "quoted":
            name = symbol_in(text)
            if not name.isprintable():
                raise self.fail("a name between backquotes holds characters that can't be printed")
            self.at += 1
            return Expression("symbol", name=name)
        if self.take("("):
            inner = self.sum()
            if not self.take(")"):
                raise self.fail("')' expected")
            return inner
        raise self.fail("formula ends too early" if kind == "end" else f"'{text}' unexpected")

    def call(self, name: str) -> Expression:
        op = FUNCTIONS.get(name)
        if op is None:
            raise self.fail(f"'{name}' is not a function that formulas may call", _instead_of(name))
        self.at += 2
        args = [self.sum()]
        while self.take(","):
            args.append(self.sum())
        if not self.take(")"):
            raise self.fail("')' expected")
        if len(args) != op.arity:
            raise self.fail(f"{name} takes {op.arity} argument{'s' * (op.arity > 1)}, {len(args)} given")
        return Expression(name, tuple(args))


def tokenize(text: str) -> list[Token]:
    """The tokens of a formula: kind ("number", "name", "quoted", "sign" and at last "end"), text, position.

    Raises:
        ExpressionError: Too long, or something that is not a token.
    """
    if len(text) > MAX_LENGTH:
        raise ExpressionError(text, f"longer than {MAX_LENGTH} characters", MAX_LENGTH, "split it with parameters")
    tokens: list[Token] = []
    at, end = 0, len(text.rstrip())
    while at < end:
        match = _TOKEN.match(text, at)
        if match is None or match.lastgroup is None:
            at += len(text[at:]) - len(text[at:].lstrip())
            if text[at] == QUOTE:
                remedy = "end the name with a backquote; one within a name is doubled"
                raise ExpressionError(text, "a name between backquotes that never ends", at, remedy)
            word = _WORD.match(text, at)
            if word is not None:
                raise ExpressionError(text, f"'{word.group():.60}' is neither a number nor a name", at, _PRODUCTS)
            remedy = _CONDITIONS if text[at] in _COMPARING else ""
            raise ExpressionError(text, f"{text[at]!r} is not allowed in a formula", at, remedy)
        kind, token, start = match.lastgroup, match.group(match.lastgroup), match.start(match.lastgroup)
        if kind == "name" and DUNDER.search(token):
            raise ExpressionError(text, f"'{token}' is not a legal name", start)
        tokens.append((kind, token, start))
        at = match.end()
    tokens.append(("end", "", end))
    return tokens


def parse(text: str) -> Expression:
    """Read a formula.

    Args:
        text: Such as "L1/2 + 0.1*cos(q1)".

    Raises:
        ExpressionError: Anything outside the grammar, too long, or too deep.
    """
    return _parsed_once(text) if len(text) <= _SHORT else _parsed(text)


def _parsed(text: str) -> Expression:
    reader = _Reader(text, tokenize(text))
    expression = reader.sum()
    if reader.token[0] != "end":
        raise reader.fail(f"'{reader.token[1]}' unexpected", _PRODUCTS)
    if _height(expression) > MAX_HEIGHT:
        raise ExpressionError(text, f"a chain of more than {MAX_HEIGHT} operations", 0, "group terms by parentheses")
    return replace(expression, written=text)


# An editor reads the same file after each edit, and nearly all of its formulas are as before.
_parsed_once = lru_cache(maxsize=1 << 14)(_parsed)


def _height(expression: Expression) -> int:
    height, stack = 0, [(expression, 1)]
    while stack:
        node, level = stack.pop()
        height = max(height, level)
        stack += [(arg, level + 1) for arg in node.args]
    return height


def _instead_of(name: str) -> str:
    """The remedy for a function that formulas don't have."""
    if name.lower() in _OTHERWISE:
        return f"write {_OTHERWISE[name.lower()]}"
    return near_name(name, FUNCTIONS, likeness=0.7) or f"use one of: {', '.join(FUNCTIONS)}"
