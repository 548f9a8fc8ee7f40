"""What the graph makes of expressions, and what is formed from graphs, as text; cases are in files of these names."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from symofros.expr.derivative import adjoint, partials
from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.expr.instants import operands_function
from symofros.expr.numerics.evaluate import interpret
from symofros.expr.packs.check import check_packs
from symofros.expr.program import Function, Output, Program
from symofros.expr.substitute import copy_into
from tests.program_text import Case, assert_golden, golden_cases, parse_program, program_text

# What takes the place of inputs in `substitute.txt`: a zero, a number, another input.
FIXED = {("x", 0): 0.0, ("x", 1): 0.5}
RENAMED = {("x", 4): ("x", 3)}


def with_outputs(program: Program, edges: list[Edge], name: str) -> Program:
    (function,) = program.functions
    return replace(program, functions=(replace(function, outputs=(Output(name, (len(edges),), tuple(edges)),)),))


def derivatives(program: Program) -> Program:
    """The Jacobian by x, without the packs of its columns."""
    g, (function,) = program.graph, program.functions
    rows = partials(g, function.edges(), [g.input("x", i) for i in range(program.sizes["x"])])
    g.packs.clear()
    return with_outputs(program, [edge for row in rows for edge in row], "y_x")


def gradient(program: Program) -> Program:
    g, (function,) = program.graph, program.functions
    edges = function.edges()
    weights = [g.input("w", i) for i in range(len(edges))]
    inputs = [g.input("x", i) for i in range(2)]
    return with_outputs(program, adjoint(g, edges, weights, inputs), "x_bar")


def instants(program: Program) -> Program:
    (function,) = program.functions
    found = operands_function("instants", program.graph, function.edges())
    return replace(program, functions=(replace(found, inputs=("t", "par")),))


def substituted(program: Program) -> Program:
    g, (function,) = program.graph, program.functions
    into = Graph()
    new = {
        node: into.constant(FIXED[at])
        if (at := (slot.group, slot.index)) in FIXED
        else into.input(*RENAMED.get(at, at))
        for node, slot in g.slot.items()
    }
    edges = copy_into(into, g, function.edges(), new)
    result = with_outputs(Program(program.name, into, program.sizes, program.functions), edges, "y")
    check_packs(result)
    return result


FORMS: dict[str, Callable[[Program], Program]] = {
    "folding": lambda program: program,
    "derivative": derivatives,
    "adjoint": gradient,
    "instants": instants,
    "substitute": substituted,
}
FORMED = [name for name in FORMS if name != "folding"]


@pytest.mark.parametrize("case", [case for name in FORMS for case in golden_cases(__file__, name)])
def test_formed_programs_match_the_golden_text(case: Case, request: pytest.FixtureRequest) -> None:
    assert_golden(case, lambda text: program_text(FORMS[case.path.stem](parse_program(text))), request)


def values(program: Program, given: dict[str, np.ndarray]) -> np.ndarray:
    function = program.functions[0]
    return np.concatenate([value[0] for value in interpret(program, function, given, 1)])


def state(program: Program, seed: int = 0) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(seed)
    return {group: rng.uniform(0.2, 0.9, (1, size)) for group, size in program.sizes.items()}


@pytest.mark.parametrize("case", golden_cases(__file__, "folding"))
def test_folded_expressions_have_the_values_of_pythons_own(case: Case) -> None:
    """The text as Python evaluates it, with NumPy's functions."""
    program = parse_program(case.stated)
    given = state(program)
    names = {group: value[0] for group, value in given.items()}
    names |= {"sign": np.sign, "step": lambda x: np.heaviside(x, 1.0), "min": np.minimum, "max": np.maximum}
    expected = list[float]()
    for line in case.stated.splitlines()[1:]:
        name, sign, stated = line.strip().partition(": ") if ": " in line else line.strip().partition(" = ")
        value = eval(f"({stated},)", {**vars(np), "atan2": np.arctan2, **names})
        if sign == ": ":
            expected += value
        names[name.rstrip("!")] = value[0]
    np.testing.assert_allclose(values(program, given), expected, rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize("case", golden_cases(__file__, "adjoint"))
def test_the_gradient_is_the_weighted_sum_of_the_derivatives(case: Case) -> None:
    stated = parse_program(case.stated)
    stated.graph.input("x", 1)
    stated.sizes["x"], outputs = 2, len(stated.functions[0].edges())
    given = state(stated) | {"w": np.array([[0.7, -1.3]])[:, :outputs]}
    jacobian = values(derivatives(stated), given).reshape(outputs, 2)
    np.testing.assert_allclose(
        values(gradient(parse_program(case.stated)), given), given["w"][0] @ jacobian, rtol=1e-13
    )


@pytest.mark.parametrize("case", golden_cases(__file__, "derivative"))
def test_derivatives_match_complex_steps_or_differences(case: Case) -> None:
    stated, h = parse_program(case.stated), 1e-6
    given, n = state(stated), stated.sizes["x"]
    plain = parse_program(case.stated)
    columns = []
    for i in range(n):
        step = h * np.eye(n)[i]
        ahead, behind = (values(plain, given | {"x": given["x"] + s * step}) for s in (1.0, -1.0))
        columns.append((ahead - behind) / (2 * h))
    expected = np.array(columns).T
    if "stop_gradient" in case.stated:
        expected[2, 0] = 0.0
    np.testing.assert_allclose(values(derivatives(stated), given), expected.ravel(), rtol=1e-8, atol=1e-8)


@pytest.mark.parametrize("case", golden_cases(__file__, "substitute"))
def test_substituted_expressions_have_the_values_of_the_numbers(case: Case) -> None:
    stated = parse_program(case.stated)
    given = state(stated)
    for (group, index), number in FIXED.items():
        given[group][0, index] = number
    if stated.sizes["x"] > 4:
        given["x"][0, 4] = given["x"][0, 3]
    np.testing.assert_allclose(
        values(substituted(parse_program(case.stated)), given), values(stated, given), rtol=1e-15
    )


def test_a_function_of_instants_states_the_kind_of_each_operand() -> None:
    program = instants(parse_program("f(t):\n  y: abs(t[0] - 1) + exp(t[0]) + sqrt(t[0])"))
    operand, kind = (output for output in program.functions[0].outputs)
    assert isinstance(program.functions[0], Function) and operand.shape == kind.shape == (3,)
    np.testing.assert_array_equal(values(program, {"t": np.array([[4.0]])}), [-3.0, 4.0, 4.0, 0.0, 1.0, 2.0])
