"""Adjoints on the graph: the gradient of a weighted sum of edges in one sweep from the results to the inputs.

Reverse mode: with y-bar = d(w . y)/dy of each node y, a node z = f(y, ...) adds (df/dy) z-bar to y-bar
(docs/theory/linear.md, section 5). One sweep serves all inputs; it takes at most four operations for each one of the
function, its own values among them, whatever the number of inputs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from symofros.expr.edges import ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import needed_nodes
from symofros.expr.ops import DIV, OPS, STOP_GRADIENT


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
