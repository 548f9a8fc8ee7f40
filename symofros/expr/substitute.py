"""Replace inputs of some edges by other edges; everything else is built again and folds anew."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from symofros.expr.evaluate import needed_nodes
from symofros.expr.graph import Edge, Graph
from symofros.expr.ops import ADD, DIV, MUL


def substitute(graph: Graph, edges: Sequence[Edge], replacement: Mapping[Edge, Edge]) -> list[Edge]:
    """The edges with some inputs replaced.

    Args:
        graph: Where all of it lives.
        edges: What to rewrite.
        replacement: New edge of an input, keyed by the input's edge.
    """
    new: dict[int, Edge] = dict(replacement)

    def at(edge: Edge) -> Edge:
        found = new.get(abs(edge), abs(edge))
        return found if edge > 0 else -found

    build = {ADD: graph.add, MUL: graph.mul, DIV: graph.div}
    for node in needed_nodes(graph, edges):
        op, args = graph.op[node], [at(arg) for arg in graph.args[node]]
        if args != list(graph.args[node]):
            new[node] = build[op](*args) if op in build else graph.call(op, *args)
    return [at(edge) for edge in edges]
