"""Events of a description: their formulas and what their actions set are names of the mechanism."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import replace

from symofros.base.events import Event, Named
from symofros.base.names import name_of
from symofros.description.system import System
from symofros.errors import DescriptionError, Problem, SymofrosError, first_of
from symofros.mechanics.topology.graph import description_problems
from symofros.mechanics.topology.switches import offset_names, rotation_names, switches_of
from symofros.mechanics.topology.tree import SpanningTree, build_tree
from symofros.mechanics.topology.user_formulas import stated_formulas


def find_problems(system: System, broken: Collection[str] = ()) -> list[Problem]:
    """Every problem of a description; those of events once there are no others.

    Args:
        system: The system as described.
        broken: Names of what could not be read, as of `description_problems`.
    """
    problems = description_problems(system, broken)
    return problems if problems or broken or not system.events else first_of(event_problems(build_tree(system)))


def tree_with_events(system: System) -> SpanningTree:
    """The tree of a system, whose events are checked too.

    Raises:
        DescriptionError: With every problem found.
    """
    tree = build_tree(system)
    if problems := first_of(event_problems(tree)):
        raise DescriptionError(problems)
    return tree


def event_problems(tree: SpanningTree) -> Iterator[Problem]:
    """Events that use names which the mechanism lacks, or set what no action may."""
    for name, event in tree.system.events.items():
        where = tree.system.origin.get(("event", name), "")
        yield from (replace(one, where=where) for one in (*_formulas(tree, event), *_targets(tree, event)))


def _formulas(tree: SpanningTree, event: Event) -> Iterator[Problem]:
    what = f"event '{event.name}'"
    stated = [(what, event.formula, True)] + [(f"{what}: rests", event.rests, True)] * (event.rests is not None)
    of_action = f"{what}, what its action sets"
    stated += [(f"{of_action} '{to}' to", value, False) for to, value in (event.action or {}).items()]
    for of, formula, reactions in stated:
        try:
            stated_formulas(tree, [formula], reactions, of)
        except SymofrosError as error:
            yield from error.problems


def _targets(tree: SpanningTree, event: Event) -> Iterator[Problem]:
    action, constants = event.action or {}, tree.coordinates.constants
    for name in (to for to in action if name_of(to) in constants):
        what, rule = f"event '{event.name}': its action sets the constant '{name}'", "constants are hard-coded in C"
        yield Problem(what, "constant: true", rule, "leave 'constant' out of the parameter's entries")
    try:
        _set_by_actions(tree).targets(event.name, [to for to in action if name_of(to) not in constants])
    except SymofrosError as error:
        yield from error.problems


def _set_by_actions(tree: SpanningTree) -> Named:
    """What actions may name."""
    names, switches = tree.coordinates, switches_of(tree.system)
    held = {
        names.par.index(place): (item.name, str(switches[item.name].engaged))
        for item in tree.system.constraints
        if item.name in switches and switches[item.name].pose == "moment"
        for place in (*offset_names(item).values(), *rotation_names(item))
    }
    return Named(names.par, names.q, names.v, held)
