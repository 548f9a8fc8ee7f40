"""A pack: edges that are computed alike, one in each lane of a vector. How packs are combined: packs.py."""

from __future__ import annotations

from dataclasses import dataclass

from symofros.expr.edges import ZERO, Edge

# Lanes of a pack: the doubles of the widest vectors.
WIDTH = 8
# With fewer lanes a vector saves less than putting lanes in and reading them costs.
LEAST = 3


@dataclass(frozen=True, eq=False, slots=True)
class Pack:
    """Up to WIDTH edges; lanes that are not in use hold zero.

    Attributes:
        lanes: WIDTH edges.
        terms: (factor, pack): what the lanes are the sum of, left to right; none if they are given one by one.
        base: The pack that most lanes are taken from, where they are given.
        literal: Lanes that `terms` give bit for bit; in the others the graph folded scalars in another way.
        own: Those of them whose nodes the combination made, which no operand of any lane can depend on.
        least: It is worth a vector from so many lanes on that are wanted.
        start: Operands of all lanes are older than this node, results and what leads to them are not.
    """

    lanes: tuple[Edge, ...]
    terms: tuple[tuple[Edge, Pack], ...] = ()
    base: Pack | None = None
    literal: frozenset[int] = frozenset()
    own: frozenset[int] = frozenset()
    start: int = 0
    least: int = LEAST

    def with_lane(self, lane: int, edge: Edge) -> Pack:
        """The same with one lane given."""
        if self.lanes[lane] == edge:
            return self
        lanes = list(self.lanes)
        lanes[lane] = edge
        return Pack(tuple(lanes), base=self)


EMPTY = Pack((ZERO,) * WIDTH)
# A pack with its sign, which costs nothing as long as it stands beside a factor.
Signed = tuple[Edge, Pack]
