"""A pack: up to WIDTH edges formed by the same operations. The contract is at the top of the folder."""

from __future__ import annotations

from dataclasses import dataclass

from symofros.expr.edges import ZERO, Edge

# Lanes of a pack: the doubles of the widest vectors.
WIDTH = 8
# Fewest lanes for which a vector saves more than putting lanes in and reading them costs.
MIN_LANES = 3


@dataclass(frozen=True, eq=False, slots=True)
class Pack:
    """Up to WIDTH edges; unused lanes hold zero.

    Attributes:
        lanes: Edge in each lane (WIDTH).
        terms: (factor, pack) of the linear combination that gives the lanes, from the left; empty if they are stated
            one by one.
        base: Pack from which most lanes are copied, where they are stated one by one.
        exact_lanes: Lanes that the linear combination gives to the bit; the graph folded the scalars of the others.
        new_lanes: Exact lanes whose nodes this combination created; no operand of any lane depends on them.
        first_node: Number of nodes in the graph before the combination; its vector is written there.
        min_lanes: Fewest wanted lanes for which a vector pays.
    """

    lanes: tuple[Edge, ...]
    terms: tuple[tuple[Edge, Pack], ...] = ()
    base: Pack | None = None
    exact_lanes: frozenset[int] = frozenset()
    new_lanes: frozenset[int] = frozenset()
    first_node: int = 0
    min_lanes: int = MIN_LANES

    def __deepcopy__(self, memo: dict[int, object]) -> Pack:
        """The pack itself, which nothing changes."""
        return self

    def with_lane(self, lane: int, edge: Edge) -> Pack:
        """A copy in which one lane holds another edge."""
        if self.lanes[lane] == edge:
            return self
        lanes = list(self.lanes)
        lanes[lane] = edge
        return Pack(tuple(lanes), base=self)

    def operands(self, lane: int) -> list[tuple[Edge, Edge]]:
        """The products (factor, edge) whose sum the lane is."""
        return [(factor, operand.lanes[lane]) for factor, operand in self.terms]


EMPTY = Pack((ZERO,) * WIDTH)
# A sign, ONE or -ONE, and a pack: the sign is free as long as it stands beside a factor.
SignedPack = tuple[Edge, Pack]
