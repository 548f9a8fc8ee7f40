"""The verifier refuses packs that a vector could not compute, and says why."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import pytest

from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.packs.check import check_packs
from symofros.expr.packs.combine import linear_combination
from symofros.expr.packs.pack import WIDTH, Pack
from symofros.expr.program import Program

ALL = frozenset(range(WIDTH))


def inputs(g: Graph, group: str) -> Pack:
    return Pack(tuple(g.input(group, i) for i in range(WIDTH)))


def product(g: Graph, factor: Edge, operand: Pack) -> Pack:
    """A pack that is one factor times another pack, whatever nodes there were before."""
    lanes = tuple(g.mul(factor, edge) for edge in operand.lanes)
    return Pack(lanes, ((factor, operand),), exact_lanes=ALL, new_lanes=ALL)


def check(g: Graph, *packs: Pack) -> None:
    g.packs += packs
    check_packs(Program("p", g, {}, ()))


def refusal(g: Graph, *packs: Pack) -> str:
    with pytest.raises(AssertionError) as refused:
        check(g, *packs)
    return str(refused.value)


def test_a_linear_combination_is_valid() -> None:
    g = Graph()
    a, b = g.input("c", 0), g.input("c", 1)
    _, y = linear_combination(g, [(a, (ONE, inputs(g, "x"))), (b, (-ONE, inputs(g, "y")))])
    linear_combination(g, [(ONE, (ONE, y)), (a, (ONE, inputs(g, "x")))])
    assert len(g.packs) == 2
    check(g)


def test_validity_does_not_depend_on_creation_order() -> None:
    """A factor and operands that are younger than lanes of the pack, and a first node that means nothing."""
    g = Graph()
    x, c = inputs(g, "x"), g.input("c", 0)
    early = [g.mul(c, edge) for edge in x.lanes[:3]]
    late = [g.call("exp", edge) for edge in x.lanes[3:]]
    pack = product(g, c, Pack((*x.lanes[:3], *late)))
    assert list(pack.lanes[:3]) == early and max(late) > max(early)
    check(g, replace(pack, first_node=len(g) + 7))


def test_a_lane_that_depends_on_another_lane_is_refused() -> None:
    g = Graph()
    x, c = inputs(g, "x"), g.input("c", 0)
    first = g.mul(c, x.lanes[0])
    operand = x.with_lane(5, g.call("sin", g.add(first, x.lanes[1])))
    assert refusal(g, product(g, c, operand)) == "pack 0: lane 5 depends on lane 0"


def test_a_factor_that_depends_on_a_lane_is_refused() -> None:
    g = Graph()
    x, y, c = inputs(g, "x"), inputs(g, "y"), g.input("c", 0)
    factor = g.call("sin", g.mul(c, x.lanes[2]))
    lanes = tuple(g.add(g.mul(c, a), g.mul(factor, b)) for a, b in zip(x.lanes[:2], y.lanes[:2], strict=True))
    pack = Pack(
        (*lanes, g.mul(c, x.lanes[2]), *[ZERO] * 5),
        ((c, Pack((*x.lanes[:3], *[ZERO] * 5))), (factor, Pack((*y.lanes[:2], *[ZERO] * 6)))),
        exact_lanes=ALL,
        new_lanes=frozenset(range(3)),
    )
    assert refusal(g, pack) == "pack 0: lane 0 depends on lane 2"


def test_packs_that_wait_for_each_other_are_refused() -> None:
    """Each is valid by itself, but lane 1 of each depends on lane 0 of the other."""
    g = Graph()
    x, y, c, d = inputs(g, "x"), inputs(g, "y"), g.input("c", 0), g.input("c", 1)
    first = product(g, c, x.with_lane(1, g.call("sin", g.mul(d, y.lanes[0]))))
    second = product(g, d, y.with_lane(1, g.call("sin", g.mul(c, x.lanes[0]))))
    check(g, first)
    g.packs.clear()
    check(g, second)
    g.packs.clear()
    assert refusal(g, first, second) == "packs 0, 1 wait for each other"


@pytest.mark.parametrize(
    "other",
    [
        lambda g, c, x: g.add(c, x),
        lambda g, c, x: g.div(x, c),
        lambda g, c, x: -g.mul(c, x),
        lambda g, c, x: g.mul(g.call("sin", c), x),
        lambda g, c, x: g.mul(c, g.call("sin", x)),
    ],
    ids=["sum", "quotient", "sign", "factor", "operand"],
)
def test_a_lane_of_other_operations_is_refused(other: Callable[[Graph, Edge, Edge], Edge]) -> None:
    g = Graph()
    x, c = inputs(g, "x"), g.input("c", 0)
    pack = product(g, c, x)
    lanes = (*pack.lanes[:4], other(g, c, x.lanes[4]), *pack.lanes[5:])
    text = refusal(g, replace(pack, lanes=lanes))
    assert text == "pack 0: lane 4 is computed by other operations than the terms of the pack state"


@pytest.mark.parametrize("dead", [ZERO, ONE, 999], ids=["zero", "number", "no node"])
def test_a_dead_lane_is_refused(dead: Edge) -> None:
    g = Graph()
    pack = product(g, g.input("c", 0), inputs(g, "x"))
    text = refusal(g, replace(pack, lanes=(*pack.lanes[:7], dead)))
    assert text == f"pack 0: lane 7 is dead: its edge {dead} is no computed node"


def test_an_input_is_an_invalid_new_lane() -> None:
    g = Graph()
    x = inputs(g, "x")
    assert "lane 0 is dead" in refusal(g, Pack(x.lanes, ((ONE, x),), exact_lanes=ALL, new_lanes=ALL))


def test_a_node_in_two_lanes_is_refused() -> None:
    g = Graph()
    x = inputs(g, "x")
    pack = product(g, g.input("c", 0), x.with_lane(6, x.lanes[1]))
    node = abs(pack.lanes[1])
    assert refusal(g, pack) == f"pack 0: lane 6 holds node {node}, which lane 1 of pack 0 holds, too"


def test_a_node_in_two_packs_is_refused() -> None:
    g = Graph()
    pack = product(g, g.input("c", 0), inputs(g, "x"))
    assert "lane 0 of pack 0 holds, too" in refusal(g, pack, replace(pack))


@pytest.mark.parametrize(
    ("exact", "new"), [(range(3), range(4)), (range(9), range(3))], ids=["not exact", "no such lane"]
)
def test_new_lanes_are_exact_lanes(exact: Sequence[int], new: Sequence[int]) -> None:
    g = Graph()
    pack = product(g, g.input("c", 0), inputs(g, "x"))
    text = refusal(g, replace(pack, exact_lanes=frozenset(exact), new_lanes=frozenset(new)))
    assert "are not among its exact lanes" in text


def test_a_pack_without_terms_is_refused() -> None:
    g = Graph()
    assert refusal(g, inputs(g, "x")) == "pack 0: it is no linear combination"
