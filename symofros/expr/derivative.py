"""Derivatives on the graph, by the op table's rules: exact, shared, never expanded."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from symofros.expr.evaluate import needed_nodes
from symofros.expr.graph import ZERO, Edge, Graph
from symofros.expr.ops import OPS


def directional(graph: Graph, edges: Sequence[Edge], seeds: Mapping[Edge, Edge]) -> list[Edge]:
    """The derivative of some edges along a direction (forward mode).

    Args:
        graph: Where the edges live and the derivatives go.
        edges: What to differentiate.
        seeds: Rate of each varying input, keyed by the input's edge; all other inputs are constant.

    Returns:
        One edge for each of `edges`.
    """
    tangent: dict[int, Edge] = dict(seeds)

    def rate(edge: Edge) -> Edge:
        found = tangent.get(abs(edge), ZERO)
        return found if edge > 0 else -found

    for node in needed_nodes(graph, edges):
        args = graph.args[node]
        total = ZERO
        for i, arg in enumerate(args):
            moving = rate(arg)
            if moving != ZERO:
                partial = OPS[graph.op[node]].derivative(graph, args, node, i)
                total = graph.add(total, graph.mul(partial, moving))
        if total != ZERO:
            tangent[node] = total
    return [rate(edge) for edge in edges]


def partials(graph: Graph, edges: Sequence[Edge], inputs: Sequence[Edge]) -> list[list[Edge]]:
    """The Jacobian of some edges: one row an edge, one column an input."""
    columns = [directional(graph, edges, {x: 1}) for x in inputs]
    return [list(row) for row in zip(*columns, strict=True)] if columns else [[] for _ in edges]
