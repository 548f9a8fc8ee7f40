"""Functions that generated code begins and a hand-written routine finishes (native/model/)."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache, partial

from symofros.expr.program import Function, Program, Solver
from symofros.generator.codegen.function import FunctionText, FunctionWriter
from symofros.native import native_text

_WORK_MACRO = re.compile(r"^#define (SYM_\w+_WORK)\(([\w, ]+)\) (.+)$", re.MULTILINE)
# Routine -> the template files it needs, in the order in which C must see them; the keys are in that order, too.
ROUTINES: dict[str, tuple[str, ...]] = {
    "dense": ("dense",),
    "row_sizes": ("dense", "row_sizes"),
    "null_space_factors": ("dense", "row_sizes", "null_space_factors"),
    "null_space": ("dense", "row_sizes", "null_space_factors", "null_space"),
    "kkt": ("dense", "row_sizes", "null_space_factors", "kkt"),
    "constrained": ("dense", "row_sizes", "null_space_factors", "kkt", "constrained"),
    "project": ("dense", "row_sizes", "null_space_factors", "kkt", "constrained", "project"),
    "differentiate": ("dense", "row_sizes", "null_space_factors", "kkt", "differentiate"),
}


def with_solver(program: Program, c_name: str, function: Function, solver: Solver, packs: bool = False) -> FunctionText:
    """The C text of a function and of its parts, and the call of the routine that finishes it.

    Args:
        program: Staged program.
        c_name: Name of the C function.
        function: Function whose outputs generated code computes.
        solver: Routine that finishes it.
        packs: Whether values formed by the same operations share vectors.
    """
    terms = FunctionWriter(program, f"{c_name}_terms", ["pre", *function.inputs], function.outputs, packs=packs).text()
    parts = [
        FunctionWriter(program, f"{c_name}_{part.name}", ["pre", *part.inputs], part.outputs, packs=packs).text()
        for part in solver.parts
    ]
    needs = max(text.work for text in (terms, *parts))
    head = f"static void {c_name}(const double *const *in, double *const *out, double *restrict work) {{"
    body, work = _CALLS[solver.routine](c_name, function, needs)
    body = [*_tables(solver), *body]
    return FunctionText("\n".join([terms.code, *(part.code for part in parts), head, *body, "}"]), work)


def _tables(solver: Solver) -> list[str]:
    """The tables of a routine as the constant `measures`; C has no empty arrays."""
    names = ("group", "unit", "speed")
    return [
        *(
            f"    static const short {name}[] = {{{', '.join(map(str, table or (0,)))}}};"
            for name, table in zip(names, solver.tables, strict=True)
        ),
        f"    static const sym_measures measures = {{{', '.join(names)}}};",
    ]


def _constrained(c_name: str, function: Function, needs: int) -> tuple[list[str], int]:
    """M, r, G, c -> a, lam, rank, by multipliers."""
    m, n = function.outputs[2].shape
    return _on_terms("sym_constrained", c_name, m, n, max(needs, work_size("SYM_CONSTRAINED_WORK", n, m)))


def _null_space(c_name: str, function: Function, needs: int) -> tuple[list[str], int]:
    """M, r, G, c -> a, lam, rank, in the coordinates that the constraints leave free."""
    m, n = function.outputs[2].shape
    return _on_terms("sym_null_space", c_name, m, n, max(needs, work_size("SYM_NULL_SPACE_WORK", n, m)))


def _on_terms(routine: str, c_name: str, m: int, n: int, scratch: int) -> tuple[list[str], int]:
    """A routine that turns r and c, in the places of the results, into a and lam."""
    start = n * n + m * n
    lines = [
        "    double *terms[4];",
        f"    terms[0] = work, terms[1] = out[0], terms[2] = work + {n * n}, terms[3] = out[1];",
        f"    {c_name}_terms(in, terms, work + {start});",
        f"    *out[2] = {routine}({n}, {m}, &measures, terms[0], out[0], terms[2], out[1], work + {start});",
    ]
    return lines, start + scratch


def _project(c_name: str, function: Function, needs: int) -> tuple[list[str], int]:
    """The state -> the nearest one on the constraints."""
    m, n = function.outputs[1].shape
    nq = function.returns[0][1][0]
    lines = [
        f"    *out[3] = sym_project({nq}, {n}, {m}, &measures, {c_name}_terms, {c_name}_move,",
        "                          in, out[0], out[1], out[2], out[4], work);",
    ]
    return lines, work_size("SYM_PROJECT_WORK", nq, n, m) + max(needs, work_size("SYM_CONSTRAINED_WORK", n, m))


def _differentiate(c_name: str, function: Function, needs: int) -> tuple[list[str], int]:
    """The state -> derivatives of a and lam."""
    m, n = function.outputs[2].shape
    columns = [shape[1] for _, shape in function.returns]
    lines = [
        f"    static const int columns[{len(columns)}] = {{{', '.join(map(str, columns))}}};",
        f"    sym_differentiate({n}, {m}, &measures, {len(columns)}, columns, {c_name}_terms, {c_name}_slopes,",
        "                      in, out, work);",
    ]
    solving = work_size("SYM_KKT_SOLVE_WORK", n, m, max(1, *columns))
    return lines, work_size("SYM_DIFFERENTIATE_WORK", n, m) + solving + needs


def work_size(macro: str, *sizes: int) -> int:
    """Doubles of scratch of a routine: the value of its macro in native/model, such as "SYM_KKT_WORK", for sizes."""
    macros = _work_macros()
    parameters, expression = macros[macro]
    names: dict[str, object] = {name: partial(work_size, name) for name in macros}
    # Sums and products of integers are written the same in C and in Python.
    return int(eval(expression, {"__builtins__": {}}, names | dict(zip(parameters, sizes, strict=True))))


@cache
def _work_macros() -> dict[str, tuple[list[str], str]]:
    """Name -> parameters and expression of the macros that state the scratch of routines."""
    files = dict.fromkeys(file for needed in ROUTINES.values() for file in needed)
    text = "\n".join(native_text(f"model/{file}.c.in") for file in files)
    return {name: (parameters.split(", "), expression) for name, parameters, expression in _WORK_MACRO.findall(text)}


_CALLS: dict[str, Callable[[str, Function, int], tuple[list[str], int]]] = {
    "constrained": _constrained,
    "null_space": _null_space,
    "project": _project,
    "differentiate": _differentiate,
}
