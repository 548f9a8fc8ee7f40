"""A pack's lanes are the scalar graph's own nodes; a lane is its own where no operand of any lane can depend on it."""

from __future__ import annotations

from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.pack import EMPTY, WIDTH, Pack
from symofros.expr.packs import combined


def inputs(g: Graph, group: str, n: int = WIDTH) -> Pack:
    return Pack(tuple(g.input(group, i) if i < n else ZERO for i in range(WIDTH)))


def test_lanes_are_the_scalar_sums() -> None:
    g = Graph()
    a, b, x, y = g.input("c", 0), g.input("c", 1), inputs(g, "x"), inputs(g, "y", 5)
    sign, pack = combined(g, [(a, (ONE, x)), (b, (-ONE, y))])
    expected = [g.sub(g.mul(a, i), g.mul(b, j)) for i, j in zip(x.lanes, y.lanes, strict=True)]
    assert (sign, list(pack.lanes), set(pack.own)) == (ONE, expected, set(range(WIDTH)))
    assert g.packs == [pack]


def test_signs_and_single_terms_cost_nothing() -> None:
    g = Graph()
    x = inputs(g, "x")
    assert combined(g, [(ONE, (-ONE, x)), (ZERO, (ONE, x))]) == (-ONE, x)
    assert combined(g, []) == (ONE, EMPTY)
    assert not g.packs


def test_lanes_that_do_not_count_are_zero() -> None:
    g = Graph()
    _, pack = combined(g, [(g.input("c", 0), (ONE, inputs(g, "x")))], of=range(3))
    assert [lane != ZERO for lane in pack.lanes] == [True] * 3 + [False] * 5


def test_a_value_that_was_there_before_is_not_its_own() -> None:
    g = Graph()
    a, x = g.input("c", 0), inputs(g, "x")
    before = g.mul(a, x.lanes[2])
    _, pack = combined(g, [(a, (ONE, x))])
    assert pack.lanes[2] == before
    assert 2 not in pack.own


def test_a_product_that_the_graph_folds_is_not_its_own() -> None:
    """2 (3 x) becomes 6 x, which rounds otherwise than 2 * (3 x)."""
    g = Graph()
    lanes: list[Edge] = list(inputs(g, "x").lanes)
    lanes[4] = g.mul(g.constant(0.3), lanes[4])
    _, pack = combined(g, [(g.constant(0.7), (ONE, Pack(tuple(lanes))))])
    assert set(pack.own) == set(range(WIDTH)) - {4}


def test_a_product_that_folds_to_its_operand_is_not_what_a_vector_says() -> None:
    """c (x / c) becomes x, which differs from c * (x * (1/c)) by rounding: a lane that such a pack can't form."""
    g = Graph()
    lanes: list[Edge] = list(inputs(g, "x").lanes)
    x, c = lanes[4], 128 / 9
    lanes[4] = g.mul(g.constant(1 / c), x)
    _, pack = combined(g, [(g.constant(c), (ONE, Pack(tuple(lanes))))])
    assert pack.lanes[4] == x and pack.literal == set(range(WIDTH)) - {4}


def test_one_lane_given() -> None:
    g = Graph()
    x, edge = inputs(g, "x"), g.input("c", 0)
    pack = x.with_lane(3, edge)
    assert pack.lanes == (*x.lanes[:3], edge, *x.lanes[4:])
    assert pack.base is x
    assert x.with_lane(3, x.lanes[3]) is x
