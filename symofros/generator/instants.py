"""Instants at which steps of a run end, from the formulas of a description and of a user's laws."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from symofros.base.names import TIME
from symofros.description.values import Value, symbols
from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.expr.instants import instant_operands, operands_function
from symofros.expr.numerics.evaluate import Evaluation
from symofros.expr.program import Program
from symofros.mechanics.dynamics.formulas import stated_formulas
from symofros.mechanics.kinematics.lowering import Lowering
from symofros.mechanics.topology.formulas import timed_values
from symofros.mechanics.topology.tree import SpanningTree
from symofros.runtime.calls.kernel import Array
from symofros.runtime.functions import Rate
from symofros.runtime.instants import find_instants

# Function of models that gives operands of formulas of time; row of base/functions.py.
OPERANDS = "instant_operands"
# Spans whose instants are kept.
_KEPT = 64


def formula_instants(program: Program, edges: Sequence[Edge], par: Array, t0: float, t_end: float) -> Array:
    """Instants within a span at which formulas of time bend, jump or change fast.

    Args:
        program: Program whose graph holds the formulas.
        edges: Their edges.
        par: Run-time parameters (npar).
        t0: Start of the span [s].
        t_end: End of the span [s].

    Returns:
        Instants in order, between t0 and t_end (n) [s].
    """
    operands = instant_operands(program.graph, edges)
    if not operands or not t_end > t0:
        return np.zeros(0)
    evaluations = [Evaluation(program, [operand.edge], {}) for operand in operands]

    def values(operand: int, t: Array) -> Array:
        return np.broadcast_to(evaluations[operand]({"t": t[:, np.newaxis], "par": par[np.newaxis]})[0], t.shape)

    return find_instants([operand.kind for operand in operands], values, t0, t_end)


def with_instants(program: Program) -> Program:
    """A program, and what packages ask for the instants of the formulas of time in its functions, if they have any.

    Args:
        program: Functions, not staged yet.
    """
    edges = [edge for function in program.functions for edge in function.edges()]
    function = operands_function(OPERANDS, program.graph, edges)
    return replace(program, functions=(*program.functions, function)) if function.outputs[0].edges else program


def has_instants(tree: SpanningTree) -> bool:
    """Whether formulas of time of a description bend, jump or change fast at instants."""
    lowering = Lowering(Graph(), tree.coordinates)
    return bool(instant_operands(lowering.g, [lowering.value(value) for value in timed_values(tree.system)]))


def instants_at(tree: SpanningTree) -> Callable[[Sequence[Any], Array, float, float], Array]:
    """What gives the instants of a mechanism's formulas of time: of laws, parameters (npar), start and end of a run."""
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
