"""Batches: a loop over states, or several states at once, one in each lane of a vector."""

from __future__ import annotations

from math import prod
from string import Template

from symofros.codegen.templates import template
from symofros.expr.ops import ADD, DIV, HELD, MUL, OPS
from symofros.expr.program import Function, Program

# The widest vectors, in doubles: scratch is laid out for them.
_WIDEST = 8


def batch(c_name: str, program: Program, function: Function, in_lanes: bool) -> str:
    """The C function that evaluates many states.

    Args:
        c_name: Of the function that evaluates one.
        program: Of the function.
        function: Of one state.
        in_lanes: Whether there is such a function on vectors, too.
    """
    n_in, n_out = len(function.inputs) + 1, len(function.returns)
    lines = [
        f"static void {c_name}_batch(size_t n, const double *const *in, const size_t *in_stride, double *const *out,",
        "    double *work) {",
        f"    const double *x[{n_in}];",
        f"    double *y[{n_out}];",
        "    size_t i;",
        *(_call(c_name, program, function) if in_lanes else ()),
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


def _call(c_name: str, program: Program, function: Function) -> list[str]:
    """The way to the vectors, unless they share one set of parameters and are given several."""
    inputs = [len(program.init), *(program.sizes[name] for name in function.inputs)]
    outputs = [prod(shape) for _, shape in function.returns]
    return [
        "#if SYM_LANES > 1",
        "    if (n > 1 && (SYM_OWN || in_stride[0] == 0)) {",
        f"        static const size_t in_size[] = {{{', '.join(map(str, inputs))}}};",
        f"        static const size_t out_size[] = {{{', '.join(map(str, outputs))}}};",
        f"        sym_v *from[{len(inputs)}], *to[{len(outputs)}];",
        f"        sym_batch_lanes(n, {len(inputs)}, in_size, in, in_stride, {len(outputs)}, out_size, out, {c_name}_v,",
        "                        from, to, work);",
        "        return;",
        "    }",
        "#endif",
    ]


def scratch(program: Program, function: Function, work: int) -> int:
    """Doubles of scratch that a batch in lanes needs, alignment included.

    Args:
        program: Of the function.
        function: Whose inputs and outputs are kept in lanes.
        work: Scratch of one state.
    """
    sizes = [
        len(program.init),
        *(program.sizes[name] for name in function.inputs),
        *(prod(shape) for _, shape in function.returns),
    ]
    return _WIDEST * (1 + work + sum(max(size, _WIDEST) for size in sizes))


def routines(own: bool) -> str:
    """The hand-written routines that batches in lanes call.

    Args:
        own: Whether each state may have parameters of its own.
    """
    makers = {1: "SYM_BY_LANE", 2: "SYM_BY_LANES"}
    functions = [
        f"{makers[op.arity]}({op.name}, {op.c.partition('(')[0]})"
        for op in OPS.values()
        if op.name not in (ADD, MUL, DIV, HELD)
    ]
    return Template(template("lanes.c.in")).substitute(functions="\n".join(functions), own=int(own))
