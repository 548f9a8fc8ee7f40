"""Mirrored limbs cost nothing: signs are in numbers, and lanes hold negatives."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from symofros.base import routes
from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.expr.ops import ADD
from symofros.generator.codegen.limbs.plan import LimbPlan
from symofros.generator.codegen.limbs.signs import products
from tests.generator.codegen.limbs.graphs import cubed, of_limbs, plan

Joint = Callable[[int], Edge]


@pytest.fixture(autouse=True)
def always(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(routes, "LIMB_SHARE", 0.0)


def turned(made: LimbPlan) -> int:
    """Terms of sums whose lanes have several signs, which costs a multiplication."""
    vectors = {id(v): v for v in made.vector_of_node.values()}.values()
    return sum(len(set(term.signs)) > 1 for vector in vectors if vector.op == ADD for term in vector.terms)


def mirrored(g: Graph, q: Joint, k: int) -> Edge:
    """A point to the left or the right, turned and squared: x and z are the same, y is the negative."""
    side = g.constant((-1.0) ** k * 0.3)
    x, y = g.mul(q(0), g.constant(0.5)), g.mul(q(1), side)
    x, y = g.sub(g.mul(x, q(2)), g.mul(g.mul(y, q(0)), side)), g.add(g.mul(g.mul(x, q(0)), side), g.mul(y, q(2)))
    return g.add(g.mul(x, x), g.mul(g.mul(x, y), side))


def test_mirror_images_need_no_sign_changes() -> None:
    graph, edges = of_limbs(4, mirrored)
    made = plan(graph, 4, edges)
    assert {lane for node, vector in made.vector_of_node.items() for lane, _ in [vector.nodes[node]]} == {0, 1, 2, 3}
    assert turned(made) == 0


@pytest.mark.parametrize("differ", [False, True])
def test_a_contradiction_costs_one_sign(differ: bool) -> None:
    """a + b in all limbs, or a - b in one, of the same a and b: of six operations one is spared less."""

    def limb(g: Graph, q: Joint, k: int) -> Edge:
        a, b = g.mul(q(0), q(1)), g.mul(q(1), q(2))
        return cubed(g, g.sub(a, b) if differ and k else g.add(a, b))

    graph, edges = of_limbs(2, limb)
    made = plan(graph, 2, edges)
    assert turned(made) == differ
    assert made.spared == 6 - 3 - differ  # Vectors, less joints that are put in.


def test_the_sign_of_a_product_with_a_number_is_chosen_by_its_reader() -> None:
    """The same product, added here and subtracted there."""

    def limb(g: Graph, q: Joint, k: int) -> Edge:
        scaled = g.mul(g.mul(q(0), q(1)), g.constant(0.3))
        other = g.mul(q(1), q(2))
        return g.mul(g.add(other, scaled) if k else g.sub(other, scaled), q(0))

    graph, edges = of_limbs(2, limb)
    made = plan(graph, 2, edges)
    assert turned(made) == 0
    assert {is_negative for vector in made.vector_of_node.values() for _, is_negative in vector.nodes.values()} == {
        False,
        True,
    }


def test_products_are_formed_lane_by_lane() -> None:
    assert products((2, -3, 4), (1, -1, -1), (-1, -1, 1)) == (-2, -3, -4)
