"""Vectors of limbs: the bits of the graph, whatever the limbs compute, read and share."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from ruamel.yaml import YAML

from symofros.base import routes
from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import evaluate_edges
from symofros.expr.ops import STOP_GRADIENT
from symofros.expr.program import Output, Program
from symofros.generator.codegen import function
from symofros.generator.codegen.function import FunctionWriter
from symofros.native import native_text
from tests.generator.codegen.limbs.graphs import JOINTS, cubed, of_limbs, program
from tests.generator.codegen.test_loops import compiled

Joint = Callable[[int], Edge]
# (operation, two operands, whether it is stored); an operand is (kind, number), see `_operand`.
Step = tuple[str, tuple[tuple[str, int], tuple[str, int]], bool]
_OPERANDS = st.tuples(
    st.sampled_from(
        ["own", "own", "joint", "common", "total", "neighbour", "number", "same number", "mirrored", "one's own"]
    ),
    st.integers(0, 11),
)
_STEPS = st.tuples(
    st.sampled_from(["add", "sub", "mul", "mul", "div", "stop"]), st.tuples(_OPERANDS, _OPERANDS), st.booleans()
)
STEPS: dict[str, list[Step]] = {
    name: [(operation, ((kind, a), (other, b)), stored) for operation, (kind, a), (other, b), stored in steps]
    for name, steps in YAML(typ="safe").load(Path(__file__).with_name("steps.yaml")).items()
}


def limbs(steps: list[Step], count: int, numbers_first: bool = False) -> tuple[Program, tuple[Output, ...]]:
    """A function that does the steps in turn for each of several limbs, then again from what these add up to.

    Args:
        steps: Steps.
        count: Number of limbs.
        numbers_first: Whether numbers are the first factors of products, as nodes that were made first are; else they
            are the last ones.
    """
    graph = Graph()
    for number in range(12 * numbers_first):
        graph.constant(0.25 + number)
        for limb in range(count):
            graph.constant(0.7 + 0.1 * number + 0.3 * limb)
    joints = [[graph.input("q", JOINTS * k + j) for j in range(JOINTS)] for k in range(count)]
    common = [graph.input("q", JOINTS * count + i) for i in range(3)]
    common = [graph.add(common[0], common[1]), graph.mul(common[1], common[2]), common[2]]
    total, stored = common[0], list[Edge]()
    for _ in range(2):
        parts: list[list[Edge]] = []
        for k in range(count):
            own: list[Edge] = []
            for operation, operands, is_stored in steps:
                a, b = (_operand(graph, operand, k, own, parts, joints, common, total) for operand in operands)
                if operation == "stop":
                    edge = graph.mul(graph.apply(STOP_GRADIENT, a), b)
                else:
                    edge = getattr(graph, operation)(a, b)
                own.append(edge if edge != 0 and abs(edge) not in graph.value else joints[k][0])
                stored += [own[-1]] * is_stored
            parts.append(own)
        for own in parts:
            total = graph.add(total, own[-1])
    return program(graph, count, [*stored, total])


def _operand(
    graph: Graph,
    operand: tuple[str, int],
    limb: int,
    own: list[Edge],
    parts: list[list[Edge]],
    joints: list[list[Edge]],
    common: list[Edge],
    total: Edge,
) -> Edge:
    kind, number = operand
    if kind == "own" and own:
        return own[number % len(own)]
    if kind == "neighbour" and parts:
        return parts[-1][number % len(parts[-1])]
    if kind == "common":
        return common[number % len(common)]
    if kind == "total":
        return total
    if kind == "number":
        return graph.constant(0.7 + 0.1 * number + 0.3 * limb)
    if kind == "same number":
        return graph.constant(0.25 + number)
    if kind == "mirrored":
        return graph.constant((-1.0) ** limb * (0.25 + number))
    if kind == "one's own":
        # Of another form in each limb.
        edge = joints[limb][1]
        for _ in range(limb + 1):
            edge = graph.add(graph.mul(edge, joints[limb][2]), graph.constant(0.1))
        return edge
    return joints[limb][number % JOINTS]


def assert_exact(made: tuple[Program, tuple[Output, ...]], folder: Path, seed: int = 0) -> str:
    """Vectors wherever there may be some compute what the graph states, to the bit; returns the text."""
    stated, (output,) = made
    q = np.random.default_rng(seed).uniform(0.5, 1.5, stated.sizes["q"])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(routes, "LIMB_SHARE", 0.0)
        patch.setattr(function, "MAX_STATEMENTS", 10)
        text = FunctionWriter(stated, "f", ["q"], [output], limbs=True).text()
    run = compiled(native_text("model/limbs.c.in") + text.code, text.work, folder)
    expected = [float(np.ravel(x)[0]) for x in evaluate_edges(stated, output.edges, {"q": q[None]}, {})]
    np.testing.assert_array_equal(run(q, len(expected))[0], expected)
    return text.code


@settings(max_examples=25)
@given(st.lists(_STEPS, min_size=1, max_size=14), st.integers(2, 6), st.booleans(), st.integers(0, 3))
@example(STEPS["ends"], 2, False, 0)
@example(STEPS["ends"], 3, True, 0)
@example(STEPS["mirrored"], 4, False, 0)
@example(STEPS["mirrored"], 4, True, 0)
@example(STEPS["contradicting"], 2, False, 0)
@example(STEPS["contradicting"], 5, True, 0)
@example(STEPS["turned"], 2, False, 0)
@example(STEPS["turned"], 2, True, 0)
@example(STEPS["waiting"], 2, False, 0)
@example(STEPS["waiting"], 4, True, 0)
def test_vectors_compute_the_bits_of_the_graph(
    tmp_path_factory: pytest.TempPathFactory, steps: list[Step], count: int, numbers_first: bool, seed: int
) -> None:
    assert_exact(limbs(steps, count, numbers_first), tmp_path_factory.mktemp("limbs"), seed)


def stopped(g: Graph, q: Joint, k: int) -> Edge:
    """A sum whose gradient is stopped, as the first factor of a product: its brackets must not go with it."""
    total = g.apply(STOP_GRADIENT, g.add(g.mul(q(0), q(1)), g.mul(q(1), q(2))))
    return g.mul(total, g.mul(q(2), q(2)))


def turned(g: Graph, q: Joint, k: int) -> Edge:
    """A sum that is added here and subtracted there, and has no number that could tell the limbs apart."""
    first, second = g.mul(q(0), q(1)), g.add(g.mul(q(1), q(2)), g.mul(q(2), q(0)))
    return cubed(g, g.add(first, second) if k else g.sub(first, second))


def number_of_one_limb(g: Graph, q: Joint, k: int) -> Edge:
    """A product with a number in one limb and not in the other, that is added here and subtracted there."""
    first, moved = g.mul(q(0), q(1)), g.mul(g.mul(q(1), q(2)), q(0))
    scaled = g.mul(moved, g.mul(q(2), q(2)) if k else g.constant(0.3))
    return cubed(g, g.add(first, scaled) if k else g.sub(first, scaled))


@pytest.mark.parametrize("limb", [stopped, turned, number_of_one_limb])
def test_brackets_and_signs_match_the_graph(limb: Callable[[Graph, Joint, int], Edge], tmp_path: Path) -> None:
    graph, edges = of_limbs(2, limb)
    assert "sym_pair p" in assert_exact(program(graph, 2, edges), tmp_path)


@pytest.mark.parametrize(("count", "types"), [(2, {"sym_pair"}), (3, {"sym_quad"}), (4, {"sym_quad"})])
def test_unused_lanes_repeat_the_first_limb(count: int, types: set[str], tmp_path: Path) -> None:
    """A zero there would be divided by, which programs that trap floating-point exceptions stop at."""

    def limb(g: Graph, q: Joint, k: int) -> Edge:
        moved = g.add(g.mul(q(0), g.constant(0.5 + k)), q(1))
        return g.div(g.mul(moved, q(2)), g.add(moved, g.mul(q(1), q(2))))

    graph, edges = of_limbs(count, limb)
    text = assert_exact(program(graph, count, edges), tmp_path)
    assert {kind for kind in ("sym_pair", "sym_quad") if kind in text} == types
    assert "0.0" not in text.replace("double", "")
