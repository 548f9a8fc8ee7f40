"""Packs: edges that are computed alike, one in each lane of a vector.

The momenta that unit speeds give to a tree are carried from joint to joint by the same turns and offsets, whichever
speed they belong to. The graph stays one of scalars, which is what the interpreter, the counts and batches see; a
pack only remembers that several of its nodes are the same linear combination of others, so that generated code may
form them by one operation on a vector.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.ops import MUL
from symofros.expr.pack import EMPTY, LEAST, WIDTH, Pack, Signed


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
