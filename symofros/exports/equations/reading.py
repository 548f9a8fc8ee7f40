"""Edges of the graph -> harmonic sums over atoms: inputs, and functions other than sines, cosines and arithmetic."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from symofros.exports.equations.harmonics import (
    Harmonics,
    added,
    atom,
    frozen,
    inverted,
    multiplied,
    negated,
    number,
    wave,
)
from symofros.expr import ADD, DIV, MUL, STOP_GRADIENT, Edge, Graph, Slot, needed_nodes


@dataclass(frozen=True)
class Call:
    """A function of sums; "div" is the inverse of its only operand."""

    name: str
    operands: tuple[Harmonics, ...]


class Reader:
    """Harmonic sums of a graph's edges.

    Attributes:
        atoms: Meaning of each atom by its index: an input, or a function.

    Args:
        graph: The graph.
        most: Products of terms that one product of sums may take.
    """

    def __init__(self, graph: Graph, most: int) -> None:
        self.atoms: list[Slot | Call] = []
        self._graph, self._most = graph, most
        self._index: dict[object, int] = {}
        self._sums: dict[int, Harmonics] = {}

    def sums(self, edges: Sequence[Edge]) -> list[Harmonics]:
        """The sum of each edge.

        Raises:
            TooManyTermsError: A sum is longer than a person reads.
        """
        graph = self._graph
        for node in needed_nodes(graph, edges, self._sums):
            self._sums[node] = self._operation(graph.op[node], [self._of(edge) for edge in graph.args[node]])
        return [self._of(edge) for edge in edges]

    def _of(self, edge: Edge) -> Harmonics:
        node = abs(edge)
        value = self._graph.number(node)
        if value is not None:
            total = number(value)
        elif node in self._graph.slot:
            total = self._atom(self._graph.slot[node], self._graph.slot[node])
        else:
            total = self._sums[node]
        return negated(total) if edge < 0 else total

    def _atom(self, key: object, meaning: Slot | Call) -> Harmonics:
        index = self._index.setdefault(key, len(self.atoms))
        if index == len(self.atoms):
            self.atoms.append(meaning)
        return atom(index)

    def _call(self, name: str, *operands: Harmonics) -> Harmonics:
        return self._atom((name, *map(frozen, operands)), Call(name, operands))

    def _operation(self, op: str, operands: list[Harmonics]) -> Harmonics:
        if op == ADD:
            return added(*operands)
        if op == MUL:
            return multiplied(operands[0], operands[1], self._most)
        if op == STOP_GRADIENT:
            return operands[0]
        if op == DIV:
            divisor = inverted(operands[1])
            return multiplied(operands[0], self._call(DIV, operands[1]) if divisor is None else divisor, self._most)
        if op in ("sin", "cos"):
            waves = wave(operands[0], op == "sin")
            if waves is not None:
                return waves
        return self._call(op, *operands)
