"""Instants at which steps of a run end, from the formulas of a description and of a user's laws."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache, lru_cache
from typing import Any

import numpy as np

from symofros.base.names import TIME
from symofros.description.values import Value, symbols
from symofros.expr.graph import Graph
from symofros.expr.instants import instant_operands
from symofros.expr.program import Program
from symofros.generator.codegen.interpreted import FormulaInstants
from symofros.mechanics.dynamics.formulas import stated_formulas
from symofros.mechanics.kinematics.lowering import Lowering
from symofros.mechanics.topology.formulas import stated_values, timed_values
from symofros.mechanics.topology.tree import SpanningTree
from symofros.runtime.calls.kernel import Array
from symofros.runtime.functions import Rate
from symofros.runtime.instants import Instants, Motion

# Spans whose instants are kept, and formulas.
_KEPT = 64


def has_instants(tree: SpanningTree) -> bool:
    """Whether formulas of time of a description bend, jump or change fast at instants."""
    lowering = Lowering(Graph(), tree.coordinates)
    return bool(instant_operands(lowering.g, [lowering.value(value) for value in timed_values(tree.system)]))


def instants_at(tree: SpanningTree) -> Instants:
    """The instants of a mechanism's formulas of time in a run, or of all along its motion: as of `Instants`."""
    own = timed_values(tree.system)
    slots = {**tree.coordinates.symbols, **tree.coordinates.keys}
    known, moving = {*slots, *tree.coordinates.constants}, {name for name, slot in slots.items() if slot.group != "par"}

    @lru_cache(maxsize=_KEPT)
    def search(values: tuple[Value, ...], of_states: bool) -> FormulaInstants:
        lowering = Lowering(Graph(), tree.coordinates)
        edges = [lowering.value(value) for value in values]
        return FormulaInstants(Program(tree.system.name, lowering.g, {}, ()), edges, of_states)

    @lru_cache(maxsize=_KEPT)
    def instants(values: tuple[Value, ...], par: tuple[float, ...], t0: float, t_end: float) -> Array:
        return search(values, False)(np.array(par), t0, t_end)

    @cache
    def all_own() -> tuple[Value, ...]:
        values = (stated.value for stated in stated_values(tree.system))
        return tuple(value for value in values if symbols(value) & moving and symbols(value) <= known)

    def of_run(formulas: Sequence[Any], par: Array, t0: float, t_end: float, motion: Motion | None = None) -> Array:
        given = [item.formula if isinstance(item, Rate) else item for item in formulas]
        stated = stated_formulas(tree, given)
        if motion is not None:
            return search((*all_own(), *stated), True)(par, t0, t_end, motion)
        values = (*own, *(value for value in stated if TIME in symbols(value)))
        return instants(values, tuple(par.tolist()), t0, t_end) if values else np.zeros(0)

    return of_run
