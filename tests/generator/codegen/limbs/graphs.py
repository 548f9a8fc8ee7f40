"""Graphs of equal limbs, and the C of their vectors."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from symofros.expr.edges import ZERO, Edge
from symofros.expr.graph import Graph, Slot
from symofros.expr.numerics.evaluate import needed_nodes
from symofros.expr.program import Limb, Output, Program
from symofros.generator.codegen.limbs.plan import LimbPlan

JOINTS = 3


def limbs_of(count: int) -> tuple[tuple[Limb, ...], ...]:
    """A group of limbs with JOINTS entries of q each, one behind the other."""
    return (tuple(tuple(Slot("q", JOINTS * k + j) for j in range(JOINTS)) for k in range(count)),)


def program(graph: Graph, count: int, edges: Sequence[Edge]) -> tuple[Program, tuple[Output, ...]]:
    """A function of q, with what its limbs share behind their joints, and its output y."""
    outputs = (Output("y", (len(edges),), tuple(edges)),)
    return Program("limbs", graph, {"q": JOINTS * count + 3}, (), limbs=limbs_of(count)), outputs


def of_limbs(count: int, limb: Callable[[Graph, Callable[[int], Edge], int], Edge]) -> tuple[Graph, list[Edge]]:
    """A graph, and an edge of each limb."""
    graph = Graph()
    edges = [limb(graph, lambda j, k=k: graph.input("q", JOINTS * k + j), k) for k in range(count)]  # type: ignore[misc]
    return graph, edges


def cubed(graph: Graph, edge: Edge) -> Edge:
    """An edge with more operations, so that vectors pay."""
    return graph.mul(graph.add(graph.mul(edge, edge), edge), edge)


def plan(graph: Graph, count: int, edges: Sequence[Edge]) -> LimbPlan:
    """The vectors of a function with these outputs."""
    nodes = needed_nodes(graph, [edge for edge in edges if edge != ZERO])
    return LimbPlan(graph, nodes, {}, edges, limbs_of(count))
