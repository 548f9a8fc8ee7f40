"""Which nodes of limbs correspond."""

from __future__ import annotations

from collections.abc import Callable

from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import needed_nodes
from symofros.generator.codegen.limbs.counterparts import Counterparts, Rows
from tests.generator.codegen.limbs.graphs import limbs_of, of_limbs

Joint = Callable[[int], Edge]


def rows(graph: Graph, edges: list[Edge], count: int, scalars: tuple[int, ...] = ()) -> Rows:
    """The rows that are found for some outputs; sines and cosines are scalars besides."""
    nodes = needed_nodes(graph, edges)
    search = Counterparts(graph, nodes, {}, {*scalars, *(node for node in nodes if graph.op[node] == "sin")})
    search.find(limbs_of(count)[0], count)
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


def test_no_node_is_the_counterpart_of_two() -> None:
    """One limb has a factor twice where the other has two."""

    def limb(g: Graph, q: Joint, k: int) -> Edge:
        a, b, c = (g.mul(g.input("q", 8), g.constant(x)) for x in (0.1, 0.2, 0.3))
        return g.mul(q(0), g.mul(c, c) if k else g.mul(a, b))

    graph, edges = of_limbs(2, limb)
    found = rows(graph, edges, 2)  # By place alone: the factors are put together.
    assert len(found.by_leader) == 1 and not found.has(found.by_leader[abs(edges[0])].operands[1])
    three, edges = of_limbs(3, lambda g, q, k: g.mul(q(0), g.mul(g.input("q", 9), g.constant(1.0 + k % 2))))
    found = rows(three, edges, 3)  # The second factor of the first limb is that of the third.
    assert not any(len(set(row.nodes)) < 3 for row in found.by_leader.values())


def test_operands_that_are_put_together_keep_their_places() -> None:
    """The end of one limb is older than what it is added to, that of the other is not."""

    def limb(g: Graph, q: Joint, k: int) -> Edge:
        end = g.mul(q(2), q(2)) if k else None
        moved = g.mul(q(0), q(1))
        return g.add(moved, end or g.add(g.mul(q(2), g.constant(0.1)), q(2)))

    graph, edges = of_limbs(2, limb)
    row = rows(graph, edges, 2).by_leader[abs(edges[0])]
    assert {abs(edge) for edge in row.operands[0]} == {
        abs(graph.args[abs(edges[0])][0]),
        abs(graph.args[abs(edges[1])][1]),
    }


def test_scalars_correspond_and_are_in_no_row() -> None:
    graph, edges = of_limbs(2, lambda g, q, k: g.mul(g.mul(q(0), q(1)), g.constant(0.3 + k)))
    inner = [graph.args[abs(edge)][0] for edge in edges]
    found = rows(graph, edges, 2, tuple(map(abs, inner)))
    assert found.has(edges) and not found.has(inner)
    assert not rows(graph, edges, 2, (abs(inner[0]),)).by_leader


def test_rows_forget_what_is_removed() -> None:
    graph, edges = of_limbs(2, lambda g, q, k: g.mul(q(0), q(1)))
    found = rows(graph, edges, 2)
    assert found.has([-edges[0], edges[1]]) and not found.has(edges[::-1])
    found.remove([abs(edges[0])])
    assert not found.by_leader and not found.leader_of and not found.has(edges)
