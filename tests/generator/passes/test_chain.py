from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from reference_models import MODELS
from reference_models.rigid.chain import chain
from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import evaluate_edges, interpret, needed_nodes
from symofros.expr.ops import ADD, MUL
from symofros.expr.packs.check import check_packs
from symofros.expr.program import Function, Output, Program
from symofros.generator.passes.chain import chain_sums
from symofros.generator.passes.count import count_program
from symofros.generator.passes.stage import hoist_parameters
from symofros.mechanics.dynamics.equations import Equations
from symofros.mechanics.dynamics.functions import Request, form_program
from symofros.mechanics.topology.tree import build_tree
from tests.models import system

SIZE = 6
PRIME = 2**61 - 1


def program_of(g: Graph, edges: list[Edge]) -> Program:
    outputs = (Output("y", (len(edges),), tuple(edges)),)
    return Program("p", g, {"x": SIZE}, (Function("f", "", ("x",), outputs),))


def value_of(program: Program, x: np.ndarray) -> np.ndarray:
    return interpret(program, program.functions[0], {"x": x[None, :]}, 1)[0][0]


def evaluated(program: Program, given: dict[str, np.ndarray]) -> list[np.ndarray]:
    """The outputs of the first function, with parameters of their own for each state."""
    pre = [np.broadcast_to(value, len(given["q"])) for value in evaluate_edges(program, program.init, given, {})]
    return interpret(program, program.functions[0], given | {"pre": np.array(pre).T}, len(given["q"]))


def remainders(program: Program) -> list[int]:
    """Outputs at whole numbers, modulo a prime: equal for equal polynomials only, but for chance."""
    g, edges = program.graph, program.functions[0].edges()
    values = {0: 0} | {node: 1000003 * (slot.index + 2) for node, slot in g.slot.items()}
    values |= {node: int(value) for node, value in g.value.items()}

    def at(edge: Edge) -> int:
        return values[abs(edge)] if edge >= 0 else -values[-edge]

    for node in needed_nodes(g, edges):
        a, b = map(at, g.args[node])
        values[node] = (a + b if g.op[node] == ADD else a * b) % PRIME
    return [at(edge) % PRIME for edge in edges]


def fused(program: Program) -> int:
    """Instructions of a processor that adds a product in one."""
    g, edges = program.graph, program.functions[0].edges()
    nodes = needed_nodes(g, edges, program.pre)
    read = [abs(arg) for node in nodes for arg in g.args[node]] + [abs(edge) for edge in edges]
    added = [abs(arg) for node in nodes if g.op[node] == ADD for arg in g.args[node]]
    free = {node for node in nodes if g.op[node] == MUL and read.count(node) == added.count(node)}
    count = len([node for node in nodes if g.op[node] != MUL or node not in free])
    for node in nodes:
        if g.op[node] == ADD and set(map(abs, g.args[node])) <= free:
            free.discard(abs(g.args[node][1]))
            count += 1
    return count


def test_terms_that_are_not_products_come_first() -> None:
    g = Graph()
    x = [g.input("x", i) for i in range(SIZE)]
    early = g.add(g.mul(x[0], x[1]), g.mul(x[2], x[3]))
    program = program_of(g, [g.sub(early, x[4])])
    chained = chain_sums(program)
    assert (fused(program), fused(chained)) == (3, 2)
    at = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    assert value_of(chained, at) == value_of(program, at) == 9.0


_STEPS = st.lists(
    st.tuples(st.sampled_from([ADD, MUL]), st.integers(0, 40), st.integers(0, 40), st.booleans(), st.booleans()),
    min_size=3,
    max_size=40,
)


@given(_STEPS)
def test_chain_sums_keep_values_and_reduce_instructions(steps: list[tuple[str, int, int, bool, bool]]) -> None:
    g = Graph()
    edges: list[Edge] = [g.input("x", i) for i in range(SIZE)]
    for op, i, j, minus, other in steps:
        a, b = edges[i % len(edges)], edges[j % len(edges)]
        edges.append(g.apply(op, -a if minus else a, -b if other else b))
    program = program_of(g, edges[-2:])
    chained = chain_sums(program)
    before, after = count_program(program)["f", ""].total, count_program(chained)["f", ""].total
    assert after <= before
    assert remainders(chained) == remainders(program)


@pytest.mark.parametrize("name", ["tree0", "parametrised0", "parametrised1"])
def test_chain_sums_reduce_the_instructions_of_models(name: str) -> None:
    staged = hoist_parameters(form_program(Equations(build_tree(system(name))), [Request("dynamics")]))
    chained = chain_sums(staged)
    check_packs(chained)
    assert fused(chained) < fused(staged)
    rng = np.random.default_rng(3)
    given = {key: rng.uniform(0.5, 1.5, (5, size)) for key, size in staged.sizes.items() if key != "pre"}
    for value, expected in zip(evaluated(chained, given), evaluated(staged, given), strict=True):
        np.testing.assert_allclose(value, expected, rtol=0, atol=1e-13 * np.max(np.abs(expected), initial=1.0))


def test_packs_survive_chain_sums() -> None:
    """A chain, whose columns of M share vectors, loses no lane, and every pack stays valid."""
    staged = hoist_parameters(
        form_program(Equations(build_tree(chain(16))), [Request("dynamics"), Request("forward_dynamics")])
    )
    chained = chain_sums(staged)
    check_packs(chained)
    lanes = [
        sum(abs(pack.lanes[lane]) in needed for pack in program.graph.packs for lane in pack.new_lanes)
        for program in (staged, chained)
        for needed in (set(needed_nodes(program.graph, f.edges(), program.pre)) for f in program.functions)
    ]
    assert lanes[:2] == lanes[2:] and min(lanes) > 100


def test_sums_are_not_split_for_other_functions() -> None:
    """A tree's energy is formed in the same order with and without the other functions."""
    tree = build_tree(system("tree0"))
    names = ("dynamics", "kinetic_energy", "mass_matrix")
    alone, among = (
        chain_sums(hoist_parameters(form_program(Equations(tree), [Request(name) for name in chosen])))
        for chosen in (names[1:2], names)
    )
    rng = np.random.default_rng(0)
    given = {key: rng.uniform(-1.0, 1.0, (9, size)) for key, size in among.sizes.items()}
    one, other = (interpret(p, next(f for f in p.functions if f.name == names[1]), given, 9) for p in (alone, among))
    np.testing.assert_array_equal(one[0], other[0])


@pytest.mark.parametrize(
    ("name", "function"),
    [
        ("chain22", "dynamics"),
        pytest.param("grasp", "residual_derivatives", marks=pytest.mark.slow),
        pytest.param("mss", "inverse_dynamics_derivatives", marks=pytest.mark.slow),
        pytest.param("spdm", "forward_dynamics_derivatives", marks=pytest.mark.slow),
    ],
)
def test_packs_equal_their_scalar_sums(name: str, function: str) -> None:
    """Each lane that a function needs is the sum that its pack states, to the bit, of lanes that are there."""
    staged = hoist_parameters(form_program(Equations(build_tree(MODELS[name])), [Request(function)]))
    for program in (staged, chain_sums(staged)):
        g, edges = program.graph, program.functions[0].edges()
        needed = {*needed_nodes(g, edges, program.pre), *program.pre, *g.value, *g.slot}
        used = [(pack, lane) for pack in g.packs for lane in pack.exact_lanes if abs(pack.lanes[lane]) in needed]
        # A lane of which an operand is not needed is put into the vector as a scalar.
        needed.add(0)
        used = [(p, i) for p, i in used if all(abs(o.lanes[i]) in needed for _, o in p.terms)]
        assert len(used) > 50
        rng = np.random.default_rng(1)
        given = {key: rng.uniform(-1.0, 1.0, (3, size)) for key, size in program.sizes.items()}
        read = [edge for p, i in used for f, o in p.terms for edge in (p.lanes[i], f, o.lanes[i])]
        values = dict(zip(read, evaluate_edges(program, read, given, {}), strict=True))
        for pack, lane in used:
            total = sum((values[f] * values[o.lanes[lane]] for f, o in pack.terms), np.zeros(3))
            np.testing.assert_array_equal(total, values[pack.lanes[lane]], strict=False)
