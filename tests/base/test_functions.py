"""The table of model functions is what models, equations and methods say."""

from __future__ import annotations

import inspect
from functools import cache

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.base.functions import (
    FUNCTIONS,
    INPUTS,
    generated_with,
    size_of,
)
from symofros.compiler import Compilation
from symofros.mechanics.dynamics.equations import Equations
from symofros.mechanics.dynamics.frame_equations import FrameEquations

# Functions with a method of their own, which has another name only where it returns a part of the outputs.
METHODS = {name: name for name in FUNCTIONS if hasattr(sf.Model, name)} | {"closure_wrenches": "closure_wrench"}
# Arguments that methods have besides the inputs of the function.
FRAME = {"slider_crank": "rod", "double_pendulum": "tip"}
FURTHER = {"self", "par", "u", "z", "frame", "multipliers", "name", "on", "joint_terms", "minimum_velocity"}


@cache
def model(name: str) -> sf.Model:
    """All functions of a model, those of frames of one frame."""
    options = sf.Options(functions=tuple(FUNCTIONS), frames=(FRAME[name],), backend="interpreter")
    return sf.compile(MODELS[name], options)


@pytest.mark.parametrize("name", ["slider_crank", "double_pendulum"])
@pytest.mark.parametrize("function", FUNCTIONS)
def test_functions_have_the_inputs_and_shapes_of_the_table(name: str, function: str) -> None:
    m, row = model(name), FUNCTIONS[function]
    bound = m.bind(function, FRAME[name] if row.of_frame else "")
    sizes = {"nq": m.nq, "nv": m.nv, "nu": m.nu, "nc": m.nc, "npar": m.npar, "nw": len(m.record.wrench_names)}
    tree = Compilation(MODELS[name]).tree
    sizes |= {
        "npi": 10 * len(tree.links),
        "ni": 0,  # Formulas of theirs have no instants: tests/expr/test_instants.py.
        "nj": len(m.names.joints),
        "nf": len(m.names.sections),
        "nk": len(m.names.contacts),
        "ns": len(m.names.prescribed),
        "nb": len(m.beams()),
        "nz": len(m.mass_matrix_pattern()[0]),
    }
    inputs = [group for group in row.inputs if group != "gains" or m.nc]
    assert [group for group in bound.inputs if group in row.inputs] == inputs
    assert all(array.shape == (size_of(INPUTS[group][0], sizes),) for group, array in bound.inputs.items())
    outputs = [(array.name, array.sizes(sizes)) for array in row.outputs]
    if function == "forward_dynamics" and not m.nc:
        outputs = outputs[:1]
    assert [(label, array.shape) for label, array in bound.outputs.items()] == outputs


def test_any_function_can_be_evaluated_by_name(rng: np.random.Generator) -> None:
    m = sf.compile(MODELS["double_pendulum"], sf.Options(backend="interpreter"))
    q, v = m.random_state(rng)
    np.testing.assert_array_equal(m.evaluate("mass_matrix", q=q)[0], m.mass_matrix(q))
    p, _, M = m.evaluate("momentum", q=q, v=v)
    np.testing.assert_allclose(p, M @ v)
    frame = m.names.frames[-1]
    np.testing.assert_array_equal(m.evaluate("frame_jacobian", frame, q=q)[0], m.frame_jacobian(frame, q))


@pytest.mark.parametrize(
    ("name", "inputs", "words"),
    [
        ("mass_matrx", {"q": [0.0, 0.0]}, "did you mean 'mass_matrix'"),
        ("mass_matrix", {"qq": [0.0, 0.0]}, "no input 'qq'"),
        ("bias", {"q": [0.0, 0.0]}, "bias: no v"),
        ("frame_pose", {"q": [0.0, 0.0]}, "no function 'frame_pose'"),
    ],
)
def test_functions_that_cannot_be_evaluated_are_refused(name: str, inputs: dict[str, list[float]], words: str) -> None:
    m = sf.compile(MODELS["double_pendulum"], sf.Options(backend="interpreter"))
    with pytest.raises((sf.UnknownNameError, sf.ShapeError), match=words):
        m.evaluate(name, **inputs)


@pytest.mark.parametrize("function", FUNCTIONS)
def test_every_output_names_an_attribute_of_the_equations(function: str) -> None:
    row = FUNCTIONS[function]
    if not row.by_solver:
        assert all(hasattr(FrameEquations if row.of_frame else Equations, array.source) for array in row.outputs)


@pytest.mark.parametrize("function", METHODS)
def test_methods_take_the_inputs_of_the_table(function: str) -> None:
    """In its order; inputs with a default are passed by name."""
    parameters = inspect.signature(getattr(sf.Model, METHODS[function])).parameters
    inputs = FUNCTIONS[function].inputs
    positional = [name for name, p in parameters.items() if name in inputs and p.default is inspect.Parameter.empty]
    assert positional == [group for group in inputs if group in positional]
    assert set(inputs) - {"u"} <= set(parameters)
    # Forces of rigid contacts are those of their constraints.
    assert set(parameters) - set(inputs) - ({"lam"} if function == "contact_forces" else set()) <= FURTHER


def test_functions_generated_together_are_listed_for_trees_and_closed_loops() -> None:
    assert generated_with("mass_matrix", True) == ("mass_matrix",)
    assert generated_with("forward_dynamics", True) == ("forward_dynamics", "project")
    assert generated_with("forward_dynamics", False) == ("forward_dynamics",)
    assert generated_with("project", False) == ("project",)
    assert generated_with("kinetic_energy", False) == ("kinetic_energy", "potential_energy")
    assert generated_with("constraint", True) == ("constraint", "constraint_rate", "constraint_jacobian")


def test_constraint_functions_of_a_tree_are_generated_together() -> None:
    """A compiler starts once for all of it."""
    empty = generated_with("constraint", False)
    stated = {name for name, row in FUNCTIONS.items() if row.constrained_only and not row.transposes}
    assert set(empty) == stated - {"project"}
    assert all(generated_with(name, False) == empty for name in empty)


@pytest.mark.parametrize("name", ["slider_crank", "double_pendulum"])
def test_rest_stiffness_equals_the_residual_derivative_at_rest(name: str, rng: np.random.Generator) -> None:
    m, (q, _) = model(name), model(name).random_state(rng)
    u, lam, still = rng.normal(size=m.nu), rng.normal(size=m.nc), np.zeros(m.nv)
    (K,) = m.evaluate("rest_stiffness", q=q, u=u, lam=lam)
    by_q, _, _ = m.residual_derivatives(q, still, still, u, lam)
    np.testing.assert_allclose(K, by_q[: m.nv], atol=1e-13 * np.abs(by_q).max())
