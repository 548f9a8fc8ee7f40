"""The NumPy interpreter of a Program: slow, simple, and the reference that C must match bit for bit."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from symofros.expr.edges import Edge
from symofros.expr.graph import Graph, Slot
from symofros.expr.ops import OPS, Array
from symofros.expr.program import Function, Program


def needed_nodes(graph: Graph, edges: Sequence[Edge], given: Collection[int] = ()) -> list[int]:
    """The nodes that must be computed for some edges, operands first; what no edge needs is left out.

    Args:
        graph: The graph.
        edges: Edges to evaluate.
        given: Nodes whose values are available.
    """
    args = graph.args
    seen = {abs(edge) for edge in edges}
    stack = list(seen.difference(given))
    while stack:
        for arg in args[stack.pop()]:
            node = abs(arg)
            if node not in seen:
                seen.add(node)
                if node not in given:
                    stack.append(node)
    return sorted(node for node in seen.difference(given) if args[node])  # Inputs and numbers have no operands.


def interpret(program: Program, function: Function, inputs: Mapping[str, Array], n: int) -> list[Array]:
    """Evaluate one function over a batch.

    Args:
        program: Staged or not.
        function: One of its functions.
        inputs: Each group as (n or 1, size).
        n: Number of states.

    Returns:
        One array an output, (n, *shape).
    """
    edges = [edge for output in function.outputs for edge in output.edges]
    columns = evaluate_edges(program, edges, inputs, program.pre)
    results, first = [], 0
    for output in function.outputs:
        size = len(output.edges)
        flat = np.empty((n, size))
        for i in range(size):
            flat[:, i] = columns[first + i]
        first += size
        results.append(flat.reshape(n, *output.shape))
    return results


def evaluate_edges(
    program: Program, edges: Sequence[Edge], inputs: Mapping[str, Array], given: Mapping[int, Slot]
) -> list[Array | float]:
    """The values of some edges, each (n,) or a number.

    Args:
        program: Program whose graph is evaluated.
        edges: Edges to evaluate.
        inputs: Each group as (n or 1, size).
        given: Nodes to read from an input group instead of computing them.
    """
    graph = program.graph
    values: dict[int, Array | float] = dict(graph.value)

    def value(edge: Edge) -> Array | float:
        node = abs(edge)
        if node == 0:
            return 0.0
        if node not in values:
            slot = given.get(node) or graph.slot[node]
            values[node] = inputs[slot.group][:, slot.index]
        return values[node] if edge > 0 else -values[node]

    for node in needed_nodes(graph, edges, given.keys()):
        values[node] = OPS[graph.op[node]].rule(*map(value, graph.args[node]))
    return [value(edge) for edge in edges]
