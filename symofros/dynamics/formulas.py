"""Formulas of the user's own over a mechanism's coordinates, speeds, inputs, parameters and time -> a Program."""

from __future__ import annotations

from collections.abc import Sequence

from symofros.description.values import Value, symbols
from symofros.dynamics.derivatives import by_configuration, by_inputs
from symofros.errors import Problem, UnknownNameError, did_you_mean
from symofros.expr.graph import Graph
from symofros.expr.program import Function, Output, Program
from symofros.kinematics.links import set_in_motion
from symofros.topology.tree import SpanningTree


def formula_program(tree: SpanningTree, values: Sequence[Value]) -> Program:
    """One function, "formulas", of q, v, u and t: the values, and their derivatives along the manifold of q and by v.

    Args:
        tree: Its names are what formulas may use.
        values: Numbers and formulas.

    Raises:
        UnknownNameError: A formula uses a name that the mechanism lacks.
    """
    names = tree.coordinates
    known = {*names.symbols, *names.constants}
    for value in values:
        for name in sorted(symbols(value) - known):
            raise UnknownNameError(str(Problem(
                f"system '{tree.system.name}': unknown symbol '{name}'", f"'{value}'",
                "a formula uses coordinates, speeds (d and the coordinate's name), inputs, parameters and t",
                did_you_mean(name, known) or "see model.names",
            )))  # fmt: skip
    motion = set_in_motion(Graph(), tree)
    g, nv, n = motion.g, len(names.v), len(values)
    edges = [motion.lowering.value(value) for value in values]
    by_q, by_v = by_configuration(motion, edges), by_inputs(motion, edges, "v", nv)
    outputs = (
        Output("value", (n,), tuple(edges)),
        Output("by_q", (n, nv), tuple(edge for row in by_q for edge in row)),
        Output("by_v", (n, nv), tuple(edge for row in by_v for edge in row)),
    )
    sizes = {"q": len(names.q), "v": nv, "u": len(names.u), "par": len(names.par), "t": 1}
    return Program(tree.system.name, g, sizes, (Function("formulas", "", ("q", "v", "u", "t"), outputs),))
