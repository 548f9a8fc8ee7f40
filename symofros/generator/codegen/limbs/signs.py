"""Signs by which the lanes of a vector hold their nodes.

Limbs are often mirror images: some of their components are those of the others, some the negatives.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from math import prod
from operator import xor

from symofros.expr.graph import Graph
from symofros.expr.ops import ADD
from symofros.generator.codegen.limbs.counterparts import Row, Rows

Signs = tuple[int, ...]


def products(*rows: Sequence[int]) -> tuple[int, ...]:
    """The products of some rows of signs, or of edges and signs, lane by lane."""
    return tuple(map(prod, zip(*rows, strict=True)))


def choose_signs(graph: Graph, rows: Rows) -> dict[int, Signs]:
    """The signs of all rows, so that both terms of a sum have one sign in all lanes.

    They are sums modulo 2 of unknowns, one for each product with a number, whose sign is free. A sum of nodes equates
    two of them; where that contradicts others, its second term has signs of its own.

    Returns:
        Signs of each row, that of the first lane +1, keyed by its first node.
    """
    width = max((len(row.nodes) for row in rows.by_leader.values()), default=1)
    lanes = [_Parities() for _ in range(1, width)]
    for leader in sorted(rows.by_leader):
        row = rows.by_leader[leader]
        for lane, parities in enumerate(lanes[: len(row.nodes) - 1], 1):
            parities.of[leader] = _parity(graph, rows, row, lane, parities)
    return {
        leader: (1, *(-1 if parities.value(leader) else 1 for parities in lanes[: len(row.nodes) - 1]))
        for leader, row in rows.by_leader.items()
    }


def _parity(graph: Graph, rows: Rows, row: Row, lane: int, parities: _Parities) -> int:
    """The sum that stands for the sign of a lane of a row."""
    known = [
        (parities.of[rows.leader_of[abs(edges[0])]] if rows.has(edges) else 0) ^ ((edges[lane] < 0) != (edges[0] < 0))
        for edges in row.operands
        if not are_numbers(graph, edges)
    ]
    if graph.op[row.nodes[0]] == ADD:
        if len(known) > 1:
            parities.equate(known[0], known[1])
        return known[0]
    return reduce(xor, known) if len(known) == len(row.operands) else parities.unknown()


def are_numbers(graph: Graph, edges: Sequence[int]) -> bool:
    """Whether all lanes of an operand are numbers."""
    return all(abs(edge) in graph.value for edge in edges)


class _Parities:
    """Sums modulo 2 of unknowns, as bits of an integer; bit 0 is the number one.

    Attributes:
        of: Sum of each row, keyed by its first node.
    """

    def __init__(self) -> None:
        self.of: dict[int, int] = {}
        self._unknowns = 0
        self._known: dict[int, int] = {}  # Sum of earlier unknowns that an unknown equals, keyed by its bit.
        self._all_known = 0  # Their bits.

    def unknown(self) -> int:
        """A new unknown."""
        self._unknowns += 1
        return 1 << self._unknowns

    def equate(self, one: int, other: int) -> None:
        """Declare two sums equal modulo 2, unless that contradicts earlier statements."""
        rest = self._reduced(one ^ other)
        if rest > 1:
            last = rest.bit_length() - 1
            self._known[last] = rest ^ (1 << last)
            self._all_known |= 1 << last

    def value(self, row: int) -> int:
        """The sum of a row, 0 or 1; unknowns of which nothing is stated are 0."""
        return self._reduced(self.of[row]) & 1

    def _reduced(self, total: int) -> int:
        """A sum without the unknowns that others give."""
        while known := total & self._all_known:
            last = known.bit_length() - 1
            total ^= 1 << last | self._known[last]
        return total
