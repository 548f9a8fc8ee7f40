"""Vectors are formed where limbs are alike, and only there."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

import symofros as sf
from reference_models import MODELS
from reference_models.closed.four_bars import n_four_bar
from symofros.compiler import Compilation
from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import needed_nodes
from symofros.expr.ops import ADD
from symofros.expr.packs.combine import linear_combination
from symofros.expr.packs.pack import WIDTH, Pack
from symofros.generator.codegen.effort import effort
from symofros.generator.codegen.limbs.plan import LimbPlan, strongly_connected
from symofros.generator.codegen.model import Packs, model_source
from symofros.generator.codegen.packs import PackPlan
from symofros.generator.programs import ProgramBuilder
from symofros.mechanics.topology.tree import build_tree
from tests.generator.codegen.limbs.graphs import JOINTS, cubed, limbs_of, of_limbs, plan

Joint = Callable[[int], Edge]
VECTOR = re.compile(r"\bsym_(?:pair|quad) p\d+ =")


def quadruped(mirrored: bool = True) -> sf.System:
    """A trunk on four legs of three joints, the right ones mirror images of the left ones."""
    trunk = sf.RigidBody("trunk", sf.Joint("trunk", "free"), sf.Inertia(8.0, (0.01, 0, 0), (0.1, 0.2, 0.3)))
    bodies = [trunk]
    for name, x, y in (("fl", 0.2, 0.1), ("fr", 0.2, -0.1), ("hl", -0.2, 0.1), ("hr", -0.2, -0.1)):
        side = y / 0.1 if mirrored else 1.0
        parent = "trunk"
        for part, axis, position in (
            ("hip", (1, 0, 0), (x, y, 0)),
            ("thigh", (0, 1, 0), (0, 0.08 * side, 0)),
            ("shank", (0, 1, 0), (0, 0, -0.2)),
        ):
            inertia = sf.Inertia(0.8, (0.01, 0.02 * side, -0.1), (2e-3, 3e-3, 2e-3, 1e-4 * side, 2e-4, 3e-4 * side))
            joint = sf.Joint(f"{name}_{part}_q", "revolute", parent, axis=axis, position=position, actuated=True)
            parent = f"{name}_{part}"
            bodies.append(sf.RigidBody(parent, joint, inertia))
    return sf.System("quadruped", bodies)


def text(system: sf.System, function: str, packs: Packs = "where they pay") -> str:
    stated = Compilation(system, sf.Options(functions=(function,)))
    return model_source(stated.program, stated.record, "test", packs=packs)


@pytest.mark.parametrize("function", ["dynamics", "forward_dynamics", "inverse_dynamics_derivatives"])
def test_legs_of_a_quadruped_share_vectors(function: str) -> None:
    system = quadruped()
    assert len(VECTOR.findall(text(system, function))) > 50
    assert not VECTOR.findall(text(system, function, "none"))
    program = Compilation(system, sf.Options(functions=(function,))).program
    stated, nodes = program.functions[0], needed_nodes(program.graph, program.functions[0].edges())
    made = LimbPlan(program.graph, nodes, {}, stated.edges(), program.limbs)
    assert made.spared > 0.4 * len(nodes)
    # All four legs are one row each: lanes differ by their last numbers alone.
    assert {vector.width for vector in made.vectors} == {4}


def test_mirrored_legs_need_few_sign_changes() -> None:
    made = []
    for mirrored in (True, False):
        program = Compilation(quadruped(mirrored), sf.Options(functions=("forward_dynamics",))).program
        edges = program.functions[0].edges()
        nodes = needed_nodes(program.graph, edges)
        made.append((len(nodes), LimbPlan(program.graph, nodes, {}, edges, program.limbs)))
    (_, right), (_, same) = made
    vectors = {id(v): v for v in right.vector_of_node.values()}.values()
    turned = [v for v in vectors if v.op == ADD and any(len(set(term.signs)) > 1 for term in v.terms)]
    assert len(turned) < 0.02 * len(vectors)
    assert any(is_negative for v in vectors for _, is_negative in v.nodes.values())
    assert right.spared > 0.99 * same.spared


def test_forward_dynamics_is_chosen_by_cost_with_shared_limbs() -> None:
    """Factors of M take fewer operations; of those of articulated bodies, legs share more."""
    counts = {}
    for method in ("articulated", "factors"):
        program = Compilation(quadruped(), sf.Options(functions=("forward_dynamics",), forward_dynamics=method)).program
        counts[method] = effort(program, program.functions[0])
    assert counts["articulated"] < counts["factors"]
    assert ProgramBuilder(build_tree(quadruped()), sf.Options()).trees.method == "articulated"


@pytest.mark.parametrize("name", ["chain22", "puma560", "four_bar"])
def test_models_without_equal_limbs_have_no_limb_vectors(name: str) -> None:
    assert not VECTOR.findall(text(MODELS[name], "forward_dynamics"))


def test_rows_of_equal_parts_are_loops() -> None:
    """Loops leave less to be compiled; vectors would stay out of them."""
    stated = text(n_four_bar(20), "forward_dynamics")
    assert "for (i = 0; i < " in stated and not VECTOR.findall(stated)


def test_vectors_have_no_cyclic_dependences() -> None:
    """A vector of the second limb's end and the first one's would wait for a pack, whose other lane waits for it."""
    g = Graph()
    q = [g.input("q", i) for i in range(2 * JOINTS)]
    first = g.mul(g.mul(q[0], q[1]), g.mul(q[2], q[2]))
    other = g.mul(g.mul(q[3], q[4]), g.mul(q[4], q[5]))
    outer = g.mul(first, q[0])
    lanes = (g.input("v", 0), outer, g.input("v", 1), g.input("v", 2), *[ZERO] * (WIDTH - 4))
    _, pack = linear_combination(g, [(q[5], (ONE, Pack(lanes))), (q[4], (ONE, Pack(lanes)))])
    second = g.mul(other, pack.lanes[0])
    edges = [second, cubed(g, second), cubed(g, outer), *pack.lanes[1:4]]
    nodes = needed_nodes(g, edges)
    packs = PackPlan(g, nodes, {}, edges)
    made = LimbPlan(g, packs.nodes, {}, edges, limbs_of(2), packs)
    assert packs.vectors and not {abs(outer), abs(second)} & made.vector_of_node.keys()


def test_limb_vectors_leave_operands_of_packs_and_sines() -> None:
    def limb(g: Graph, q: Joint, k: int) -> Edge:
        return cubed(g, g.apply("sin", g.mul(g.add(g.mul(q(0), q(1)), q(2)), q(1))))

    graph, edges = of_limbs(2, limb)
    made = plan(graph, 2, edges)
    sines = [node for node, op in enumerate(graph.op) if op == "sin"]
    angles = needed_nodes(graph, [graph.args[node][0] for node in sines])
    assert made.vector_of_node and not {*sines, *angles} & made.vector_of_node.keys()
    program = Compilation(quadruped(), sf.Options(functions=("forward_dynamics_derivatives",))).program
    edges = program.functions[0].edges()
    packs = PackPlan(program.graph, needed_nodes(program.graph, edges), {}, edges)
    made = LimbPlan(program.graph, packs.nodes, {}, edges, program.limbs, packs)
    assert packs.vector_of_node and not packs.vector_of_node.keys() & made.vector_of_node.keys()


def test_a_chain_has_no_groups() -> None:
    """As long a chain as a function has operations."""
    assert not list(strongly_connected({i: {i - 1} for i in range(1, 50_000)}))


@given(st.lists(st.tuples(st.integers(0, 9), st.integers(0, 9)), max_size=25))
def test_groups_are_strongly_connected_components(pairs: list[tuple[int, int]]) -> None:
    needs: dict[int, set[int]] = {}
    for a, b in pairs:
        needs.setdefault(a, set()).add(b)
    reached = {a: {a} for a in range(10)}
    for _ in range(10):
        for a, others in needs.items():
            reached[a] |= {c for b in others for c in reached[b]}
    groups = {frozenset(b for b in reached[a] if a in reached[b]) for a in range(10)}
    groups = {group for group in groups if len(group) > 1 or any(a in needs.get(a, ()) for a in group)}
    assert {frozenset(group) for group in strongly_connected(needs)} == groups
