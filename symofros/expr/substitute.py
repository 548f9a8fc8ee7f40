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
    for node in needed_nodes(graph, edges):
        args = [_at(new, arg) for arg in graph.args[node]]
        if args != list(graph.args[node]):
            new[node] = _build(graph, graph.op[node], args)
    return [_at(new, edge) for edge in edges]


def transplant(graph: Graph, edges: Sequence[Edge], replacement: Mapping[Edge, Edge], into: Graph) -> list[Edge]:
    """The edges in another graph.

    Args:
        graph: Where they live.
        edges: What to build again.
        replacement: Edge in the other graph of each input that they depend on, keyed by the input's edge.
        into: The other graph; labels come along.

    Raises:
        KeyError: An input has no replacement.
    """
    new: dict[int, Edge] = {0: 0, **replacement}
    nodes = needed_nodes(graph, edges)
    leaves = {abs(arg) for node in nodes for arg in graph.args[node]} | set(map(abs, edges))
    for node in leaves & graph.value.keys():
        new[node] = into.constant(graph.value[node])
    for node in nodes:
        new[node] = _build(into, graph.op[node], [_known(new, arg) for arg in graph.args[node]])
        if node in graph.label:
            into.name(new[node], graph.label[node])
    return [_known(new, edge) for edge in edges]


def _at(new: Mapping[int, Edge], edge: Edge) -> Edge:
    found = new.get(abs(edge), abs(edge))
    return found if edge > 0 else -found


def _known(new: Mapping[int, Edge], edge: Edge) -> Edge:
    return new[edge] if edge >= 0 else -new[-edge]


def _build(graph: Graph, op: str, args: Sequence[Edge]) -> Edge:
    arithmetic = {ADD: graph.add, MUL: graph.mul, DIV: graph.div}
    return arithmetic[op](*args) if op in arithmetic else graph.call(op, *args)
