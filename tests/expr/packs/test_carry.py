"""Packs follow their nodes into another graph, as far as their lanes are computed alike there, too."""

from __future__ import annotations

from symofros.expr.edges import ONE, Edge
from symofros.expr.graph import Graph
from symofros.expr.packs.check import check_packs
from symofros.expr.packs.combine import linear_combination
from symofros.expr.packs.pack import WIDTH, Pack
from symofros.expr.program import Program
from symofros.expr.substitute import copy_into

ALL = set(range(WIDTH))


def inputs(g: Graph, group: str) -> Pack:
    return Pack(tuple(g.input(group, i) for i in range(WIDTH)))


def combination(g: Graph) -> Pack:
    """The pack c0 x + c1 y."""
    factors = g.input("c", 0), g.input("c", 1)
    return linear_combination(g, [(factors[0], (ONE, inputs(g, "x"))), (factors[1], (ONE, inputs(g, "y")))])[1]


def copied(g: Graph, edges: list[Edge], fixed: dict[Edge, float]) -> tuple[Graph, list[Edge]]:
    """The edges in a graph of their own, where some inputs are numbers; its packs are valid."""
    into = Graph()
    new = {
        node: into.constant(fixed[node]) if node in fixed else into.input(slot.group, slot.index)
        for node, slot in g.slot.items()
    }
    edges = copy_into(into, g, edges, new)
    check_packs(Program("p", into, {}, ()))
    return into, edges


def test_a_pack_equal_to_its_operand_is_its_operand() -> None:
    """With c0 = 0 and c1 = -1, c0 x + c1 y is -y, and what is made of it has y for an operand."""
    g = Graph()
    pack = combination(g)
    _, last = linear_combination(g, [(g.input("d", 0), (ONE, pack))])
    into, _ = copied(g, list(last.lanes), {g.input("c", 0): 0.0, g.input("c", 1): -1.0})
    (copy,) = into.packs
    ((factor, operand),) = copy.terms
    assert factor == -into.input("d", 0)
    assert operand.lanes == inputs(into, "y").lanes


def test_a_folded_lane_is_not_exact() -> None:
    """0.7 (0.3 z) becomes 0.21 z, which is rounded otherwise."""
    g = Graph()
    c, k = g.input("c", 0), g.input("c", 1)
    x = inputs(g, "x")
    _, pack = linear_combination(g, [(c, (ONE, x.with_lane(3, g.mul(k, x.lanes[3]))))])
    into, _ = copied(g, list(pack.lanes), {c: 0.7, k: 0.3})
    (copy,) = into.packs
    assert set(copy.exact_lanes) == set(copy.new_lanes) == ALL - {3}


def test_lanes_that_existed_before_are_not_new() -> None:
    g, into = Graph(), Graph()
    pack = combination(g)
    new = {node: into.input(slot.group, slot.index) for node, slot in g.slot.items()}
    copy_into(into, g, [pack.lanes[6]], new)
    copy_into(into, g, list(pack.lanes), new)
    check_packs(Program("p", into, {}, ()))
    (copy,) = into.packs
    assert set(copy.new_lanes) == ALL - {6}
