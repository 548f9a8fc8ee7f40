"""Formulas of the user's own over a mechanism's coordinates, speeds, inputs, parameters and time -> a Program."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from symofros.base.names import symbol_of
from symofros.description.quoting import quotes_remedy, unknown_symbol_remedy, with_quotes
from symofros.description.values import Value, as_value, symbols
from symofros.errors import DescriptionError, Problem, UnknownNameError
from symofros.expr.derivative import directional
from symofros.expr.edges import ONE, Edge
from symofros.expr.expression import Expression
from symofros.expr.program import Function, Output, Program
from symofros.mechanics.dynamics.derivatives.differentiation import by_configuration, by_inputs
from symofros.mechanics.dynamics.equations import Equations
from symofros.mechanics.dynamics.reactions import bind_contacts, bind_reactions, contact_symbols, reaction_symbols
from symofros.mechanics.kinematics.links import TreeKinematics
from symofros.mechanics.topology.formulas import meaning_problems
from symofros.mechanics.topology.tree import SpanningTree


def stated_formulas(tree: SpanningTree, formulas: Sequence[Any], reactions: bool = False) -> list[Value]:
    """A user's formulas over the names of a mechanism: laws, events.

    Args:
        tree: Its names are what they may use.
        formulas: Numbers, texts, SymPy expressions.
        reactions: Whether they may use multipliers, wrenches and reactions.

    Raises:
        UnknownNameError: A formula uses a name that the mechanism lacks.
        DescriptionError: A text is no formula, or can be read in two ways.
    """
    names = tree.coordinates
    what, own = f"system '{tree.system.name}'", frozenset({*names.symbols, *names.keys, *names.constants})
    both = frozenset(map(symbol_of, names.q)) & frozenset(names.speed_symbols)
    forces, known = reaction_symbols(tree) - own, own | contact_symbols(tree)
    stated = [_stated(what, formula, known | forces, both) for formula in formulas]
    for value in () if reactions else stated:
        for name in sorted(symbols(value) & forces):
            raise UnknownNameError(_follows(what, name, value))
    return stated


def _follows(what: str, name: str, value: Value) -> Problem:
    return Problem(
        f"{what}: '{name}' may not be used here",
        f"'{value}'",
        "multipliers, wrenches and reactions follow from the motion, which this formula changes",
        "use them in the condition of an event of `simulate`, whose action changes a parameter",
    )


def _stated(what: str, formula: Any, known: frozenset[str], both: frozenset[str]) -> Value:
    try:
        value = as_value(formula, f"{what}: formula")
    except DescriptionError as error:
        meant = with_quotes(formula, known) if isinstance(formula, str) else ""
        if not meant:
            raise
        raise DescriptionError(replace(error.problem, remedy=quotes_remedy(meant))) from None
    written = value.written or str(value) if isinstance(value, Expression) else ""
    for name in sorted(symbols(value) - known):
        raise UnknownNameError(
            Problem(
                f"{what}: unknown symbol '{name}'",
                f"'{written}'",
                "a formula uses coordinates, speeds (d and the coordinate's name), inputs, parameters and t",
                unknown_symbol_remedy(name, written, known) or "see model.names",
            )
        )
    for problem in meaning_problems(what, value, known, both):
        raise DescriptionError(problem)
    return value


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
