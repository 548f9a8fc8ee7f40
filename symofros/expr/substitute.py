"""Replace inputs of some edges by other edges; everything else is built again and folds anew."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.evaluate import needed_nodes
from symofros.expr.graph import Graph
from symofros.expr.pack import WIDTH, Pack, Signed
from symofros.expr.packs import combined


def substitute(graph: Graph, edges: Sequence[Edge], replacement: Mapping[Edge, Edge]) -> list[Edge]:
    """The edges with some inputs replaced.

    Args:
        graph: Graph of all edges.
        edges: Edges to rewrite.
        replacement: New edge of an input, keyed by the input's edge.
    """
    new: dict[int, Edge] = dict(replacement)
    for node in needed_nodes(graph, edges):
        args = [_at(new, arg) for arg in graph.args[node]]
        if args != list(graph.args[node]):
            new[node] = graph.apply(graph.op[node], *args)
    return [_at(new, edge) for edge in edges]


def transplant(graph: Graph, edges: Sequence[Edge], replacement: Mapping[Edge, Edge], into: Graph) -> list[Edge]:
    """The edges in another graph.

    Args:
        graph: Graph of the edges.
        edges: Edges to build again.
        replacement: Edge in the other graph of each input that they depend on, keyed by the input's edge.
        into: The other graph; labels come along, and packs as far as their lanes do.

    Raises:
        KeyError: An input has no replacement.
    """
    new: dict[int, Edge] = {0: 0, **replacement}
    nodes = needed_nodes(graph, edges)
    leaves = {abs(arg) for node in nodes for arg in graph.args[node]} | set(map(abs, edges))
    for node in leaves & graph.value.keys():
        new[node] = into.constant(graph.value[node])
    packs = _Packs(graph, nodes, new, into)
    for node in nodes:
        packs.form(node)
        if node not in new:
            new[node] = into.apply(graph.op[node], *(carried(new, arg) for arg in graph.args[node]))
        if node in graph.label:
            into.name(new[node], graph.label[node])
    return [carried(new, edge) for edge in edges]


class _Packs:
    """The packs of a graph on their way into another, each formed when its operands are there and its lanes are not.

    Args:
        graph: Where they live.
        nodes: Nodes to carry over.
        new: Node -> edge in the other graph, as far as it is there.
        into: The other graph.
    """

    def __init__(self, graph: Graph, nodes: Sequence[int], new: dict[int, Edge], into: Graph) -> None:
        self._new, self._into = new, into
        wanted = set(nodes)
        lanes = {id(pack): [lane for lane in pack.own if abs(pack.lanes[lane]) in wanted] for pack in graph.packs}
        self._waiting = [(pack, lanes[id(pack)]) for pack in reversed(graph.packs) if len(lanes[id(pack)]) > 1]
        self._moved: dict[int, tuple[Edge, Pack]] = {}

    def form(self, node: int) -> None:
        """Form the packs whose operands are older than a node."""
        while self._waiting and self._waiting[-1][0].start <= node:
            pack, lanes = self._waiting.pop()
            factors = [factor for factor, _ in pack.terms]
            if any(abs(pack.lanes[lane]) in self._new for lane in lanes):
                continue
            if all(abs(factor) in self._new or abs(factor) == ONE for factor in factors):
                self._combine(pack, lanes)

    def _combine(self, pack: Pack, lanes: Sequence[int]) -> None:
        new = self._new | {ONE: ONE}
        terms = [(carried(new, factor), self._operand(term, lanes)) for factor, term in pack.terms]
        if any(term is None for _, term in terms):
            return
        found = combined(self._into, [(f, t) for f, t in terms if t is not None], lanes, pack.least)
        self._moved[id(pack)] = found
        sign, formed = found
        for lane in lanes:
            edge, source = self._into.mul(sign, formed.lanes[lane]), pack.lanes[lane]
            self._new[abs(source)] = edge if source > 0 else -edge

    def _operand(self, pack: Pack, lanes: Sequence[int]) -> Signed | None:
        """A pack in the other graph, formed or given; None where a lane is not there."""
        new = self._new | {ONE: ONE}
        if any(abs(pack.lanes[lane]) not in new for lane in lanes):
            return None
        edges = {lane: carried(new, pack.lanes[lane]) for lane in lanes}
        sign, formed = self._moved.get(id(pack), (ONE, None))
        if formed is not None and all(self._into.mul(sign, formed.lanes[lane]) == edges[lane] for lane in lanes):
            return sign, formed
        _, base = self._moved.get(id(pack.base), (ONE, None))
        return ONE, Pack(tuple(edges.get(lane, ZERO) for lane in range(WIDTH)), base=base)


def _at(new: Mapping[int, Edge], edge: Edge) -> Edge:
    found = new.get(abs(edge), abs(edge))
    return found if edge > 0 else -found


def carried(new: Mapping[int, Edge], edge: Edge) -> Edge:
    """An edge over there, of a node that is there: what its node became, with its sign."""
    return new[edge] if edge >= 0 else -new[-edge]
