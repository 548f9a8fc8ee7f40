"""Which nodes of limbs correspond."""

from __future__ import annotations

from collections.abc import Callable

from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import needed_nodes
from symofros.generator.codegen.limbs.counterparts import Counterparts, Rows
from tests.generator.codegen.limbs.graphs import limbs_of, of_limbs

Joint = Callable[[int], Edge]


def rows(graph: Graph, edges: list[Edge], count: int, taken: tuple[int, ...] = ()) -> Rows:
    """The rows that are found for some outputs."""
    nodes = needed_nodes(graph, edges)
    search = Counterparts(graph, nodes, {}, set(nodes).difference(taken))
    search.find(limbs_of(count)[0])
    return search.rows


def test_the_same_operations_on_other_numbers_correspond() -> None:
    def limb(g: Graph, q: Joint, k: int) -> Edge:
        return g.add(g.mul(g.apply("sin", q(0)), g.constant(0.3 + k)), g.mul(q(1), g.input("q", 20)))

    graph, edges = of_limbs(3, limb)
    found = rows(graph, edges, 3)
    assert {tuple(map(abs, edges))} < {row.nodes for row in found.by_leader.values()}
    assert len(found.by_leader) == 3 and len(found.leader_of) == 9  # Two products and a sum; sines are in no row.


def test_operands_correspond_in_either_order() -> None:
    """Nodes order their operands by age, which differs from limb to limb."""

    def limb(g: Graph, q: Joint, k: int) -> Edge:
        if k:
            late = g.mul(q(2), q(0))
            return g.add(late, g.mul(q(0), q(1)))
        return g.add(g.mul(q(0), q(1)), g.mul(q(2), q(0)))

    graph, edges = of_limbs(2, limb)
    found = rows(graph, edges, 2)
    assert found.has(edges)
    row = found.by_leader[abs(edges[0])]
    assert all(found.has(operand) for operand in row.operands)


def test_the_operands_of_a_quotient_keep_their_places() -> None:
    def limb(g: Graph, q: Joint, k: int) -> Edge:
        a, b = g.mul(q(0), q(0)), g.mul(q(1), q(1))
        return g.div(b, a) if k else g.div(a, b)

    graph, edges = of_limbs(2, limb)
    assert not rows(graph, edges, 2).has(edges)


def test_what_limbs_have_in_common_is_no_counterpart_of_something_else() -> None:
    """Each limb is scaled by an input of the trunk, and these are two."""

    def limb(g: Graph, q: Joint, k: int) -> Edge:
        return g.mul(g.mul(q(0), q(1)), g.input("v", k))

    graph, edges = of_limbs(2, limb)
    found = rows(graph, edges, 2)
    assert len(found.by_leader) == 2  # The outer product is found by its place, its operand put together.
    assert not found.has(found.by_leader[abs(edges[0])].operands[1])


def test_limbs_that_differ_at_their_ends_are_alike_further_in() -> None:
    def limb(g: Graph, q: Joint, k: int) -> Edge:
        end = g.mul(q(2), q(2)) if k else g.add(q(2), g.mul(q(2), g.constant(0.1)))
        moved = g.add(g.mul(q(1), g.constant(0.3 + k)), end)
        return g.mul(g.add(g.mul(moved, q(0)), g.constant(2.0 + k)), q(1))

    graph, edges = of_limbs(2, limb)
    found = rows(graph, edges, 2)
    assert found.has(edges)
    assert len(found.by_leader) == 5  # All but the ends.


def test_sums_over_limbs_are_not_counterparts_of_each_other() -> None:
    """The second sum waits for the first, so no vector can hold both."""

    def limb(g: Graph, q: Joint, k: int) -> Edge:
        return g.mul(q(0), q(1))

    graph, edges = of_limbs(2, limb)
    first = graph.add(graph.input("v", 0), edges[0])
    second = graph.add(first, edges[1])
    found = rows(graph, [second], 2)
    assert found.has(edges) and not {abs(first), abs(second)} & found.leader_of.keys()


def test_nodes_that_are_taken_stay_apart() -> None:
    graph, edges = of_limbs(2, lambda g, q, k: g.mul(g.mul(q(0), q(1)), q(2)))
    assert not rows(graph, edges, 2, tuple(map(abs, edges))).has(edges)


def test_rows_forget_what_is_removed() -> None:
    graph, edges = of_limbs(2, lambda g, q, k: g.mul(q(0), q(1)))
    found = rows(graph, edges, 2)
    assert found.has([-edges[0], edges[1]]) and not found.has(edges[::-1])
    found.remove([abs(edges[0])])
    assert not found.by_leader and not found.leader_of and not found.has(edges)
