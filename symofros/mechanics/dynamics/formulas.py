"""Formulas of the user's own over a mechanism's coordinates, speeds, inputs, parameters and time -> a Program."""

from __future__ import annotations

from collections.abc import Sequence

from symofros.description.values import Value, symbols
from symofros.errors import DescriptionError, Problem
from symofros.expr.derivative import directional
from symofros.expr.edges import ONE, Edge
from symofros.expr.program import Function, Output, Program
from symofros.mechanics.dynamics.derivatives.differentiation import by_configuration, by_inputs
from symofros.mechanics.dynamics.equations import Equations
from symofros.mechanics.dynamics.reactions import bind_contacts, bind_reactions
from symofros.mechanics.kinematics.links import TreeKinematics


def formula_program(equations: Equations, values: Sequence[tuple[Value, int]], derivatives: bool = True) -> Program:
    """One function, "formulas", of q, v, u and t: the values, and their derivatives by q (along its manifold) and v.

    Where one uses multipliers, wrenches or reactions, it is of a and lam, too.

    Args:
        equations: Equations of the tree, in whose graph the formulas are formed.
        values: Numbers and formulas over its names, and how often each is differentiated by t.
        derivatives: Whether to form those by q and v.

    Raises:
        DescriptionError: One that is differentiated depends on more than t and parameters.
    """
    kinematics = equations.kinematics
    tree, names = kinematics.tree, kinematics.tree.coordinates
    g, nv, n = kinematics.g, len(names.v), len(values)
    used = {name for value, _ in values for name in symbols(value)}
    bind_contacts(equations, used)
    reactions = bind_reactions(equations, used)
    edges = [_rate(kinematics, value, order) for value, order in values]
    outputs = [Output("value", (n,), tuple(edges))]
    if derivatives:
        slopes = {"by_q": by_configuration(kinematics, edges), "by_v": by_inputs(kinematics, edges, "v", nv)}
        outputs += [Output(name, (n, nv), tuple(edge for row in rows for edge in row)) for name, rows in slopes.items()]
    sizes = {"q": len(names.q), "v": nv, "u": len(names.u), "par": len(names.par), "t": 1}
    inputs = ("q", "v", "u", "t", *(("a", "lam") if reactions else ()))
    if reactions:
        sizes |= {"a": nv, "lam": sum(len(item.conditions) for item in tree.system.constraints)}
    return Program(tree.system.name, g, sizes, (Function("formulas", "", inputs, tuple(outputs)),))


def _rate(kinematics: TreeKinematics, value: Value, order: int) -> Edge:
    names, g = kinematics.tree.coordinates, kinematics.g
    moving = {name for name, slot in (*names.symbols.items(), *names.keys.items()) if slot.group in ("q", "v", "u")}
    if order and (used := sorted(symbols(value) & moving)):
        raise DescriptionError(
            Problem(
                f"system '{kinematics.tree.system.name}': a motion that depends on '{used[0]}'",
                f"'{value}'",
                "the rates of a prescribed motion are found for formulas of t and parameters only",
                "give its speeds and their rates as well",
            )
        )
    edge = kinematics.lowering.value(value)
    for _ in range(order):
        edge = directional(g, [edge], {g.input("t", 0): ONE})[0]
    return edge
