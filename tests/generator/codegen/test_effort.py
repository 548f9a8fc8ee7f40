"""Efforts count numbers as they are and packs by their weight; what is liked best wins where they can't tell."""

from __future__ import annotations

import pytest

from reference_models.rigid.chain import chain
from symofros.base.options import Options
from symofros.base.routes import COUPLED, TIE, choose
from symofros.expr.edges import ONE, Edge
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import needed_nodes
from symofros.expr.packs.combine import linear_combination
from symofros.expr.packs.pack import WIDTH, Pack
from symofros.expr.program import Function, Output, Program
from symofros.generator.codegen.effort import PACKED, effort, pack_figures
from symofros.generator.codegen.packs import PackPlan, Store
from symofros.generator.programs import ProgramBuilder
from symofros.mechanics.topology.tree import build_tree, coupled_speeds

# Efforts by which factors would be chosen.
UNLIKE = {"articulated_effort": 2.0, "factors_effort": 1.0}


def program(g: Graph, edges: list[Edge]) -> Program:
    return Program("p", g, {}, (Function("f", "", ("q",), (Output("y", (len(edges),), tuple(edges)),)),))


def chained(operations: int) -> Program:
    """A chain of so many sums."""
    g = Graph()
    total = g.input("q", 0)
    for i in range(operations):
        total = g.add(total, g.input("q", i + 1))
    return program(g, [total])


def spent(p: Program) -> float:
    return effort(p, p.functions[0])


def test_a_pack_costs_its_operations_not_its_lanes() -> None:
    g = Graph()
    x, y = (Pack(tuple(g.input(name, i) for i in range(WIDTH))) for name in ("x", "y"))
    _, pack = linear_combination(g, [(g.input("q", 0), (ONE, x)), (g.input("q", 1), (ONE, y))])
    put = 2 * WIDTH  # What the two packs of inputs are made of, lane by lane.
    assert spent(program(g, list(pack.lanes))) == PACKED * (2 + put)


@pytest.mark.parametrize(
    ("first", "second", "name"),
    [(100, 100, "articulated"), (104, 100, "articulated"), (107, 100, "factors"), (90, 100, "articulated")],
)
def test_the_cheapest_variant_wins_and_ties_keep_scalars(first: int, second: int, name: str) -> None:
    assert 1.04 < TIE < 1.07
    figures = {
        "distant_rotors": 0,
        "coupled_speeds": 0,
        "articulated_effort": spent(chained(first)),
        "factors_effort": spent(chained(second)),
    }
    assert choose("acceleration of trees", figures).method == name
    assert choose("acceleration of trees", {"distant_rotors": 1}).method == "factors"


@pytest.mark.parametrize(("joints", "settled"), [(30, False), (31, True)])
def test_long_chains_get_articulated_bodies_without_a_count(joints: int, settled: bool) -> None:
    """The mean of 0, 1, ... joints - 1 speeds on the way to the base."""
    tree = build_tree(chain(joints, symbolic=False))
    assert coupled_speeds(tree) == (joints - 1) / 2 and (coupled_speeds(tree) >= COUPLED) == settled
    choice = choose("acceleration of trees", {"distant_rotors": 0, "coupled_speeds": coupled_speeds(tree)} | UNLIKE)
    assert choice.method == ("articulated" if settled else "factors")
    if settled:
        assert ProgramBuilder(tree, Options()).trees.figures.keys() == {"distant_rotors", "coupled_speeds"}


def gain(g: Graph, edges: list[Edge]) -> str:
    """Whether packs pay in a function with these outputs."""
    stores = [Store("y", i, edge) for i, edge in enumerate(edges)]
    nodes = needed_nodes(g, edges)
    figures = pack_figures(PackPlan(g, nodes, {}, edges), len(nodes), stores)
    return choose("values by vectors", figures | {"by_routine": False}).method


def repeated(g: Graph, times: int) -> tuple[Edge, ...]:
    """Lanes of eight that are scaled and added so many times, from eight inputs that are put in."""
    x = Pack(tuple(g.input("x", i) for i in range(WIDTH)))
    sign, pack = ONE, x
    for i in range(times):
        sign, pack = linear_combination(g, [(g.input("q", i), (sign, pack)), (ONE, (ONE, x))])
    return tuple(sign * lane for lane in pack.lanes)


def test_packs_pay_if_more_is_computed_than_inserted() -> None:
    g = Graph()
    assert gain(g, list(repeated(g, 8))) == "packs"
