"""SymPy's way to C: Kane's equations, common subexpressions, printed assignments."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import sympy
from sympy.printing.c import C99CodePrinter

import symofros as sf

from ...oracle.kane import derive
from .source import Source

FUNCTIONS = ("mass_matrix", "bias", "dynamics", "forward_dynamics")
# Digits of numbers in the text: a double, exactly.
_DIGITS = 17


def kane_source(system: sf.System, name: str) -> Source:
    """One function of a small model, as its user would have SymPy make it.

    Raises:
        NotDerivable: There are beams or constraints.
    """
    start = time.thread_time()
    derived = derive(system)
    inputs = {"q": derived.q, "v": derived.v}
    known = system.parameter_values()
    values = {symbol: sympy.Float(known[key], _DIGITS) for key, symbol in derived.symbols.items() if key in known}
    shorts = {symbol: meaning.xreplace(values) for symbol, meaning in derived.shorts.items()}
    M, h = (
        [_rounded(x.xreplace(shorts).xreplace(values)) for x in derived.values[part]]
        for part in ("mass_matrix", "bias")
    )
    wanted = {"mass_matrix": [M], "bias": [h]}.get(name, [M, h])
    assignments, results = sympy.cse([x for output in wanted for x in output], optimizations="basic")
    sizes = tuple(map(len, wanted))
    if name == "forward_dynamics":
        inputs["tau"] = tuple(sympy.Symbol(f"tau{i}") for i in range(len(h)))
        solved, results = _solved(results, inputs["tau"])
        assignments, sizes = [*assignments, *solved], (len(h),)
    text = _text(name, inputs, assignments, results, sizes)
    seconds = time.thread_time() - start
    return Source(name, text, tuple(inputs), sizes, (0, 0), _operations(assignments, results), seconds)


def _rounded(value: Any) -> Any:
    """The expression with the fractions that the oracle computes with replaced by floating-point numbers."""
    return value.xreplace({x: sympy.Float(x, _DIGITS) for x in value.atoms(sympy.Rational) if x.q != 1})


def _solved(entries: Sequence[Any], tau: Sequence[Any]) -> tuple[list[tuple[Any, Any]], list[Any]]:
    """Accelerations from the entries of M and h: each step of M = L D L^T is an assignment, or terms would swell."""
    n, assignments = len(tau), list[tuple[Any, Any]]()

    def named(name: str, value: Any) -> Any:
        assignments.append((sympy.Symbol(name), value))
        return assignments[-1][0]

    L: dict[tuple[int, int], Any] = {}
    D: list[Any] = []
    inverse: list[Any] = []
    x: list[Any] = []
    for j in range(n):
        column = {
            i: named(f"c{i}_{j}", entries[i * n + j] - sum(L[i, k] * D[k] * L[j, k] for k in range(j)))
            for i in range(j, n)
        }
        D.append(column[j])
        inverse.append(named(f"e{j}", 1 / column[j]))
        L |= {(i, j): named(f"l{i}_{j}", column[i] * inverse[j]) for i in range(j + 1, n)}
        given = tau[j] - entries[n * n + j]
        x.append(named(f"y{j}", given - sum(L[j, k] * x[k] for k in range(j))))
    for j in reversed(range(n)):
        x[j] = named(f"z{j}", x[j] * inverse[j] - sum(L[k, j] * x[k] for k in range(j + 1, n)))
    return assignments, x


class _Printer(C99CodePrinter):  # type: ignore[misc]
    """Small powers as products, as anyone who wants speed has them."""

    def _print_Pow(self, expr: Any) -> str:
        if expr.exp.is_Integer and 2 <= abs(int(expr.exp)) <= 4:
            base = self.parenthesize(expr.base, 100)
            product = "*".join([base] * abs(int(expr.exp)))
            return f"({product})" if expr.exp > 0 else f"(1.0/({product}))"
        return str(super()._print_Pow(expr))


_Assignments = Sequence[tuple[Any, Any]]


def _text(
    name: str,
    inputs: Mapping[str, Sequence[Any]],
    assignments: _Assignments,
    results: Sequence[Any],
    sizes: Sequence[int],
) -> str:
    names = {
        symbol: sympy.Symbol(f"in[{k}][{i}]")
        for k, group in enumerate(inputs.values())
        for i, symbol in enumerate(group)
    }
    print_c = _Printer().doprint
    lines = [
        "#include <math.h>",
        "",
        '__attribute__((visibility("default")))',
        f"int {name}(const double **in, double **out, long long *iw, double *w, int mem) {{",
    ]
    lines += [f"    const double {symbol} = {print_c(value.xreplace(names))};" for symbol, value in assignments]
    at = iter(results)
    for k, size in enumerate(sizes):
        lines += [f"    out[{k}][{i}] = {print_c(sympy.sympify(next(at)).xreplace(names))};" for i in range(size)]
    return "\n".join([*lines, "    (void)iw, (void)w, (void)mem;", "    return 0;", "}", ""])


def _operations(assignments: _Assignments, results: Sequence[Any]) -> dict[str, int]:
    counts: Counter[str] = Counter(mul=0, add=0, div=0, call=0)
    for value in [*(value for _, value in assignments), *results]:
        for part in sympy.preorder_traversal(value):
            if part.is_Add:
                counts["add"] += len(part.args) - 1
            elif part.is_Mul:
                factors = [x for x in part.args if x != -1]
                counts["mul"] += len(factors) - 1
            elif part.is_Pow and part.exp.is_Integer:
                counts["mul"] += abs(int(part.exp)) - 1
                counts["div"] += int(bool(part.exp < 0))
            elif part.is_Function:
                counts["call"] += 1
    return dict(counts)
