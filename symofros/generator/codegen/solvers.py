"""Functions that generated code begins and a hand-written routine finishes (native/model/)."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from functools import cache, partial

from symofros.base.routes import Choice
from symofros.expr.program import Function, Output, Program, Solver
from symofros.generator.codegen.function import FunctionText, FunctionWriter, Packs
from symofros.generator.codegen.sparse import SparseSystem
from symofros.native import native_text

_WORK_MACRO = re.compile(r"^#define (SYM_\w+_WORK)\(([\w, ]+)\) (.+)$", re.MULTILINE)
# Routine -> the template files it needs, in the order in which C must see them; the keys are in that order, too.
ROUTINES: dict[str, tuple[str, ...]] = {
    "dense": ("dense",),
    "row_sizes": ("dense", "row_sizes"),
    "null_space_factors": ("dense", "row_sizes", "null_space_factors"),
    "null_space": ("dense", "row_sizes", "null_space_factors", "null_space", "motion"),
    "kkt": ("dense", "row_sizes", "null_space_factors", "kkt"),
    "constrained": ("dense", "row_sizes", "null_space_factors", "kkt", "constrained", "motion"),
    "dense_system": ("dense", "row_sizes", "null_space_factors", "kkt", "constrained", "dense_system"),
    "sparse_system": ("dense", "row_sizes", "null_space_factors", "kkt", "constrained", "sparse_system"),
    "motion": ("motion",),
    "project": ("dense", "row_sizes", "null_space_factors", "kkt", "constrained", "project"),
    "differentiate": ("dense", "row_sizes", "null_space_factors", "kkt", "differentiate"),
    "responses": ("responses",),
    "adjoint": ("dense", "row_sizes", "null_space_factors", "kkt", "adjoint"),
    "transpose": ("dense", "row_sizes", "null_space_factors", "kkt", "adjoint", "transpose"),
    "hessian": ("dense", "row_sizes", "null_space_factors", "kkt", "adjoint", "hessian"),
}


# Routines that solve M a = r + G^T lam, G a = c, with full matrices or with packed ones.
_SYSTEM_SOLVERS = ("constrained", "project")


def solves_system(function: Function) -> bool:
    """Whether a function solves for constrained motion, with full matrices or with packed ones."""
    return function.solver is not None and function.solver.routine in _SYSTEM_SOLVERS


def sparse_systems(program: Program) -> tuple[dict[str, SparseSystem], Choice | None]:
    """Patterns of each function that solves for constrained motion, by its name, and the route of all of them.

    There are no patterns where full matrices do better in one of them, and no route where no function is of the kind.
    """
    systems: dict[str, SparseSystem] = {}
    route: Choice | None = None
    for function in filter(solves_system, program.functions):
        by_name = {output.name: output for output in function.outputs}
        system, route = SparseSystem.of(by_name["M"], by_name["G"])
        if system is None:
            return {}, route
        systems[function.name] = system
    return systems, route


def routines(program: Program, sparse: bool) -> list[str]:
    """The hand-written routines that a program's functions call, and those that they rest on, in order."""
    called = {function.solver.routine for function in program.functions if function.solver is not None}
    if called.intersection(_SYSTEM_SOLVERS):
        called.add("sparse_system" if sparse else "dense_system")
    return [native_text(f"model/{name}.c.in") for name in ROUTINES if any(name in ROUTINES[other] for other in called)]


def with_solver(
    program: Program,
    c_name: str,
    function: Function,
    solver: Solver,
    packs: Packs = "none",
    sparse: SparseSystem | None = None,
) -> FunctionText:
    """The C text of a function and of its parts, and the call of the routine that finishes it.

    Args:
        program: Staged program.
        c_name: Name of the C function.
        function: Function whose outputs generated code computes.
        solver: Routine that finishes it.
        packs: Whether values formed by the same operations, and those of equal limbs, share vectors.
        sparse: Patterns of M and G, where these are packed.
    """

    def text(name: str, inputs: tuple[str, ...], outputs: Sequence[Output]) -> FunctionText:
        limbs, c_function = packs != "none", f"{c_name}_{name}"
        return FunctionWriter(program, c_function, ["pre", *inputs], outputs, True, packs, limbs, True).text()

    terms = text("terms", function.inputs, function.outputs if sparse is None else sparse.packed(function.outputs))
    parts = [text(part.name, part.inputs, part.outputs) for part in solver.parts]
    needs = max(text.work for text in (terms, *parts))
    head = f"static void {c_name}(const double *const *in, double *const *out, double *restrict work) {{"
    body, work = _CALLS[solver.routine](c_name, function, needs, sparse)
    body = [*_tables(solver, sparse), *body]
    code = "\n".join([terms.code, *(part.code for part in parts), head, *body, "}"])
    return FunctionText(code, work, max([terms, *parts], key=lambda text: len(text.code)).choices)


def routine_work(function: Function, solver: Solver, needs: int) -> int:
    """Doubles of scratch of a routine with full matrices, whose terms and parts need so many."""
    return _CALLS[solver.routine]("", function, needs, None)[1]


def _tables(solver: Solver, sparse: SparseSystem | None) -> list[str]:
    """The tables of a routine, most as the constant `measures`; C has no empty arrays."""
    names = ("speeds", "begin", "entry") if solver.routine == "responses" else ("group", "unit", "speed")
    tables = [
        f"    static const short {name}[] = {{{', '.join(map(str, table or (0,)))}}};"
        for name, table in zip(names, solver.tables, strict=True)
    ]
    if solver.routine == "responses":
        return tables
    patterns = "NULL" if sparse is None else "&sparse"
    tables += sparse.tables() if sparse is not None else ()
    return [*tables, f"    static const sym_measures measures = {{{', '.join(names)}, {patterns}}};"]


def _solving(n: int, m: int, sparse: SparseSystem | None) -> int:
    """Doubles of scratch of sym_system_solve."""
    if sparse is None:
        return work_size("SYM_CONSTRAINED_WORK", n, m)
    return max(work_size("SYM_SPARSE_WORK", n, m, sparse.entries), work_size("SYM_SPARSE_FALLBACK_WORK", n, m))


def _constrained(c_name: str, function: Function, needs: int, sparse: SparseSystem | None) -> tuple[list[str], int]:
    """M, r, G, c, binds, phi -> a, lam, rank, by multipliers."""
    m, n = function.outputs[2].shape
    of = [f"sym_system_{name}" for name in ("solve", "sizes", "clear_row")]
    return _motion(c_name, function, sparse, of, max(needs, _solving(n, m, sparse)))


def _null_space(c_name: str, function: Function, needs: int, sparse: SparseSystem | None) -> tuple[list[str], int]:
    """M, r, G, c, binds, phi -> a, lam, rank, in the coordinates that the constraints leave free."""
    m, n = function.outputs[2].shape
    of = ["sym_null_space", "sym_row_sizes", "sym_clear_row"]
    return _motion(c_name, function, None, of, max(needs, work_size("SYM_NULL_SPACE_WORK", n, m)))


def _motion(
    c_name: str, function: Function, sparse: SparseSystem | None, form: Sequence[str], scratch: int
) -> tuple[list[str], int]:
    """Motion under constraints, by the rank of the posture beside the state that fulfils them.

    Args:
        c_name: Prefix of the function's names.
        function: Function whose outputs are the terms.
        sparse: Patterns of M and G, where these are packed.
        form: Names of the routines that solve, judge the sizes of G's rows, and clear one.
        scratch: Doubles of scratch that solving and the generated parts need.
    """
    assert function.solver is not None
    m, n = function.outputs[2].shape
    (moved,) = function.solver.parts[0].outputs
    M, _, G, *_ = function.outputs if sparse is None else sparse.packed(function.outputs)
    sizes, nq = (len(M.edges), len(G.edges)), moved.shape[0]
    lines = [
        f"    static const sym_form form = {{{', '.join(map(str, (*sizes, *form)))}}};",
        f"    sym_motion({nq}, {n}, {m}, &measures, &form, {c_name}_terms, {c_name}_move, in, out, work);",
    ]
    return lines, sum(sizes) + work_size("SYM_MOTION_WORK", nq, n, m) + scratch


def _project(c_name: str, function: Function, needs: int, sparse: SparseSystem | None) -> tuple[list[str], int]:
    """The state -> the nearest one on the constraints."""
    m, n = function.outputs[1].shape
    nq = function.returns[0][1][0]
    facing = sum(len(output.edges) for output in function.outputs if output.name == "facing")
    lines = [
        f"    *out[3] = sym_project({nq}, {n}, {m}, {facing}, &measures, {c_name}_terms, {c_name}_move,",
        "                          in, out[0], out[1], out[2], out[4], out[5], work);",
    ]
    return lines, work_size("SYM_PROJECT_WORK", nq, n, m) + max(needs, _solving(n, m, sparse))


def _differentiate(c_name: str, function: Function, needs: int, sparse: SparseSystem | None) -> tuple[list[str], int]:
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


def _responses(c_name: str, function: Function, needs: int, sparse: SparseSystem | None) -> tuple[list[str], int]:
    """The state -> derivatives of a of a rigid tree."""
    n, nu = function.returns[-1][1]
    direct = len(function.outputs[2].edges)
    lines = [f"    sym_respond({n}, {nu}, speeds, begin, entry, {c_name}_terms, in, out, work);"]
    return lines, work_size("SYM_RESPONSES_WORK", n, direct) + needs


def _transpose(c_name: str, function: Function, needs: int, sparse: SparseSystem | None) -> tuple[list[str], int]:
    """The state and cotangents of a and lam -> vector-Jacobian products."""
    m, n = function.outputs[2].shape
    lines = [
        f"    sym_transpose({n}, {m}, &measures, {c_name}_terms, {c_name}_slopes, in, out, work);",
    ]
    return lines, work_size("SYM_TRANSPOSE_WORK", n, m) + needs


def _hessian(c_name: str, function: Function, needs: int, sparse: SparseSystem | None) -> tuple[list[str], int]:
    """The state and cotangents of a and lam -> second derivatives of their sum."""
    m, n = function.outputs[2].shape
    k = function.returns[0][1][0]
    lines = [
        f"    sym_hessian({n}, {m}, {k}, &measures, {c_name}_terms, {c_name}_slopes, {c_name}_curvature,",
        "                in, out, work);",
    ]
    solving = work_size("SYM_KKT_SOLVE_WORK", n, m, k)
    return lines, work_size("SYM_HESSIAN_WORK", n, m, k) + solving + needs


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


_CALLS: dict[str, Callable[[str, Function, int, SparseSystem | None], tuple[list[str], int]]] = {
    "constrained": _constrained,
    "null_space": _null_space,
    "project": _project,
    "differentiate": _differentiate,
    "responses": _responses,
    "transpose": _transpose,
    "hessian": _hessian,
}
