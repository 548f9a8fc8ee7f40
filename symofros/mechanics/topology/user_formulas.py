"""Formulas of the user's own over the names of a mechanism: laws, events.

Those of events may use multipliers, wrenches of constraints and reactions of joints by the names of
`mechanics/dynamics/formulas.py`.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any

from symofros.base.names import symbol_of
from symofros.description.constraints import acts_on_bodies
from symofros.description.quoting import quotes_remedy, unknown_symbol_remedy, with_quotes
from symofros.description.values import Value, as_value, symbols
from symofros.errors import DescriptionError, Problem, UnknownNameError
from symofros.expr.expression import Expression
from symofros.mechanics.topology.formulas import meaning_problems
from symofros.mechanics.topology.rigid_contacts import QUANTITIES
from symofros.mechanics.topology.tree import SpanningTree, ball_names, joint_names

COMPONENTS = ("fx", "fy", "fz", "mx", "my", "mz")


def reaction_symbols(tree: SpanningTree) -> frozenset[str]:
    """All names of multipliers, wrenches and reactions of a mechanism."""
    constraints = tree.system.constraints
    multipliers = (f"lam.{condition}" for constraint in constraints for condition in constraint.conditions)
    names = (*_six("wrench", acts_on_bodies(constraints)), *_six("reaction", joint_names(tree)))
    return frozenset((*multipliers, *names))


def contact_symbols(tree: SpanningTree) -> frozenset[str]:
    """All names of distances and velocities of the balls of contacts."""
    return frozenset(f"contact.{ball}.{quantity}" for ball in ball_names(tree) for quantity in QUANTITIES)


def _six(group: str, names: Iterable[str]) -> Iterator[str]:
    return (f"{group}.{name}.{component}" for name in names for component in COMPONENTS)


def stated_formulas(
    tree: SpanningTree, formulas: Sequence[Any], reactions: bool = False, what: str = ""
) -> list[Value]:
    """A user's formulas over the names of a mechanism: laws, events.

    Args:
        tree: Its names are what they may use.
        formulas: Numbers, texts, SymPy expressions.
        reactions: Whether they may use multipliers, wrenches and reactions.
        what: The object that they belong to, for messages; the system by default.

    Raises:
        UnknownNameError: A formula uses a name that the mechanism lacks.
        DescriptionError: A text is no formula, or can be read in two ways.
    """
    if not formulas:
        return []
    names = tree.coordinates
    what = what or f"system '{tree.system.name}'"
    own = frozenset({*names.symbols, *names.keys, *names.constants})
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
            f"{what}: unknown symbol '{name}'",
            f"'{written}'",
            "a formula uses coordinates, speeds (d and the coordinate's name), inputs, parameters and t",
            unknown_symbol_remedy(name, written, known) or "see model.names",
        )
    for problem in meaning_problems(what, value, known, both):
        raise DescriptionError(problem)
    return value
