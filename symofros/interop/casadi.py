"""CasADi: forward and inverse dynamics as external functions in C, with exact sparse Jacobians.

    dynamics = sf.interop.casadi.Dynamics(system)
    a = dynamics.forward_dynamics(q, v, u)      # SX is not possible: MX, DM or numbers

The library has CasADi's interface of external functions, which acados takes as well: `dynamics.library`, and the names
`dynamics.names`. Derivatives of second order are not available: Ipopt takes "limited-memory".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from symofros.base.options import Options
from symofros.compiler import Compilation
from symofros.description.system import System
from symofros.errors import CompileError
from symofros.expr.program import Function
from symofros.generator.codegen.names import identifier
from symofros.interop.rules import RULES, check_model, framework
from symofros.native import native_text
from symofros.runtime.build.build import build_library
from symofros.runtime.build.toolchain import NO_COMPILER, find_toolchain

casadi = framework("casadi", "casadi")


class Dynamics:
    """A system's dynamics for CasADi.

    Args:
        system: System as the user stated it, whose speeds are the rates of its coordinates.

    Attributes:
        library: Path of the shared library.
        names: Name of each function in the library, by ours; the Jacobian's begins with jac_.
        functions: Functions of CasADi, by ours; parameters are their last input.

    Raises:
        InteropError: The model has quaternions, prescribed motions or forces that depend on time.
        CompileError: There is no C compiler, or it refused.
    """

    def __init__(self, system: System) -> None:
        needed = {name for rule in RULES.values() for name, _ in rule.derivatives.values()} | set(RULES)
        compilation = Compilation(system, Options(tuple(sorted(needed))))
        check_model(compilation.model())
        toolchain = find_toolchain(None)
        if toolchain is None:
            raise CompileError(NO_COMPILER)
        c_name = identifier(system.name)
        self.names = {name: f"{c_name}_{name}" for name in RULES}
        self._par = compilation.record.par_default
        source = _source(compilation, c_name)
        self.library: Path = build_library(
            source, native_text("model/symofros_model.h"), toolchain, symbol=f"{c_name}_model"
        )
        self.functions = {name: casadi.external(own, str(self.library)) for name, own in self.names.items()}

    def forward_dynamics(self, q: Any, v: Any, u: Any, par: Any = None) -> Any:
        """Accelerations (nv) of q (nq), v (nv), u (nu), par (npar)."""
        return self.functions["forward_dynamics"](q, v, u, self._parameters(par))

    def inverse_dynamics(self, q: Any, v: Any, a: Any, par: Any = None) -> Any:
        """Efforts M a + h - Q(q, v, 0) (nv) of q, v, a (nv) and par (npar)."""
        return self.functions["inverse_dynamics"](q, v, a, self._parameters(par))

    def _parameters(self, par: Any) -> Any:
        return casadi.DM(self._par) if par is None else par


def _source(compilation: Compilation, c_name: str) -> str:
    """C text of the model and of the external functions."""
    record = compilation.record
    nv = len(record.v_names)
    sizes = {"q": len(record.q_names), "v": nv, "u": len(record.u_names), "a": nv, "par": len(record.par_names)}
    functions = {function.name: function for function in compilation.program.functions}
    texts = [compilation.source(c_name), native_text("interop/symofros_casadi.c")]
    for name, rule in RULES.items():
        own, inputs = f"{c_name}_{name}", [(key, sizes[key]) for key in rule.inputs]
        output = functions[name].returns[0][0]
        value = [(output, _gathered(functions[name], output, nv, 1))]
        texts.append(_external(own, c_name, rule.inputs, inputs, value))
        slopes = [
            (f"jac_{output}_{key}", _gathered(functions[function], array, nv, sizes[key]))
            for key, (function, array) in rule.derivatives.items()
        ]
        texts.append(_external(f"jac_{own}", c_name, rule.inputs, [*inputs, (f"out_{output}", nv)], slopes))
    return "\n".join(texts)


@dataclass(frozen=True)
class _Gathered:
    """An output of CasADi's: which entries of an array of the model's are its nonzeros, column by column.

    Attributes:
        function: Name of the model's function.
        array: Index of the array among what it returns.
        entries: (row, column) of each nonzero.
        shape: Rows and columns that CasADi sees.
    """

    function: str
    array: int
    entries: tuple[tuple[int, int], ...]
    shape: tuple[int, int]

    @property
    def gather(self) -> list[int]:
        """Index of each nonzero in the array, row by row."""
        return [row * self.shape[1] + column for row, column in self.entries]

    @property
    def sparsity(self) -> list[int]:
        """Rows, columns, first nonzero of each column, row of each nonzero."""
        starts = [sum(column < k for _, column in self.entries) for k in range(self.shape[1] + 1)]
        return [*self.shape, *starts, *(row for row, _ in self.entries)]


def _gathered(function: Function, array: str, rows: int, columns: int) -> _Gathered:
    """The first rows of an array; what a solver finishes is dense."""
    index = [name for name, _ in function.returns].index(array)
    edges = function.outputs[index].edges if function.solver is None else None
    entries = [
        (row, column)
        for column in range(columns)
        for row in range(rows)
        if edges is None or edges[row * columns + column] != 0
    ]
    return _Gathered(function.name, index, tuple(entries), (rows, columns))


def _external(
    own: str,
    c_name: str,
    given: Sequence[str],
    inputs: Sequence[tuple[str, int]],
    outputs: Sequence[tuple[str, _Gathered]],
) -> str:
    """The functions of the interface for one external function; inputs beyond `given` are not read."""
    n_in, n_out = len(inputs), len(outputs)
    lines = [f"static const long long {own}_in_{i}[] = {{{size}, 1, 1}};" for i, (_, size) in enumerate(inputs)]
    for i, (_, array) in enumerate(outputs):
        lines.append(f"static const long long {own}_out_{i}[] = {{{_numbers(array.sparsity)}}};")
        lines.append(f"static const long long {own}_gather_{i}[] = {{{_numbers(array.gather)}}};")
    plans = (
        f'{{"{array.function}", {array.array}, {len(array.entries)}, {own}_gather_{i}}}'
        for i, (_, array) in enumerate(outputs)
    )
    names = ", ".join(f'"{name}"' for name in given)
    labels = [(f'"{name}"', f"{own}_in_{i}") for i, (name, _) in enumerate(inputs)]
    results = [(f'"{name}"', f"{own}_out_{i}") for i, (name, _) in enumerate(outputs)]
    lines += [
        f"static const char *const {own}_given[] = {{{names}}};",
        f"static const sym_casadi_output {own}_outputs[] = {{{', '.join(plans)}}};",
        f"SYM_EXPORT long long {own}_n_in(void) {{ return {n_in}; }}",
        f"SYM_EXPORT long long {own}_n_out(void) {{ return {n_out}; }}",
        *_table(f"const char *{own}_name_in", [label for label, _ in labels]),
        *_table(f"const char *{own}_name_out", [label for label, _ in results]),
        *_table(f"const long long *{own}_sparsity_in", [pattern for _, pattern in labels]),
        *_table(f"const long long *{own}_sparsity_out", [pattern for _, pattern in results]),
        f"SYM_EXPORT int {own}_work(long long *arg, long long *res, long long *iw, long long *w) {{",
        f"    if (arg != NULL) *arg = {n_in};",
        f"    if (res != NULL) *res = {n_out};",
        "    if (iw != NULL) *iw = 0;",
        f"    if (w != NULL) *w = (long long)sym_casadi_work({c_name}_model());",
        "    return 0;",
        "}",
        f"SYM_EXPORT int {own}(const double **arg, double **res, long long *iw, double *w, int mem) {{",
        f"    const sym_model *model = {c_name}_model();",
        "    (void)iw, (void)mem;",
        f"    return sym_casadi_call(model, {own}_given, {len(given)}, {own}_outputs, {n_out}, arg, res, w);",
        "}",
        "",
    ]
    return "\n".join(lines)


def _table(declared: str, entries: Sequence[str]) -> list[str]:
    """A C function of an index."""
    cases = " ".join(f"case {i}: return {entry};" for i, entry in enumerate(entries))
    return [f"SYM_EXPORT {declared}(long long i) {{", f"    switch (i) {{ {cases} default: return NULL; }}", "}"]


def _numbers(values: Sequence[int]) -> str:
    return ", ".join(map(str, values)) or "0"
