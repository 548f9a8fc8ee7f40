"""Instants at which steps of a run end, from the formulas of a description and of a user's laws."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from symofros.base.names import TIME
from symofros.description.values import Value, symbols
from symofros.expr.graph import Graph
from symofros.expr.instants import instant_operands
from symofros.expr.program import Program
from symofros.generator.codegen.interpreted import formula_instants
from symofros.mechanics.dynamics.formulas import stated_formulas
from symofros.mechanics.kinematics.lowering import Lowering
from symofros.mechanics.topology.formulas import timed_values
from symofros.mechanics.topology.tree import SpanningTree
from symofros.runtime.calls.kernel import Array
from symofros.runtime.functions import Rate

# Spans whose instants are kept.
_KEPT = 64


def has_instants(tree: SpanningTree) -> bool:
    """Whether formulas of time of a description bend, jump or change fast at instants."""
    lowering = Lowering(Graph(), tree.coordinates)
    return bool(instant_operands(lowering.g, [lowering.value(value) for value in timed_values(tree.system)]))


def instants_at(tree: SpanningTree) -> Callable[[Sequence[Any], Array, float, float], Array]:
    """Function of laws, parameters (npar), start and end: the instants of a mechanism's formulas of time in a run."""
    own = timed_values(tree.system)

    @lru_cache(maxsize=_KEPT)
    def instants(values: tuple[Value, ...], par: tuple[float, ...], t0: float, t_end: float) -> Array:
        lowering = Lowering(Graph(), tree.coordinates)
        edges = [lowering.value(value) for value in values]
        return formula_instants(Program(tree.system.name, lowering.g, {}, ()), edges, np.array(par), t0, t_end)

    def of_run(formulas: Sequence[Any], par: Array, t0: float, t_end: float) -> Array:
        given = [item.formula if isinstance(item, Rate) else item for item in formulas]
        values = (*own, *(value for value in stated_formulas(tree, given) if TIME in symbols(value)))
        return instants(values, tuple(par.tolist()), t0, t_end) if values else np.zeros(0)

    return of_run
