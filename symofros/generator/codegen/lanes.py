"""Batches: a loop over states, or several states at once, one in each lane of a vector."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from math import prod
from string import Template

from symofros.expr.edges import Edge
from symofros.expr.ops import ADD, DIV, MUL, OPS, STOP_GRADIENT
from symofros.expr.program import Function, Program
from symofros.generator.codegen import trigonometry
from symofros.native import native_text
from symofros.runtime.calls.kernel import LaneOptions

# Doubles of the widest vectors: scratch is laid out for them. As many lanes of floats as of doubles take half of that.
_WIDEST = 8
_MAX_LANES = 2 * _WIDEST
# Vectors of states that a function of several chunks takes at a time, so that each chunk's code is fetched once for
# all of them; as many as keep what they compute within so much of the second cache [bytes].
_MOST, _CACHE = 8, 1 << 19


def batch(c_name: str, function: Function, lanes: LaneOptions | None) -> str:
    """The C function that evaluates many states, row by row.

    Args:
        c_name: Name of the C function that evaluates one state.
        function: Function that it evaluates.
        lanes: Options of the code by vectors; None for none.
    """
    n_in, n_out = len(function.inputs) + 1, len(function.returns)
    lines = [
        f"static void {c_name}_batch(size_t n, const double *const *in, const size_t *in_stride, double *const *out,",
        "    double *work) {",
        f"    const double *x[{n_in}];",
        f"    double *y[{n_out}];",
        "    size_t i;",
        *(_rows(c_name, function, lanes) if lanes is not None else ()),
        f"    memcpy(x, in, {n_in} * sizeof *x);",
        f"    memcpy(y, out, {n_out} * sizeof *y);",
        "    for (i = 0; i < n; ++i) {",
        f"        {c_name}((const double *const *)x, y, work);",
        *(f"        x[{k}] += in_stride[{k}];" for k in range(n_in)),
        *(f"        y[{k}] += {prod(shape)};" for k, (_, shape) in enumerate(function.returns)),
        "    }",
        "}",
    ]
    return "\n".join(lines)


def _rows(c_name: str, function: Function, lanes: LaneOptions) -> list[str]:
    """The way to the vectors, unless they share one set of parameters and are given several."""
    n_in, n_out = len(function.inputs) + 1, len(function.returns)
    if lanes.in_rows:
        return [
            "#if SYM_LANES > 1",
            "    if (n > 1 && in_stride[0] == 0) {",
            f"        sym_column columns[{n_in + n_out}];",
            f"        sym_batch_rows(&{c_name}_vectors, n, in, in_stride, out, columns, work);",
            "        return;",
            "    }",
            "#endif",
        ]
    return [
        "#if SYM_LANES > 1",
        # One state alone is evaluated as the others are where that is less precise, or nothing else is there.
        f"    if (n > {0 if lanes.single or lanes.are_all else 1} && (SYM_OWN || in_stride[0] == 0)) {{",
        f"        sym_strided from[{n_in}], to[{n_out}];",
        f"        sym_way way[{n_in + n_out}];",
        f"        sym_column columns[{n_in + n_out}];",
        f"        sym_rows(&{c_name}_vectors, in, in_stride, out, from, to);",
        f"        sym_batch_lanes(&{c_name}_vectors, n, from, to, {int(lanes.single)}, way, columns, work);",
        "        return;",
        "    }",
        "#endif",
    ]


def one_state(c_name: str, function: Function) -> str:
    """The C function that evaluates one state, by vectors: a batch of one."""
    signature = "(size_t n, const double *const *in, const size_t *in_stride, double *const *out, double *work)"
    return "\n".join(
        [
            f"static void {c_name}_batch{signature};",
            f"static void {c_name}(const double *const *in, double *const *out, double *work) {{",
            f"    static const size_t stride[{len(function.inputs) + 1}] = {{0}};",
            f"    {c_name}_batch(1, in, stride, out, work);",
            "}",
        ]
    )


def strided(c_name: str, program: Program, function: Function, work: int, lanes: LaneOptions) -> str:
    """What the C file says of a function on vectors, and its batch in any layout unless lanes are rows."""
    inputs = [len(program.init), *(program.sizes[name] for name in function.inputs)]
    outputs = [prod(shape) for _, shape in function.returns]
    zeros = [(k, *run) for k, output in enumerate(function.outputs) for run in _runs(output.edges)]
    zero_runs = "".join(f"{k}, {first}, {count}, " for k, first, count in zeros)
    most = vectors_at_once(program, function, work)
    n = len(inputs) + len(outputs)
    if lanes.in_rows:
        return "\n".join(
            [
                f"static const int {c_name}_out_size[] = {{{', '.join(map(str, outputs))}}};",
                f"static const sym_vectors {c_name}_vectors = {{{len(inputs)}, {len(outputs)}, {most},",
                f"    {c_name}_out_size, {c_name}_v}};",
            ]
        )
    return "\n".join(
        [
            f"static const int {c_name}_in_size[] = {{{', '.join(map(str, inputs))}}};",
            f"static const int {c_name}_out_size[] = {{{', '.join(map(str, outputs))}}};",
            f"static const int {c_name}_zero[] = {{{zero_runs}-1}};",
            f"static const sym_vectors {c_name}_vectors = {{{len(inputs)}, {len(outputs)}, {most}, {c_name}_in_size,",
            f"    {c_name}_out_size, {c_name}_zero, {c_name}_v}};",
            f"static void {c_name}_lanes(size_t n, const sym_strided *in, const sym_strided *out, double *work) {{",
            f"    sym_way way[{n}];",
            f"    sym_column columns[{n}];",
            f"    sym_batch_lanes(&{c_name}_vectors, n, in, out, 0, way, columns, work);",
            "}",
        ]
    )


def _runs(edges: Sequence[Edge]) -> Iterator[tuple[int, int]]:
    """Start and length of the runs of entries that are always zero."""
    first = 0
    for is_zero, group in groupby(edge == 0 for edge in edges):
        count = sum(1 for _ in group)
        if is_zero:
            yield first, count
        first += count


def vectors_at_once(program: Program, function: Function, work: int) -> int:
    """The number of vectors of states that a chunk takes in turn.

    Args:
        program: Program of the function.
        function: Function to be evaluated on vectors.
        work: Vectors of scratch for one vector of states; zero for a function of one chunk.
    """
    bytes_each = 8 * _WIDEST * (work + sum(_sizes(program, function)))
    return max(1, min(_MOST, _CACHE // bytes_each)) if work else 1


def scratch(program: Program, function: Function, work: int, lanes: LaneOptions) -> int:
    """Doubles of scratch that a batch in lanes needs, alignment included.

    Args:
        program: Program of the function.
        function: Function whose inputs and outputs are kept in lanes.
        work: Vectors of scratch for one vector of states.
        lanes: Options of the code by vectors.
    """
    most = vectors_at_once(program, function, work)
    if lanes.in_rows:
        return 2 * (1 + most * work)
    return _WIDEST * (
        1 + most * work + sum(most * size + max(0, _MAX_LANES - size) for size in _sizes(program, function))
    )


def _sizes(program: Program, function: Function) -> list[int]:
    return [
        len(program.init),
        *(program.sizes[name] for name in function.inputs),
        *(prod(shape) for _, shape in function.returns),
    ]


def routines(lanes: LaneOptions) -> str:
    """The hand-written routines that batches in lanes call."""
    makers = {1: "SYM_BY_LANE", 2: "SYM_BY_LANES"}
    return Template(native_text("model/lanes.c.in")).substitute(
        functions="\n".join(f"{makers[arity]}({name}, {function})" for name, function, arity in called_functions()),
        own=int(lanes.own_parameters),
        single=int(lanes.single),
        in_rows=int(lanes.in_rows),
        sines=trigonometry.of_lanes(lanes.single),
        batches=native_text(f"model/lane_{'rows' if lanes.in_rows else 'columns'}.c.in"),
    )


def called_functions() -> list[tuple[str, str, int]]:
    """(operation, C function, number of operands) of the operations that text on vectors calls as sym_v_NAME."""
    return [
        (op.name, op.c.partition("(")[0], op.arity)
        for op in OPS.values()
        if op.name not in (ADD, MUL, DIV, STOP_GRADIENT)
    ]
