"""Packs: edges that are computed alike, one in each lane of a vector.

The momenta that unit speeds give to a tree are carried from joint to joint by the same turns and offsets, whichever
speed they belong to. The graph stays one of scalars, which is what the interpreter, the counts and batches see; a
pack only remembers that several of its nodes are the same linear combination of others, so that generated code may
form them by one operation on a vector.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from symofros.expr.graph import ONE, ZERO, Edge, Graph
from symofros.expr.ops import MUL

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


def combined(
    g: Graph, terms: Sequence[tuple[Edge, Signed]], of: Collection[int] = range(WIDTH), least: int = LEAST
) -> Signed:
    """The sum of factor * pack, lane by lane, from the left.

    Args:
        g: The graph.
        terms: Factors that all lanes share, and what they multiply.
        of: Lanes that count; the others become zero.
        least: It is worth a vector from so many lanes on that are wanted.
    """
    signed = tuple((g.mul(factor, sign), pack) for factor, (sign, pack) in terms)
    signed = tuple((factor, pack) for factor, pack in signed if factor != ZERO and any(pack.lanes))
    if not signed:
        return ONE, EMPTY
    if (
        len(signed) == 1
        and abs(signed[0][0]) == ONE
        and not any(edge for lane, edge in enumerate(signed[0][1].lanes) if lane not in of)
    ):
        return signed[0]
    start = len(g)
    lanes, literal = [], set()
    for lane in range(WIDTH):
        total, is_literal = ZERO, True
        for factor, pack in signed if lane in of else ():
            product = g.mul(factor, pack.lanes[lane])
            is_literal &= _is_product(g, product, factor, pack.lanes[lane])
            total = g.add(total, product)
        lanes.append(total)
        if is_literal and (lane in of or not any(pack.lanes[lane] for _, pack in signed)):
            literal.add(lane)
    own = frozenset(lane for lane in literal if abs(lanes[lane]) >= start)
    pack = Pack(tuple(lanes), signed, None, frozenset(literal), own, start, least)
    if len(own) > 1:
        g.packs.append(pack)
    return ONE, pack


def _is_product(g: Graph, product: Edge, a: Edge, b: Edge) -> bool:
    """Whether a product is rounded as a * b is: the graph turns c1 (c2 x) into (c1 c2) x, or into x."""
    if ZERO in (a, b) or ONE in (abs(a), abs(b)) or (g.is_constant(a) and g.is_constant(b)):
        return True
    return g.op[abs(product)] == MUL and set(g.args[abs(product)]) == {abs(a), abs(b)}
