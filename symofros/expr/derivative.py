"""Derivatives on the graph, by the op table's rules: exact, shared, never expanded.

Forward mode, several directions at once: what a node contributes to the rates of those above it is one factor for all
directions, so their rates go in packs.

Reverse mode, the gradient of a weighted sum of edges: with y-bar = d(w . y)/dy of each node y, a node z = f(y, ...)
adds (df/dy) z-bar to y-bar (docs/theory/linear.md, section 5). One sweep from the results serves all inputs; it takes
at most four operations for each one of the function, its own values among them, whatever the number of inputs.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import needed_nodes
from symofros.expr.ops import DIV, OPS, STOP_GRADIENT
from symofros.expr.packs.combine import linear_combination
from symofros.expr.packs.pack import EMPTY, WIDTH, Pack, SignedPack


def directional(graph: Graph, edges: Sequence[Edge], seeds: Mapping[Edge, Edge]) -> list[Edge]:
    """The derivative of some edges along a direction.

    Args:
        graph: Graph of the edges, which receives the derivatives.
        edges: Edges to differentiate.
        seeds: Rate of each varying input, keyed by the input's edge; all other inputs are constant.

    Returns:
        One edge for each of `edges`.
    """
    return [rate for (rate,) in along(graph, edges, [seeds])]


def along(
    graph: Graph,
    edges: Sequence[Edge],
    directions: Sequence[Mapping[Edge, Edge]],
    groups: Sequence[Sequence[int]] | None = None,
) -> list[list[Edge]]:
    """The derivatives of some edges along several directions.

    Args:
        graph: Graph of the edges, which receives the derivatives.
        edges: Edges to differentiate.
        directions: Rates of inputs, as in `directional`.
        groups: Indices of the directions, those together that change much the same nodes; None: as they come.

    Returns:
        One row an edge, one column a direction.
    """
    nodes = needed_nodes(graph, edges, but=STOP_GRADIENT)
    rows = [[ZERO] * len(directions) for _ in edges]
    for group in groups if groups is not None else [range(len(directions))]:
        for first in range(0, len(group), WIDTH):
            columns = group[first : first + WIDTH]
            rates = _rates(graph, nodes, [directions[k] for k in columns])
            for row, edge in zip(rows, edges, strict=True):
                sign, pack = rates.get(abs(edge), (ONE, EMPTY))
                for lane, k in enumerate(columns):
                    row[k] = pack.lanes[lane] if (sign == ONE) == (edge > 0) else -pack.lanes[lane]
    return rows


def _rates(graph: Graph, nodes: Sequence[int], directions: Sequence[Mapping[Edge, Edge]]) -> dict[int, SignedPack]:
    """Node -> its derivatives along up to WIDTH directions; nodes whose derivatives are all zero are left out."""
    padding = (ZERO,) * (WIDTH - len(directions))
    rates: dict[int, SignedPack] = {}
    for seed in dict.fromkeys(seed for direction in directions for seed in direction):
        rates[seed] = ONE, Pack(tuple(direction.get(seed, ZERO) for direction in directions) + padding)
    for node in nodes:
        args = graph.args[node]
        terms = []
        for i, arg in enumerate(args):
            sign, pack = rates.get(abs(arg), (ONE, EMPTY))
            if pack is not EMPTY:
                partial = OPS[graph.op[node]].derivative(graph, args, node, i)
                terms.append((partial, (sign if arg > 0 else -sign, pack)))
        sign, pack = linear_combination(graph, terms, range(len(directions))) if terms else (ONE, EMPTY)
        if any(pack.lanes):
            rates[node] = sign, pack
    return rates


def partials(
    graph: Graph, edges: Sequence[Edge], inputs: Sequence[Edge], groups: Sequence[Sequence[int]] | None = None
) -> list[list[Edge]]:
    """The Jacobian of some edges: one row an edge, one column an input; groups as in `along`."""
    return along(graph, edges, [{x: ONE} for x in inputs], groups)


def adjoint(graph: Graph, edges: Sequence[Edge], weights: Sequence[Edge], inputs: Sequence[Edge]) -> list[Edge]:
    """The gradient of sum weight * edge by some inputs; the weights count as constants.

    Args:
        graph: Graph of the edges, which receives the gradient.
        edges: Edges to differentiate.
        weights: Weight of each edge.
        inputs: Edges of input nodes.

    Returns:
        One edge for each of `inputs`.
    """
    nodes = needed_nodes(graph, edges, but=STOP_GRADIENT)
    varying = set(map(abs, inputs))
    for node in nodes:
        if any(abs(arg) in varying for arg in graph.args[node]):
            varying.add(node)
    bars: dict[int, Edge] = {}
    for edge, weight in zip(edges, weights, strict=True):
        _accumulate(graph, bars, edge, weight)
    for node in reversed(nodes):
        bar = bars.get(node, ZERO)
        if bar != ZERO and node in varying:
            for arg, share in _shares(graph, node, bar, varying):
                _accumulate(graph, bars, arg, share)
    return [bars.get(abs(edge), ZERO) if edge > 0 else -bars.get(abs(edge), ZERO) for edge in inputs]


def _shares(graph: Graph, node: int, bar: Edge, varying: set[int]) -> Iterator[tuple[Edge, Edge]]:
    """Each operand that varies, and what the node adds to the adjoint of that edge."""
    args = graph.args[node]
    if graph.op[node] == DIV:  # One division for both operands.
        share = graph.div(bar, args[1])
        shares = [share, -graph.mul(share, node)] if abs(args[1]) in varying else [share]
        yield from ((arg, share) for arg, share in zip(args, shares, strict=False) if abs(arg) in varying)
        return
    derivative = OPS[graph.op[node]].derivative
    for i, arg in enumerate(args):
        if abs(arg) in varying:
            yield arg, graph.mul(derivative(graph, args, node, i), bar)


def _accumulate(graph: Graph, bars: dict[int, Edge], edge: Edge, share: Edge) -> None:
    node = abs(edge)
    bars[node] = graph.add(bars.get(node, ZERO), share if edge > 0 else -share)
