"""Instants at which steps of a run end, from the formulas of a description and of a user's laws."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache, lru_cache
from typing import Any

import numpy as np

from symofros.base.names import TIME
from symofros.description.values import Value, symbols
from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.expr.instants import instant_operands
from symofros.expr.program import Program
from symofros.generator.codegen.interpreted import FormulaInstants
from symofros.mechanics.dynamics.applied.forces import joint_forces
from symofros.mechanics.kinematics.lowering import Lowering
from symofros.mechanics.topology.formulas import stated_values, timed_values
from symofros.mechanics.topology.tree import SpanningTree
from symofros.mechanics.topology.user_formulas import stated_formulas
from symofros.runtime.calls.kernel import Array
from symofros.runtime.functions import Rate
from symofros.runtime.instants import Motion

# Spans whose instants are kept, and formulas.
_KEPT = 64


def has_instants(tree: SpanningTree) -> bool:
    """Whether formulas of time of a description bend, jump or change fast at instants."""
    lowering = Lowering(Graph(), tree.coordinates)
    return bool(instant_operands(lowering.g, [lowering.value(value) for value in timed_values(tree.system)]))


class MechanismInstants:
    """The instants of a mechanism's formulas of time in a run, or of all along its motion: as of `Instants`.

    Args:
        tree: The mechanism.
    """

    def __init__(self, tree: SpanningTree) -> None:
        self._tree, self._own = tree, tuple(timed_values(tree.system))
        self._search, self._found = lru_cache(maxsize=_KEPT)(self._search_of), lru_cache(maxsize=_KEPT)(self._find)
        self._forces = lru_cache(maxsize=_KEPT)(self._forces_of)
        self._all_own = cache(self._own_of_states)

    def __call__(
        self,
        formulas: Sequence[Any],
        par: Array,
        t0: float,
        t_end: float,
        motion: Motion | None = None,
        *,
        kinks: bool = False,
    ) -> Array:
        """As `Instants`."""
        if motion is not None:
            return self._search((*self._all_own(), *self._stated(formulas)), True)(par, t0, t_end, motion)
        values, counts = self._timed(formulas), self.parameters(formulas)
        if counts is None:
            return np.zeros(0)
        counted = np.zeros_like(par)
        counted[list(counts)] = par[list(counts)]  # Of sets that differ in others alone the instants are known.
        return self._found(values, tuple(counted.tolist()), t0, t_end, kinks)

    def parameters(self, formulas: Sequence[Any]) -> tuple[int, ...] | None:
        """As `Instants`."""
        values = self._timed(formulas)
        return self._search(values, False).parameters if values else None

    def bend(self, formulas: Sequence[Any], par: Array, states: Mapping[str, Array]) -> bool:
        """As `Instants`."""
        return self._forces((*self._all_own(), *self._stated(formulas))).bend(par, states)

    def _stated(self, formulas: Sequence[Any]) -> tuple[Value, ...]:
        given = [item.formula if isinstance(item, Rate) else item for item in formulas]
        return tuple(stated_formulas(self._tree, given))

    def _timed(self, formulas: Sequence[Any]) -> tuple[Value, ...]:
        if not formulas:
            return self._own
        return (*self._own, *(value for value in self._stated(formulas) if TIME in symbols(value)))

    def _search_of(self, values: tuple[Value, ...], of_states: bool) -> FormulaInstants:
        lowering = Lowering(Graph(), self._tree.coordinates)
        return self._operands_of(lowering, [lowering.value(value) for value in values], of_states)

    def _forces_of(self, values: tuple[Value, ...]) -> FormulaInstants:
        lowering = Lowering(Graph(), self._tree.coordinates)
        edges = [*joint_forces(lowering, self._tree), *(lowering.value(value) for value in values)]
        return self._operands_of(lowering, edges, True)

    def _operands_of(self, lowering: Lowering, edges: Sequence[Edge], of_states: bool) -> FormulaInstants:
        return FormulaInstants(Program(self._tree.system.name, lowering.g, {}, ()), edges, of_states)

    def _find(self, values: tuple[Value, ...], par: tuple[float, ...], t0: float, t_end: float, kinks: bool) -> Array:
        return self._search(values, False)(np.array(par), t0, t_end, kinks=kinks)

    def _own_of_states(self) -> tuple[Value, ...]:
        """The mechanism's own formulas, of the state too."""
        coordinates = self._tree.coordinates
        slots = {**coordinates.symbols, **coordinates.keys}
        known, moving = {*slots, *coordinates.constants}, {name for name, slot in slots.items() if slot.group != "par"}
        values = (stated.value for stated in stated_values(self._tree.system))
        return tuple(value for value in values if symbols(value) & moving and symbols(value) <= known)
