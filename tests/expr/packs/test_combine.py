"""A linear combination computes the scalars of every lane, and tells which of them a vector gives to the bit."""

from __future__ import annotations

from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.packs.combine import is_sum, linear_combination
from symofros.expr.packs.pack import EMPTY, WIDTH, Pack


def inputs(g: Graph, group: str, n: int = WIDTH) -> Pack:
    return Pack(tuple(g.input(group, i) if i < n else ZERO for i in range(WIDTH)))


def test_lanes_are_the_scalar_sums() -> None:
    g = Graph()
    a, b, x, y = g.input("c", 0), g.input("c", 1), inputs(g, "x"), inputs(g, "y", 5)
    sign, pack = linear_combination(g, [(a, (ONE, x)), (b, (-ONE, y))])
    expected = [g.sub(g.mul(a, i), g.mul(b, j)) for i, j in zip(x.lanes, y.lanes, strict=True)]
    assert (sign, list(pack.lanes), set(pack.new_lanes)) == (ONE, expected, set(range(WIDTH)))
    assert g.packs == [pack]


def test_sign_changes_and_single_terms_need_no_operation() -> None:
    g = Graph()
    x = inputs(g, "x")
    assert linear_combination(g, [(ONE, (-ONE, x)), (ZERO, (ONE, x))]) == (-ONE, x)
    assert linear_combination(g, []) == (ONE, EMPTY)
    assert not g.packs


def test_unused_lanes_are_zero() -> None:
    g = Graph()
    _, pack = linear_combination(g, [(g.input("c", 0), (ONE, inputs(g, "x")))], lanes=range(3))
    assert [lane != ZERO for lane in pack.lanes] == [True] * 3 + [False] * 5


def test_nodes_that_existed_before_are_not_new_lanes() -> None:
    g = Graph()
    a, x = g.input("c", 0), inputs(g, "x")
    before = g.mul(a, x.lanes[2])
    _, pack = linear_combination(g, [(a, (ONE, x))])
    assert pack.lanes[2] == before
    assert 2 not in pack.new_lanes


def test_products_that_the_graph_folds_are_not_new_lanes() -> None:
    """2 (3 x) becomes 6 x, which rounds otherwise than 2 * (3 x)."""
    g = Graph()
    lanes: list[Edge] = list(inputs(g, "x").lanes)
    lanes[4] = g.mul(g.constant(0.3), lanes[4])
    _, pack = linear_combination(g, [(g.constant(0.7), (ONE, Pack(tuple(lanes))))])
    assert set(pack.new_lanes) == set(range(WIDTH)) - {4}


def test_products_that_fold_to_an_operand_are_not_exact_lanes() -> None:
    """c (x / c) becomes x, which differs from c * (x * (1/c)) by rounding."""
    g = Graph()
    lanes: list[Edge] = list(inputs(g, "x").lanes)
    x, c = lanes[4], 128 / 9
    lanes[4] = g.mul(g.constant(1 / c), x)
    _, pack = linear_combination(g, [(g.constant(c), (ONE, Pack(tuple(lanes))))])
    assert pack.lanes[4] == x and pack.exact_lanes == set(range(WIDTH)) - {4}


def test_one_lane_of_a_copied_pack_can_be_replaced() -> None:
    g = Graph()
    x, edge = inputs(g, "x"), g.input("c", 0)
    pack = x.with_lane(3, edge)
    assert pack.lanes == (*x.lanes[:3], edge, *x.lanes[4:])
    assert pack.base is x
    assert x.with_lane(3, x.lanes[3]) is x


def test_lanes_of_one_node_are_one_new_lane() -> None:
    g = Graph()
    x = g.input("x", 0)
    _, pack = linear_combination(g, [(g.input("c", 0), (ONE, Pack((x, x, g.input("x", 1), *[ZERO] * 5))))])
    assert pack.lanes[0] == pack.lanes[1]
    assert set(pack.new_lanes) == {0, 2}


def test_a_sum_is_recognised_by_its_products_and_their_order() -> None:
    g = Graph()
    a, b, c, x, y, z = (g.input("x", i) for i in range(6))
    total = g.sub(g.add(g.mul(a, x), g.mul(b, y)), g.mul(c, z))
    assert is_sum(g, total, [(a, x), (b, y), (-c, z)])
    assert is_sum(g, -total, [(-a, x), (b, -y), (c, z)])
    assert not is_sum(g, -total, [(a, x), (b, y), (-c, z)])
    assert not is_sum(g, total, [(a, x), (b, y), (c, z)])
    assert not is_sum(g, total, [(a, x), (-c, z), (b, y)])  # Rounded otherwise.
    assert not is_sum(g, total, [(a, x), (b, y)])


def test_sums_that_the_graph_folds_without_rounding_are_recognised() -> None:
    g = Graph()
    a, x, y = (g.input("x", i) for i in range(3))
    two, three = g.constant(2.0), g.constant(3.0)
    assert is_sum(g, g.mul(two, x), [(ONE, x), (ONE, x)])
    assert is_sum(g, g.constant(7.0), [(two, three), (ONE, ONE)])
    assert is_sum(g, ZERO, [(a, x), (-a, x)])
    assert is_sum(g, y, [(ONE, x), (-ONE, x), (ONE, y)])
    assert is_sum(g, ZERO, [(a, ZERO), (ZERO, x)])
