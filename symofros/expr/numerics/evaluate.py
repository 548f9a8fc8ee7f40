"""The NumPy interpreter of a Program: slow, simple, and the reference that C must match bit for bit."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from symofros.expr.edges import Edge
from symofros.expr.graph import Graph, Slot
from symofros.expr.ops import OPS, Array
from symofros.expr.program import Function, Program


def needed_nodes(graph: Graph, edges: Sequence[Edge], given: Collection[int] = (), but: str = "") -> list[int]:
    """Nodes to evaluate for some edges, operands first; inputs, numbers and given nodes are left out."""
    op, args, nodes = graph.op, graph.args, []
    needed = {abs(edge) for edge in edges}
    marks = bytearray(len(args))
    for node in needed:
        marks[node] = 1
    # Operands that have operands have smaller numbers than results, so one way down meets all, in order.
    node = marks.rfind(1)
    while node > 0:
        if args[node] and node not in given and op[node] != but:  # Inputs and numbers have no operands.
            nodes.append(node)
            for arg in args[node]:
                marks[arg if arg > 0 else -arg] = 1
        node = marks.rfind(1, 0, node)
    nodes.reverse()
    return nodes


class Evaluation:
    """Some edges of a program, for inputs that change: which nodes they need, in which order, is found once."""

    def __init__(self, program: Program, edges: Sequence[Edge], given: Mapping[int, Slot]) -> None:
        """Prepare the values of some edges.

        Args:
            program: Program whose graph is evaluated.
            edges: Edges to evaluate.
            given: Nodes to read from an input group instead of computing them.
        """
        graph = program.graph
        nodes = needed_nodes(graph, edges, given.keys())
        self._edges = edges
        self._steps = [(node, OPS[graph.op[node]].rule, graph.args[node]) for node in nodes]
        read = {abs(edge) for edge in edges} | {abs(edge) for _, _, args in self._steps for edge in args}
        read.difference_update(nodes)
        self._numbers: dict[int, Array | float] = {0: 0.0}
        self._numbers |= {node: graph.value[node] for node in read if node in graph.value}
        self._slots = {node: given.get(node) or graph.slot[node] for node in read.difference(self._numbers)}

    def __call__(self, inputs: Mapping[str, Array]) -> list[Array | float]:
        """The values of the edges, each (n,) or a number; inputs are (n or 1, size), by group."""
        values = dict(self._numbers)
        for node, slot in self._slots.items():
            values[node] = inputs[slot.group][:, slot.index]
        with np.errstate(all="ignore"):
            for node, rule, args in self._steps:
                values[node] = rule(*[values[edge] if edge >= 0 else -values[-edge] for edge in args])
        return [values[edge] if edge >= 0 else -values[-edge] for edge in self._edges]


class FunctionEvaluation:
    """One function of a program, staged or not, evaluated over batches."""

    def __init__(self, program: Program, function: Function) -> None:
        self._outputs = function.outputs
        edges = [edge for output in function.outputs for edge in output.edges]
        self._evaluation = Evaluation(program, edges, program.pre)

    def __call__(self, inputs: Mapping[str, Array], n: int) -> list[Array]:
        """One array an output, (n, *shape), for n states; inputs are (n or 1, size), by group."""
        columns = self._evaluation(inputs)
        results, first = [], 0
        for output in self._outputs:
            size = len(output.edges)
            flat = np.empty((n, size))
            for i in range(size):
                flat[:, i] = columns[first + i]
            first += size
            results.append(flat.reshape(n, *output.shape))
        return results


def interpret(program: Program, function: Function, inputs: Mapping[str, Array], n: int) -> list[Array]:
    """Evaluate one function once, as `FunctionEvaluation` does."""
    return FunctionEvaluation(program, function)(inputs, n)


def evaluate_edges(
    program: Program, edges: Sequence[Edge], inputs: Mapping[str, Array], given: Mapping[int, Slot]
) -> list[Array | float]:
    """The values of some edges once, as `Evaluation` gives them."""
    return Evaluation(program, edges, given)(inputs)
