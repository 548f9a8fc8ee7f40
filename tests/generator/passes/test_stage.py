from __future__ import annotations

import numpy as np

import symofros as sf
from symofros.expr.graph import Graph
from symofros.expr.numerics.evaluate import needed_nodes
from symofros.expr.program import Function, Output, Program
from symofros.generator.passes import run_passes
from symofros.generator.passes.count import count_operations, count_program
from symofros.generator.passes.stage import hoist_parameters
from symofros.mechanics.dynamics.equations import Equations
from symofros.mechanics.dynamics.functions import Request, form_program
from symofros.mechanics.topology.tree import build_tree
from tests.models import system


def test_parameter_work_moves_to_init() -> None:
    raw = form_program(Equations(build_tree(system("parametrised0"))), [Request("mass_matrix")])
    staged = hoist_parameters(raw)
    before = count_operations(raw.graph, raw.functions[0].edges())
    counts = count_program(staged)
    init, rest = counts["init", ""], counts["mass_matrix", ""]
    assert init.total > 0 and rest.total < before.total
    assert init.total + rest.total == before.total
    for node in needed_nodes(staged.graph, staged.functions[0].edges(), staged.pre):
        assert all(
            staged.graph.slot[abs(arg)].group != "par"
            for arg in staged.graph.args[node]
            if abs(arg) in staged.graph.slot and abs(arg) not in staged.pre
        )


def test_constant_parameters_leave_no_init_work() -> None:
    staged = run_passes(form_program(Equations(build_tree(system("tree0"))), [Request("dynamics")]))
    assert staged.init == ()


def test_an_output_that_is_a_parameter_needs_no_work_per_call() -> None:
    """The mass matrix of a slider is its mass: nothing is left to compute per call."""
    slider = sf.RigidBody("b", sf.Joint("q", "prismatic"), sf.Inertia("m"))
    model = sf.compile(sf.System("s", [slider], [sf.Parameter("m", 3.0)]))
    np.testing.assert_array_equal(model.mass_matrix([0.5]), [[3.0]])
    np.testing.assert_array_equal(model.with_parameters(m=4.0).mass_matrix([[0.5], [0.6]]), [[[4.0]], [[4.0]]])


def test_parameter_terms_left_by_cancellation_are_hoisted() -> None:
    """3 (q0 + p0 p1 + q1 - q0 - q1) q2: a vector by states has no place for the product of a number and a parameter."""
    g = Graph()
    p, q = [g.input("par", i) for i in range(2)], [g.input("q", i) for i in range(3)]
    left, right = g.add(g.add(q[0], g.mul(*p)), q[1]), g.add(q[0], q[1])
    edge = g.mul(g.mul(g.constant(3.0), g.sub(left, right)), q[2])
    outputs = (Output("y", (1,), (edge,)),)
    program = run_passes(Program("p", g, {"q": 3, "par": 2}, (Function("f", "", ("q", "par"), outputs),)))
    function = program.functions[0]
    (node,) = needed_nodes(program.graph, function.edges(), program.pre)
    assert sorted(abs(arg) in program.pre for arg in program.graph.args[node]) == [False, True]
