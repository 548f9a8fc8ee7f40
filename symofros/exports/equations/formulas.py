"""Harmonic sums -> SymPy, grouped as a person would write them; formulas of a description -> SymPy."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import reduce
from typing import Any

import sympy

from symofros.base.names import name_of
from symofros.exports.equations.harmonics import Frequency, Harmonics, Monomial, real_waves
from symofros.exports.equations.reading import Call
from symofros.expr import DIV, Expression, Slot, spelled

# Denominators of numbers that are written as fractions; others are written as decimals.
_DENOMINATORS = (1, 2, 3, 4, 6, 8, 12, 16, 24)
_LARGEST_NUMERATOR = 1000
# SymPy factors sums of so many terms in milliseconds.
_FACTORED_TERMS = 12

_FUNCTIONS: dict[str, Callable[..., Any]] = {
    DIV: lambda x: 1 / x,
    "pow": sympy.Pow,
    "sqrt": sympy.sqrt,
    "abs": sympy.Abs,
    "min": sympy.Min,
    "max": sympy.Max,
    "step": lambda x: sympy.Heaviside(x, 1),
    **{name: getattr(sympy, name) for name in ("exp", "log", "sin", "cos", "tan", "asin", "acos", "atan", "atan2")},
    **{name: getattr(sympy, name) for name in ("sinh", "cosh", "tanh", "sign", "floor")},
}

_WORD = re.compile(r"[A-Za-z_][A-Za-z0-9_.]*")
_ESCAPED = {
    **{sign: f"\\{sign}" for sign in "_#$%&{}"},
    "\\": "\\textbackslash{}",
    "^": "\\textasciicircum{}",
    "~": "\\textasciitilde{}",
    "`": "\\textasciigrave{}",
}

# A term: its number, and the power of each factor.
Term = tuple[Any, dict[Any, int]]


def symbol(name: str) -> Any:
    """A real symbol."""
    return sympy.Symbol(name, real=True)


def exact(value: float) -> Any:
    """A number as a person would write it: a fraction of a small denominator, otherwise a decimal."""
    for denominator in _DENOMINATORS:
        multiple = value * denominator
        nearest = round(multiple)
        if 0 < abs(nearest) <= _LARGEST_NUMERATOR and abs(multiple - nearest) <= 1e-14 * abs(multiple):
            return sympy.Rational(nearest, denominator)
    return sympy.Float(value) if value else sympy.Integer(0)


def of_expression(value: Expression | float, symbols: Mapping[str, Any]) -> Any:
    """A formula of a description, as it is written there."""
    if not isinstance(value, Expression):
        return exact(value)
    if value.kind == "number":
        return exact(value.number)
    if value.kind == "symbol":
        return sympy.pi if value.name == "pi" else symbols[value.name]
    args = [of_expression(arg, symbols) for arg in value.args]
    if value.kind == "neg":
        return -args[0]
    operators: dict[str, Callable[[Any, Any], Any]] = {
        "add": lambda a, b: a + b,
        "sub": lambda a, b: a - b,
        "mul": lambda a, b: a * b,
        "div": lambda a, b: a / b,
    }
    return operators[value.kind](*args) if value.kind in operators else _FUNCTIONS[value.kind](*args)


class Writer:
    """SymPy expressions of harmonic sums.

    Args:
        atoms: Meaning of each atom.
        symbols: Symbol of each input.
    """

    def __init__(self, atoms: Sequence[Slot | Call], symbols: Mapping[Slot, Any]) -> None:
        self._atoms, self._symbols = atoms, symbols
        self._known: dict[int, Any] = {}

    def expression(self, a: Harmonics) -> Any:
        """The shortest of some ways to group the terms of a sum."""
        terms = [
            (exact(c), powers | {wave: 1} if wave is not None else powers)
            for key, coefficients in real_waves(a).items()
            for wave in [self._wave(*key)]
            for c, powers in ((c, self._powers(monomial)) for monomial, c in coefficients.items())
        ]
        if len(terms) < 2:
            return _sum(terms)
        waves = {factor for _, powers in terms for factor in powers if factor.is_Function}
        speeds = {self._symbols[slot] for slot in self._symbols if slot.group in ("v", "u", "a")}
        candidates = [_grouped(terms, waves), _grouped(terms, speeds), _by_commonest(terms), _compact(terms)]
        return min(candidates, key=sympy.count_ops)

    def _wave(self, frequency: Frequency, sine: bool) -> Any:
        if not frequency:
            return None
        angle = sympy.Add(*(exact(n) * _product(self._powers(monomial)) for monomial, n in frequency))
        return (sympy.sin if sine else sympy.cos)(angle)

    def _powers(self, monomial: Monomial) -> dict[Any, int]:
        return {self._atom(index): n for index, n in monomial}

    def _atom(self, index: int) -> Any:
        if index not in self._known:
            meaning = self._atoms[index]
            self._known[index] = (
                self._symbols[meaning]
                if isinstance(meaning, Slot)
                else _FUNCTIONS[meaning.name](*map(self.expression, meaning.operands))
            )
        return self._known[index]


def _product(powers: Mapping[Any, int]) -> Any:
    return sympy.Mul(*(factor**n for factor, n in powers.items()))


def _sum(terms: Iterable[Term]) -> Any:
    return sympy.Add(*(c * _product(powers) for c, powers in terms))


def _compact(terms: Sequence[Term]) -> Any:
    """The sum with its common factors in front; where all numbers are fractions and the terms few, factored."""
    common = reduce(_common, (powers for _, powers in terms))
    rest = [(c, {factor: n - common.get(factor, 0) for factor, n in powers.items()}) for c, powers in terms]
    total = _sum(rest)
    if len(terms) <= _FACTORED_TERMS and all(c.is_Rational for c, _ in terms):
        total = sympy.factor(total)
    elif all(c == terms[0][0] or c == -terms[0][0] for c, _ in terms):
        total = sympy.Mul(terms[0][0], _sum((c / terms[0][0], powers) for c, powers in rest), evaluate=False)
    # A sign that all terms have stands in front.
    sign = -1 if common and len(terms) > 1 and all(c < 0 for c, _ in terms) else 1
    return sign * _product(common) * (sign * total)


def _common(a: Mapping[Any, int], b: Mapping[Any, int]) -> dict[Any, int]:
    return {factor: n for factor in a if factor in b and (n := min(a[factor], b[factor]))}


def _grouped(terms: Sequence[Term], factors: set[Any]) -> Any:
    """The sum by its terms' powers of some factors."""
    groups: dict[tuple[tuple[Any, int], ...], list[Term]] = {}
    for c, powers in terms:
        key = tuple(sorted(((f, n) for f, n in powers.items() if f in factors), key=str))
        groups.setdefault(key, []).append((c, {f: n for f, n in powers.items() if f not in factors}))
    return sympy.Add(*(_product(dict(key)) * _compact(group) for key, group in groups.items()))


def _by_commonest(terms: Sequence[Term]) -> Any:
    """The sum by the factors that most of its terms have, in turn."""
    counts = Counter(factor for _, powers in terms for factor, n in powers.items() if n > 0)
    commonest = max(counts, key=lambda factor: (counts[factor], str(factor)), default=None)
    if commonest is None or counts[commonest] < 2:
        return _sum(terms)
    inner = [(c, {**powers, commonest: powers[commonest] - 1}) for c, powers in terms if powers.get(commonest, 0) > 0]
    outer = [(c, powers) for c, powers in terms if powers.get(commonest, 0) <= 0]
    stripped = [(c, {factor: n for factor, n in powers.items() if n}) for c, powers in inner]
    return commonest * _compact(stripped) + (_by_commonest(outer) if outer else 0)


def matrix(rows: Sequence[Sequence[Any]], columns: int) -> Any:
    """An immutable matrix, of no rows, too."""
    return sympy.ImmutableMatrix(len(rows), columns, [entry for row in rows for entry in row])


def text(expression: Any) -> str:
    """An expression in SymPy's notation; names that could be taken for operations between backquotes."""
    names = {old: old.name if name_of(old.name) != old.name else spelled(old.name) for old in expression.free_symbols}
    renamed = {old: symbol(new) for old, new in names.items() if new != old.name}
    return str(sympy.sstr(expression.xreplace(renamed), full_prec=False))


def latex(expression: Any, names: Mapping[Any, str]) -> str:
    """LaTeX of an expression; symbols as named."""
    return str(sympy.latex(expression, symbol_names=dict(names), full_prec=False))


def latex_of_name(name: str) -> str:
    """LaTeX of a name: Greek letters by theirs, digits and what follows an underscore as indices; else as text."""
    if name_of(name) != name or (spelled(name) != name and not _WORD.fullmatch(name)):
        return f"\\text{{{latex_text(name_of(name))}}}"
    plain = name.replace(".", "_")
    return str(sympy.latex(sympy.Symbol(plain)))


def latex_text(name: str) -> str:
    """A name as text of LaTeX."""
    return "".join(_ESCAPED.get(sign, sign) for sign in name)


class _NumPyText(sympy.printing.numpy.NumPyPrinter):  # type: ignore[misc]
    """NumPy's functions alone: SymPy has min and max by functools."""

    def _print_Min(self, expr: Any) -> str:
        return self._nested("minimum", expr.args)

    def _print_Max(self, expr: Any) -> str:
        return self._nested("maximum", expr.args)

    def _nested(self, name: str, args: Sequence[Any]) -> str:
        *others, last = map(self._print, args)
        return reduce(lambda text, arg: f"numpy.{name}({arg}, {text})", reversed(others), str(last))


def numpy_text(expression: Any, names: Mapping[Any, str]) -> str:
    """Python source of an expression, with functions of NumPy as np; symbols as named."""
    renamed = expression.xreplace({old: sympy.Symbol(new, real=True) for old, new in names.items()})
    printer = _NumPyText({"fully_qualified_modules": True, "precision": 17})
    return str(printer.doprint(renamed)).replace("numpy.", "np.")
