"""SymPy's way to C: Kane's equations, common subexpressions, printed assignments."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import sympy
from sympy.printing.c import C99CodePrinter

import symofros as sf
from validation.oracle.kane import derive
from validation.oracle.scope import Derived
from validation.timing.generated import Source

FUNCTIONS = ("mass_matrix", "bias", "dynamics", "forward_dynamics")
# Digits of numbers in the text: a double, exactly.
_DIGITS = 17


def kane_source(system: sf.System, name: str) -> Source:
    """One function of a small model, as its user would have SymPy make it.

    Args:
        system: Rigid, without friction.
        name: One of FUNCTIONS.

    Raises:
        NotDerivable: There are beams or constraints.
    """
    start = time.perf_counter()
    derived = derive(system)
    inputs = {"q": derived.q, "v": derived.v}
    tau = [sympy.Dummy(f"tau{i}") for i in range(len(derived.v))]
    if name == "forward_dynamics":
        inputs["tau"] = tuple(tau)
    outputs = _outputs(derived, tau, name)
    known = system.parameter_values()
    values = {symbol: sympy.Float(known[key], _DIGITS) for key, symbol in derived.symbols.items() if key in known}
    shorts = {symbol: meaning.xreplace(values) for symbol, meaning in derived.shorts.items()}
    flat = [sympy.sympify(x).xreplace(shorts).xreplace(values) for output in outputs for x in output]
    assignments, results = sympy.cse(flat, optimizations="basic")
    text = _text(name, inputs, assignments, results, [len(output) for output in outputs])
    seconds = time.perf_counter() - start
    sizes = tuple(len(output) for output in outputs)
    return Source(name, text, tuple(inputs), sizes, (0, 0), _operations(assignments, results), seconds)


def _outputs(derived: Derived, tau: Sequence[Any], name: str) -> list[list[Any]]:
    M, h = list(derived.values["mass_matrix"]), list(derived.values["bias"])
    if name == "forward_dynamics":
        n = len(h)
        net = sympy.Matrix([t - x for t, x in zip(tau, h, strict=True)])
        return [list(sympy.Matrix(n, n, M).LUsolve(net))]
    return {"mass_matrix": [M], "bias": [h], "dynamics": [M, h]}[name]


class _Printer(C99CodePrinter):  # type: ignore[misc]
    """Small powers as products, as anyone who wants speed has them."""

    def _print_Pow(self, expr: Any) -> str:
        if expr.exp.is_Integer and 2 <= abs(int(expr.exp)) <= 4:
            base = self.parenthesize(expr.base, 100)
            product = "*".join([base] * abs(int(expr.exp)))
            return f"({product})" if expr.exp > 0 else f"(1.0/({product}))"
        return str(super()._print_Pow(expr))


_Assignments = Sequence[tuple[Any, Any]]


def _text(name: str, inputs: Mapping[str, Sequence[Any]], assignments: _Assignments, results: Sequence[Any],
          sizes: Sequence[int]) -> str:  # fmt: skip
    names = {symbol: sympy.Symbol(f"in[{k}][{i}]")
             for k, group in enumerate(inputs.values()) for i, symbol in enumerate(group)}  # fmt: skip
    print_c = _Printer().doprint
    lines = ["#include <math.h>", "", "__attribute__((visibility(\"default\")))",
             f"int {name}(const double **in, double **out, long long *iw, double *w, int mem) {{"]  # fmt: skip
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
