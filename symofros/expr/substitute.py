"""Edges built again: with some inputs replaced, in the same graph or in another; all operations fold anew."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import needed_nodes
from symofros.expr.packs.carry import carry_packs, mapped_edge


def substitute(graph: Graph, edges: Sequence[Edge], replacement: Mapping[Edge, Edge]) -> list[Edge]:
    """The edges with some inputs replaced.

    Args:
        graph: Graph of all edges.
        edges: Edges to rewrite.
        replacement: New edge of an input, keyed by the input's edge.
    """
    new: dict[int, Edge] = dict(replacement)
    for node in needed_nodes(graph, edges):
        args = [_replaced(new, arg) for arg in graph.args[node]]
        if args != list(graph.args[node]):
            new[node] = graph.apply(graph.op[node], *args)
    return [_replaced(new, edge) for edge in edges]


def _replaced(new: Mapping[int, Edge], edge: Edge) -> Edge:
    replacement = new.get(abs(edge), abs(edge))
    return replacement if edge > 0 else -replacement


def copy_into(into: Graph, graph: Graph, edges: Sequence[Edge], replacement: Mapping[Edge, Edge]) -> list[Edge]:
    """The edges in another graph, with their labels and packs.

    Args:
        into: The other graph.
        graph: Graph of the edges.
        edges: Edges to build again.
        replacement: Edge in the other graph of each input on which the edges depend, keyed by the input's edge.

    Raises:
        KeyError: An input has no replacement.
    """
    new: dict[int, Edge] = {ZERO: ZERO, ONE: ONE, **replacement}
    nodes = needed_nodes(graph, edges)
    leaves = {abs(arg) for node in nodes for arg in graph.args[node]} | set(map(abs, edges))
    for node in leaves & graph.value.keys():
        new[node] = into.constant(graph.value[node])
    sizes: dict[int, int] = {}
    for node in nodes:
        sizes[node] = len(into)
        new[node] = into.apply(graph.op[node], *(mapped_edge(new, arg) for arg in graph.args[node]))
        if node in graph.label:
            into.name(new[node], graph.label[node])
    carry_packs(graph.packs, into, new, sizes)
    return [mapped_edge(new, edge) for edge in edges]
