"""Packs follow their nodes into another graph: the only way to copy them."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Mapping
from dataclasses import replace

from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.packs.combine import with_exact_lanes
from symofros.expr.packs.pack import EMPTY, WIDTH, Pack, SignedPack


def carry_packs(packs: Iterable[Pack], into: Graph, new: Mapping[int, Edge], sizes: Mapping[int, int]) -> None:
    """Record packs of one graph in another, to which their nodes have been copied.

    Lanes that were not copied are empty. Exact and new lanes are determined again in the other graph, which may have
    folded some, or have had them before.

    Args:
        packs: Packs of the first graph.
        into: The other graph; receives the packs with two new lanes at least.
        new: Edge in the other graph of each copied node; zero and one are among them.
        sizes: Number of nodes in the other graph before each node was copied, keyed by node in ascending order.
    """
    carrier = _Carrier(into, new, sizes)
    for pack in packs:
        _, copy = carrier.carry(pack)
        if len(copy.new_lanes) > 1 and copy not in carrier.recorded:
            carrier.recorded[copy] = None
    into.packs += carrier.recorded


class _Carrier:
    """Copies of packs.

    Args:
        into: The other graph.
        new: Edge in the other graph of each copied node.
        sizes: Number of nodes in the other graph before each node was copied.

    Attributes:
        recorded: Copies to be recorded, in order.
    """

    def __init__(self, into: Graph, new: Mapping[int, Edge], sizes: Mapping[int, int]) -> None:
        self._into, self._new = into, new
        self._nodes, self._sizes = list(sizes), [*sizes.values(), len(into)]
        self._copies: dict[int, SignedPack] = {id(EMPTY): (ONE, EMPTY)}
        self.recorded: dict[Pack, None] = {}

    def carry(self, pack: Pack) -> SignedPack:
        """The copy of a pack, after those of its operands."""
        stack = [pack]
        while stack:
            operands = [operand for _, operand in stack[-1].terms]
            operands += [stack[-1].base] if stack[-1].base is not None else []
            missing = [operand for operand in operands if id(operand) not in self._copies]
            stack += missing
            if not missing:
                last = stack.pop()
                if id(last) not in self._copies:  # An operand of two packs is on the stack twice.
                    self._copies[id(last)] = self._copy(last)
        return self._copies[id(pack)]

    def _copy(self, pack: Pack) -> SignedPack:
        """The copy of a pack whose operands have copies; an operand itself if it is the only term."""
        lanes = tuple(mapped_edge(self._new, edge) if abs(edge) in self._new else ZERO for edge in pack.lanes)
        base = self._base(pack)
        if not pack.terms or not all(abs(factor) in self._new for factor, _ in pack.terms):
            return ONE, Pack(lanes, base=base)
        terms = tuple(self._term(factor, operand) for factor, operand in pack.terms)
        terms = tuple((factor, operand) for factor, operand in terms if factor != ZERO and any(operand.lanes))
        if len(terms) == 1 and abs(terms[0][0]) == ONE:
            sign, operand = terms[0]
            if lanes == tuple(sign * edge for edge in operand.lanes):
                return terms[0]
        first_node = self._sizes[bisect_left(self._nodes, pack.first_node)]
        copy = replace(pack, lanes=lanes, terms=terms, base=base, first_node=first_node)
        sources = [pack, *(operand for _, operand in pack.terms)]
        copied = [lane for lane in range(WIDTH) if all(abs(source.lanes[lane]) in self._new for source in sources)]
        return ONE, with_exact_lanes(self._into, copy, copied)

    def _term(self, factor: Edge, operand: Pack) -> tuple[Edge, Pack]:
        sign, copy = self._copies[id(operand)]
        return sign * mapped_edge(self._new, factor), copy

    def _base(self, pack: Pack) -> Pack | None:
        """The copy of a pack's base, unless a lane that is zero would then be one that was not copied."""
        if pack.base is None:
            return None
        for edge, base_edge in zip(pack.lanes, pack.base.lanes, strict=True):
            if edge == ZERO and abs(base_edge) not in self._new:
                return None
        sign, copy = self._copies[id(pack.base)]
        return copy if sign == ONE else None


def mapped_edge(new: Mapping[int, Edge], edge: Edge) -> Edge:
    """The edge in another graph of an edge whose node was copied: the node's new edge, with the sign."""
    return new[edge] if edge >= 0 else -new[-edge]
