"""Linear combinations of packs: the scalars of every lane, and a record of the operations that form them all."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence

from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.ops import ADD, MUL
from symofros.expr.packs.pack import EMPTY, MIN_LANES, WIDTH, Pack, SignedPack


def linear_combination(
    g: Graph,
    terms: Sequence[tuple[Edge, SignedPack]],
    lanes: Collection[int] = range(WIDTH),
    min_lanes: int = MIN_LANES,
) -> SignedPack:
    """The sum of factor * pack, lane by lane, from the left.

    Args:
        g: Graph that receives the scalars, and the pack if it has two new lanes at least.
        terms: Factors that all lanes share, each with the pack that it multiplies.
        lanes: Lanes to compute; the others become zero.
        min_lanes: Fewest wanted lanes for which a vector pays.
    """
    signed = tuple((g.mul(factor, sign), pack) for factor, (sign, pack) in terms)
    signed = tuple((factor, pack) for factor, pack in signed if factor != ZERO and any(pack.lanes))
    if not signed:
        return ONE, EMPTY
    if len(signed) == 1 and abs(signed[0][0]) == ONE and not _outside(signed[0][1], lanes):
        return signed[0]
    first_node = len(g)
    sums = [
        g.sum(g.mul(factor, pack.lanes[lane]) for factor, pack in signed if pack.lanes[lane]) if lane in lanes else ZERO
        for lane in range(WIDTH)
    ]
    pack = with_exact_lanes(g, Pack(tuple(sums), signed, first_node=first_node, min_lanes=min_lanes), range(WIDTH))
    if len(pack.new_lanes) > 1:
        g.packs.append(pack)
    return ONE, pack


def _outside(pack: Pack, lanes: Collection[int]) -> bool:
    """Whether a pack holds anything in other lanes."""
    return any(edge != ZERO for lane, edge in enumerate(pack.lanes) if lane not in lanes)


def with_exact_lanes(g: Graph, pack: Pack, candidates: Collection[int]) -> Pack:
    """A copy of a pack with its exact and new lanes, determined from the operations of its nodes.

    Args:
        g: Graph of the pack, in which its operands were there before `first_node`.
        pack: A linear combination.
        candidates: Lanes whose operands are all there.
    """
    exact = [lane for lane in candidates if is_sum(g, pack.lanes[lane], pack.operands(lane))]
    new: dict[int, int] = {}
    for lane in sorted(exact):
        node = abs(pack.lanes[lane])
        if node >= pack.first_node and g.args[node]:
            new.setdefault(node, lane)
    return Pack(
        pack.lanes,
        pack.terms,
        pack.base,
        frozenset(exact),
        frozenset(new.values()),
        pack.first_node,
        pack.min_lanes,
    )


def is_sum(g: Graph, edge: Edge, products: Sequence[tuple[Edge, Edge]]) -> bool:
    """Whether an edge is the sum of products (factor, operand) from the left, rounded as a vector rounds it."""
    products = [product for product in products if product[0] and product[1]]
    if not products:
        return edge == ZERO
    return _is_chain(g, edge, products) or _is_sum(g, edge, products)


def _is_chain(g: Graph, edge: Edge, products: Sequence[tuple[Edge, Edge]]) -> bool:
    """Whether the graph states the sum of products by one addition each, as it does wherever nothing folds."""
    for factor, operand in products[:0:-1]:
        node = abs(edge)
        if g.op[node] != ADD:
            return False
        a, b = g.args[node] if edge > 0 else (-g.args[node][0], -g.args[node][1])
        if is_product(g, b, factor, operand):
            edge = a
        elif is_product(g, a, factor, operand):
            edge = b
        else:
            return False
    return is_product(g, edge, *products[0])


def _is_sum(g: Graph, edge: Edge, products: Sequence[tuple[Edge, Edge]]) -> bool:
    """The same of one product or more, none of which is zero."""
    *first, last = products
    if not first:
        return is_product(g, edge, *last)
    if g.is_constant(edge) and sum((_product_of_numbers(g, *product) for product in products), 0.0) == g.number(edge):
        return True
    if edge == ZERO:
        return _is_minus(g, last, first)
    return any(is_product(g, addend, *last) and _is_sum(g, rest, first) for rest, addend in _addends(g, edge))


def _is_minus(g: Graph, product: tuple[Edge, Edge], products: Sequence[tuple[Edge, Edge]]) -> bool:
    """Whether a product cancels the sum of those before it; the graph has no node for the zero that remains."""
    factor, operand = product
    if abs(factor) == ONE:
        return _is_sum(g, -factor * operand, products)
    sets = [{abs(edge) for edge in pair} for pair in (product, products[0])]
    return len(products) == 1 and sets[0] == sets[1] and (factor * operand < 0) != (products[0][0] * products[0][1] < 0)


def _addends(g: Graph, edge: Edge) -> Iterator[tuple[Edge, Edge]]:
    """Pairs of edges whose sum the graph states by an edge."""
    sign = ONE if edge > 0 else -ONE
    op = g.op[abs(edge)]
    if op in (ADD, MUL):
        a, b = g.args[abs(edge)]
        for rest, addend in ((a, b), (b, a)):
            if op == ADD:
                yield sign * rest, sign * addend
            elif g.number(rest) == 2.0:  # The graph has 2 x for x + x.
                yield sign * addend, sign * addend
    yield ZERO, edge  # What precedes the last term may have cancelled.


def is_product(g: Graph, edge: Edge, a: Edge, b: Edge) -> bool:
    """Whether an edge is a * b to the last bit; the graph states c1 (c2 x) by (c1 c2) x, which is rounded otherwise."""
    node, first, second = abs(edge), abs(a), abs(b)
    if first <= ONE or second <= ONE:
        return edge == a * b  # One of them is a sign or zero, and so the product of the edges is an edge.
    if first in g.value and second in g.value:
        return _product_of_numbers(g, a, b) == g.number(edge)
    has_sign = (edge < 0) == (a * b < 0)
    return has_sign and g.op[node] == MUL and g.args[node] in ((first, second), (second, first))


def _product_of_numbers(g: Graph, a: Edge, b: Edge) -> float:
    """The product of two numbers; NaN, which equals nothing, where one is none."""
    factors = g.number(a), g.number(b)
    return math.nan if factors[0] is None or factors[1] is None else factors[0] * factors[1]
