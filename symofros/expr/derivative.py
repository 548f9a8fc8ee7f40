"""Derivatives on the graph, by the op table's rules: exact, shared, never expanded.

Forward mode, several directions at once: what a node contributes to the rates of those above it is one factor for all
directions, so their rates go in packs.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import needed_nodes
from symofros.expr.ops import OPS, STOP_GRADIENT
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
