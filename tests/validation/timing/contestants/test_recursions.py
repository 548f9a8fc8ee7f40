"""What the symbolic peers compute, and what goes over to engines."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import reference_models
import symofros as sf
from reference_models.rigid.chain import chain
from tests.models import sampled
from validation.adapters.casadi.links import in_world
from validation.adapters.casadi.tree import CasadiTree
from validation.mechanics.geometry import Array
from validation.timing.contestants.generated import casadi_loops
from validation.timing.contestants.symofros import our_loops
from validation.timing.race import error
from validation.timing.task import Task, task

FUNCTIONS = (
    "mass_matrix",
    "bias",
    "dynamics",
    "inverse_dynamics",
    "forward_dynamics",
    "frame_jacobian",
    "inverse_dynamics_derivatives",
    "forward_dynamics_derivatives",
    "inverse_dynamics_second_derivatives",
    "inverse_dynamics_vjp",
    "forward_dynamics_vjp",
)
# Rounding of a solve is amplified by the condition of M.
TOLERANCE = {"forward_dynamics": 1e-11, "forward_dynamics_derivatives": 1e-11, "forward_dynamics_vjp": 1e-11}


def evaluated(given: Task, name: str) -> Array:
    function = CasadiTree(given.system).function(name, given.body)
    states = given.states
    rows = []
    for state in zip(states.q, states.v, states.a, states.applied, strict=True):
        outputs = function.call(list(state))
        rows.append(np.concatenate([np.array(output).ravel() for output in outputs]))
    return np.array(rows)


def interpreted(given: Task, name: str) -> Array:
    """Ours without C."""
    model = sf.compile(given.system, sf.Options(backend="interpreter"))
    q, v, a, u = given.states.q, given.states.v, given.states.a, given.states.u
    parts = {
        "mass_matrix": lambda: [model.mass_matrix(q)],
        "bias": lambda: [model.bias(q, v)],
        "dynamics": lambda: [model.mass_matrix(q), model.bias(q, v)],
        "inverse_dynamics": lambda: [model.inverse_dynamics(q, v, a)],
        "forward_dynamics": lambda: [model.forward_dynamics(q, v, u)],
        "frame_jacobian": lambda: [model.frame_jacobian(given.frame, q)],
    }[name]()
    return np.concatenate([part.reshape(len(q), -1) for part in parts], axis=1)


@pytest.mark.parametrize("label", sampled(("planar3R", "ur5", "talos"), ["planar3R"]))
@pytest.mark.parametrize("name", FUNCTIONS[:6])
def test_casadis_recursions_agree_with_the_interpreter(label: str, name: str) -> None:
    given = task(label, 12)
    assert error(evaluated(given, name), interpreted(given, name)) < TOLERANCE.get(name, 1e-12)


FEW = ("dynamics",)  # Derivatives, by the interpreter in every run, take four compilations of five times the text.


@pytest.mark.parametrize(
    ("label", "names"),
    [
        ("planar2R", FEW),
        pytest.param("planar2R", FUNCTIONS, marks=pytest.mark.slow),
        pytest.param("panda", ("dynamics", "frame_jacobian"), marks=pytest.mark.slow),
    ],
)
def test_casadis_c_agrees_with_ours(label: str, names: tuple[str, ...]) -> None:
    """The same loops that are timed; derivatives, too."""
    given = task(label, 12)
    ours = {loop.function: loop for loop in our_loops(given, names) if loop.variant == "symofros"}
    theirs = list(casadi_loops(given, names))
    assert len(theirs) >= 2 * len(names), "two builds by each compiler"
    for loop in theirs:
        off = error(loop.results(), ours[loop.function].results())
        assert off < TOLERANCE.get(loop.function, 1e-12), (loop.function, loop.variant)


@pytest.mark.parametrize("name", ["ssrms", "open_chain_5r"])
def test_slides_and_armatures_are_in_the_recursions(name: str) -> None:
    """A joint that slides along an axis of no coordinate, with an armature."""
    system = reference_models.MODELS[name]
    bodies = list(system.bodies)
    last = bodies[-1]
    assert last.joint is not None
    bodies[-1] = replace(last, joint=replace(last.joint, kind="prismatic", axis=(1, 2, -1), armature=0.3))
    given = replace(task("planar2R", 8), system=replace(system, bodies=tuple(bodies)))
    model = sf.compile(given.system, sf.Options(backend="interpreter"))
    rng = np.random.default_rng(0)
    q, v = model.random_state(rng)
    tau, a = rng.standard_normal((2, model.nv))
    tree = CasadiTree(given.system)
    found = {
        name: np.array(tree.function(name, 0).call([q, v, a, tau])[0]).ravel()
        for name in ("mass_matrix", "bias", "inverse_dynamics", "forward_dynamics")
    }
    M, h = model.mass_matrix(q), model.bias(q, v)
    scale = np.abs(M).max() + np.abs(h).max()
    np.testing.assert_allclose(found["mass_matrix"], M.ravel(), atol=1e-12 * scale)
    np.testing.assert_allclose(found["bias"], h, atol=1e-12 * scale)
    np.testing.assert_allclose(found["inverse_dynamics"], M @ a + h, atol=1e-11 * scale)
    np.testing.assert_allclose(found["forward_dynamics"], np.linalg.solve(M, tau - h), rtol=1e-8, atol=1e-9)


def test_world_axes_give_the_same_inertia() -> None:
    tree = CasadiTree(chain(5, symbolic=False))
    import casadi

    both = [
        casadi.Function("M", [tree.q], [casadi.vertcat(*(x for row in tree._composite(links) for x in row))])
        for links in (tree.links, in_world(tree.links))
    ]
    q = np.random.default_rng(1).uniform(-3, 3, 5)
    np.testing.assert_allclose(*(np.array(M(q)) for M in both), rtol=1e-12, atol=1e-13)


def test_what_recursions_are_not_for_is_named() -> None:
    with pytest.raises(ValueError, match="a rotor|no .* joint"):
        CasadiTree(reference_models.MODELS["joint_zoo"])


@pytest.mark.parametrize(
    ("joints", "names"),
    [
        (2, ("dynamics",)),
        pytest.param(3, ("mass_matrix", "bias", "dynamics", "forward_dynamics"), marks=pytest.mark.slow),
    ],
)
def test_kanes_c_agrees_with_ours(joints: int, names: tuple[str, ...]) -> None:
    from validation.timing.contestants.generated import sympy_loops

    given = task(f"planar{joints}R", 12)
    ours = {loop.function: loop for loop in our_loops(given, names) if loop.variant == "symofros"}
    for loop in sympy_loops(given, names):
        off = error(loop.results(), ours[loop.function].results())
        assert off < TOLERANCE.get(loop.function, 1e-12), (loop.function, loop.variant)


@pytest.mark.slow  # In every run: single states by the same recursions.
def test_batches_compute_what_single_states_do() -> None:
    """Over a last block that is not full."""
    given = task("planar3R", 100)
    one, rows, columns, floats = our_loops(given, ["dynamics"])
    assert error(rows.results(), one.results()) < 1e-13
    assert error(columns.results(), one.results()) < 1e-13
    assert 1e-9 < error(floats.results(), one.results()) < 1e-5


def test_closures_go_over_as_numbers() -> None:
    from validation.adapters.pinocchio import loops as pinocchio_loops
    from validation.contract.interface import Subject, Unsupported

    engine = pinocchio_loops.build(Subject("four_bar", reference_models.MODELS["four_bar"]))
    assert not isinstance(engine, Unsupported)
    (line,) = engine.ties_as_numbers()
    # A point of rocker and coupler: kind, then twice joint, R 9, p 3.
    words = line.split()
    assert len(words) == 1 + 2 * 13 and [words[0], words[1], words[14]] == ["3", "3", "2"]
    assert [float(x) for x in words[11:14]] == [1.0, 0.0, 0.0]
