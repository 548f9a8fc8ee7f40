"""Edges in another graph: the same values, the same sharing, the same packs."""

from __future__ import annotations

import numpy as np
import pytest

from reference_models import MODELS
from symofros.compiler import program_of
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import interpret, needed_nodes
from symofros.expr.packs.check import check_packs
from symofros.expr.program import Function, Output, Program
from symofros.expr.substitute import copy_into
from tests.models import sampled


def copied(name: str, function: str, fixed: dict[str, float]) -> tuple[Program, Program, Function, Function]:
    """A model's function, and the same in a graph of its own, with some inputs fixed."""
    program = program_of(MODELS[name], [function])
    stated = program.functions[0]
    into = Graph()
    into.call("sin", into.input("other", 0))  # Other things live there already.
    replacement = {}
    for node, slot in program.graph.slot.items():
        key = f"{slot.group}[{slot.index}]"
        replacement[node] = into.constant(fixed[key]) if key in fixed else into.input(slot.group, slot.index)
    edges = copy_into(into, program.graph, [edge for o in stated.outputs for edge in o.edges], replacement)
    outputs, at = [], 0
    for output in stated.outputs:
        outputs.append(Output(output.name, output.shape, tuple(edges[at : at + len(output.edges)])))
        at += len(output.edges)
    function = Function(stated.name, stated.frame, stated.inputs, tuple(outputs))
    return program, Program(program.name, into, program.sizes, (function,)), stated, function


@pytest.mark.parametrize(
    "name", sampled(("rx90", "chain22", "mss", "random_tree70", "planar_robot"), ("rx90", "planar_robot"))
)
@pytest.mark.parametrize("fixed", [{}, {"q[0]": 0.0, "q[2]": 0.5, "v[1]": 0.0}])
def test_substituted_graphs_have_the_same_values(name: str, fixed: dict[str, float]) -> None:
    program, other, stated, function = copied(name, "forward_dynamics", fixed)
    rng = np.random.default_rng(1)
    inputs = {group: rng.normal(size=(3, size)) for group, size in program.sizes.items()}
    for group, defaults in (("par", MODELS[name].parameter_values().values()),):
        inputs[group] = np.array([list(defaults)] * 3).reshape(3, -1)
    for key, value in fixed.items():
        inputs[key[0]][:, int(key[2:-1])] = value
    pre = {"pre": np.zeros((3, len(program.init)))}
    if program.init:
        from symofros.generator.codegen.interpreted import InterpretedKernel

        pre["pre"] = InterpretedKernel(program, stated).prepare(inputs["par"])
    (expected,) = interpret(program, stated, inputs | pre, 3)
    (value,) = interpret(other, function, inputs, 3)
    assert np.abs(value - expected).max() <= 1e-9 * np.abs(expected).max()
    if not fixed:
        assert np.array_equal(value, expected)


@pytest.mark.parametrize("name", ["chain22", "mss"])
def test_packs_are_copied_with_the_graph(name: str) -> None:
    """As many lanes are computed alike as before."""
    program, other, stated, function = copied(name, "mass_matrix", {})
    before, after = lanes(program.graph, stated), lanes(other.graph, function)
    assert after > 0.97 * before > 100
    check_packs(other)


def lanes(graph: Graph, function: Function) -> int:
    """Lanes of packs that a function needs."""
    wanted = set(needed_nodes(graph, function.edges()))
    return sum(sum(abs(pack.lanes[lane]) in wanted for lane in pack.new_lanes) for pack in graph.packs)


def test_copying_with_unreplaced_inputs_raises() -> None:
    g = Graph()
    with pytest.raises(KeyError):
        copy_into(Graph(), g, [g.add(g.input("q", 0), g.input("q", 1))], {g.input("q", 0): 1})
