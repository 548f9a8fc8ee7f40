"""Derivatives of inverse and forward dynamics: Pinocchio's on every rigid model, and differences in 40 digits.

Pinocchio's derivatives are wrong for joints whose axes depend on their coordinates (universal, Euler angles, composite
ones): its adapter builds those of simple joints in series, which are the same joint and which it does right. General
joints that are no series have no counterpart there; for them, and for all the kinds once more, the equations themselves
are differenced in extended precision.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import mpmath
import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.tools import evaluate_precisely
from tests.late import require
from tests.models import sampled
from validation.adapters.charted import ChartedEngine
from validation.adapters.compiled import SymofrosEngine
from validation.adapters.pinocchio import loops as pinocchio_loops
from validation.adapters.pinocchio import tree as trees
from validation.comparison.loops import assembled_states
from validation.comparison.variants import with_forces
from validation.contract.interface import States, Subject, Unsupported
from validation.inputs.sampling import sample
from validation.mechanics.assembly import assemble

pin = require("pinocchio", "validation")
Array = np.ndarray
TOLERANCE = 1e-10
FUNCTIONS = ("inverse_dynamics_derivatives", "forward_dynamics_derivatives")


def without_forces(system: sf.System) -> sf.System:
    """Engines know inertia and weight; efforts and elements are the description's."""
    bodies = [replace(b, joint=b.joint and replace(b.joint, elements=(), effort=()), loads=()) for b in system.bodies]
    return replace(system, bodies=tuple(bodies), connections=(), virtual_power=(), potentials=())


def is_rigid(system: sf.System) -> bool:
    return not any(isinstance(body, sf.Beam) for body in system.bodies)


RIGID = tuple(name for name in MODELS if is_rigid(MODELS[name]) and not MODELS[name].constraints)
TREES = tuple(name for name in RIGID if name != "gyroscope")
# Each kind of joint, rotors, wheels, short chains; long chains and wide trees take seconds each to generate.
TAKE_SECONDS = ("car", "mss", "spdm", "ssrms", "puma560", "rx90", "stanford_arm", "space_arm", "friction_arm")
SMALL = tuple(name for name in TREES if not name.startswith(("chain", "random_tree")) and name not in TAKE_SECONDS)


def test_only_the_gyroscope_is_left_out() -> None:
    """Pinocchio has no rotors that turn: the rule that picks the models drops nothing else."""
    for name in RIGID:
        engine = trees.build(Subject(name, without_forces(MODELS[name])))
        assert isinstance(engine, Unsupported) == (name not in TREES)


@pytest.mark.parametrize("name", sampled(TREES, SMALL))
def test_derivatives_match_pinocchio(name: str) -> None:
    """computeRNEADerivatives and computeABADerivatives, in our coordinates."""
    system = without_forces(MODELS[name])
    engine = trees.build(Subject(name, system))
    assert isinstance(engine, ChartedEngine)
    m = sf.compile(system, sf.Options(functions=FUNCTIONS))
    rng = np.random.default_rng(3)
    for _ in range(3):
        q, v = m.random_state(rng)
        a = rng.normal(size=m.nv)
        # Its charts of trees are permutations: derivatives turn as M does.
        T, data = engine.chart.transform(q[None])[0], engine.model.createData()
        q_e = engine.chart.coordinates(q[None])[0]
        pin.computeRNEADerivatives(engine.model, data, q_e, T @ v, T @ a)
        # Copies: the next call writes there as well.
        found = [np.array(data.dtau_dq), np.array(data.dtau_dv)]
        pin.computeABADerivatives(engine.model, data, q_e, T @ v, np.zeros(m.nv))
        found += [np.array(data.ddq_dq), np.array(data.ddq_dv)]
        ours = [*m.inverse_dynamics_derivatives(q, v, a), *m.forward_dynamics_derivatives(q, v, np.zeros(m.nu))[:2]]
        for one, other in zip(ours, found, strict=True):
            theirs = T.T @ np.reshape(other, one.shape) @ T
            assert np.abs(one - theirs).max() <= TOLERANCE * max(1.0, np.abs(theirs).max())


SOLID = sf.Inertia(1.5, (0.1, -0.2, 0.05), (0.3, 0.4, 0.5))
Z_X_Z = sf.Rotation.matrix(
    [
        ["cos(a)*cos(c) - sin(a)*cos(b)*sin(c)", "-cos(a)*sin(c) - sin(a)*cos(b)*cos(c)", "sin(a)*sin(b)"],
        ["sin(a)*cos(c) + cos(a)*cos(b)*sin(c)", "-sin(a)*sin(c) + cos(a)*cos(b)*cos(c)", "-cos(a)*sin(b)"],
        ["sin(b)*sin(c)", "sin(b)*cos(c)", "cos(b)"],
    ]
)
JOINTS = {
    "universal": sf.Joint("j", "universal", "base", axis=(1, 0, 0), axis2=(0, 0.6, 0.8)),
    "Euler angles": sf.Joint(
        "j", "general", "base", coordinates=("a", "b", "c"), moving_rotation=sf.Rotation.rpy("c", "b", "a")
    ),
    "Euler angles z-x-z": sf.Joint("j", "general", "base", coordinates=("a", "b", "c"), moving_rotation=Z_X_Z),
    "a curve": sf.Joint(
        "j",
        "general",
        "base",
        coordinates=("s",),
        moving_position=("cos(s)", "sin(s)", "s^2/4"),
        moving_rotation=sf.Rotation.rpy(0, 0, "s + s^3/6"),
    ),
    "planar": sf.Joint("j", "planar", "base"),
    "cylindrical": sf.Joint("j", "cylindrical", "base", axis=(0, 0.6, 0.8)),
    "screw": sf.Joint("j", "screw", "base", axis=(0, 0.6, 0.8), pitch=0.2),
}


def on_an_arm(kind: str) -> sf.System:
    """The joint between two hinges, so that what it carries and what carries it both turn."""
    frame = (sf.Frame("e", (0.4, 0.1, -0.2), sf.Rotation.rpy(0.3, -0.5, 0.7)),)
    return sf.System(
        "s",
        (
            sf.RigidBody("base", sf.Joint("first", "revolute", axis=(0, 1, 0)), SOLID, frame),
            sf.RigidBody("middle", replace(JOINTS[kind], frame="e"), SOLID, frame),
            sf.RigidBody("tip", sf.Joint("last", "revolute", "middle", "e", axis=(1, 0, 0)), SOLID),
        ),
    )


@pytest.mark.parametrize("kind", sampled(tuple(JOINTS), ("universal", "a curve", "planar")))
def test_derivatives_match_differences_in_40_digits(kind: str) -> None:
    """Speeds are rates of coordinates here, so q + h e_k moves along speed k."""
    system = on_an_arm(kind)
    program = sf.program_of(system, ("inverse_dynamics",))
    (function,) = program.functions
    m = sf.compile(system, sf.Options(functions=("inverse_dynamics_derivatives",)))
    rng = np.random.default_rng(1)
    q, v, a = rng.uniform(0.2, 1.2, m.nv), rng.normal(size=m.nv), rng.normal(size=m.nv)
    by_q, by_v = m.inverse_dynamics_derivatives(q, v, a)
    digits, h = 40, mpmath.mpf(10) ** -12

    def required(dq: Any, dv: Any) -> list[Any]:
        inputs = {"q": dq, "v": dv, "a": list(a), "par": list(m.parameters.values()), "u": [], "t": [0.0]}
        return evaluate_precisely(program, function, inputs, digits)[0]

    with mpmath.workdps(digits):
        for k in range(m.nv):
            step = [h * (i == k) for i in range(m.nv)]
            ahead, back = ([x + sign * s for x, s in zip(map(mpmath.mpf, q), step, strict=True)] for sign in (1, -1))
            # The error of a central difference is h^2.
            for exact, pairs in (
                (by_q[:, k], (required(ahead, list(v)), required(back, list(v)))),
                (
                    by_v[:, k],
                    tuple(
                        required(list(q), [x + sign * s for x, s in zip(map(mpmath.mpf, v), step, strict=True)])
                        for sign in (1, -1)
                    ),
                ),
            ):
                slope = np.array([float((x - y) / (2 * h)) for x, y in zip(*pairs, strict=True)])
                assert np.abs(exact - slope).max() <= 1e-13 * max(1.0, np.abs(by_q).max(), np.abs(by_v).max())


# Loops.

# Where Pinocchio 4.1's derivatives are the slopes of its own accelerations. On the others, tied by points (CONTACT_3D),
# they are off by their own size; the slopes of its accelerations are ours there, too.
AGREED = ("stewart", "grasp")
CLOSED = (*AGREED, "delta_rods", "four_bar", "slider_crank", "andrews_squeezer")
# The others take five to ten seconds each to generate and compile.
SMALL_CLOSED = ("slider_crank",)


@cache
def closed(name: str) -> tuple[sf.Model, pinocchio_loops.LoopEngine, States]:
    system = without_forces(MODELS[name])
    engine = pinocchio_loops.build(Subject(name, system))
    assert isinstance(engine, pinocchio_loops.LoopEngine)
    m = sf.compile(system)
    states = assembled_states(system, sample(assemble(system), m.nu, 40))
    return m, engine, with_forces(SymofrosEngine("symofros", m), states)[:4]


@pytest.mark.slow  # In every run: the same derivatives against differences, below.
@pytest.mark.parametrize("name", AGREED)
def test_closed_loop_derivatives_match_pinocchio(name: str) -> None:
    """computeConstraintDynamicsDerivatives, along changes of q and v that keep phi = 0 and G v = 0.

    Along others, points that are apart or drift apart add terms to the conditions' second rates which each side states
    in its own way.
    """
    m, engine, states = closed(name)
    theirs = np.concatenate(engine.derivatives(states)[:2], axis=2)
    assert len(states) == 4 and np.abs(states.v).max() > 0.1
    for i in range(len(states)):
        q, v, u = states.q[i], states.v[i], states.u[i]
        S = sf.state_space(m, q, v, u).basis
        ours = np.concatenate(m.forward_dynamics_derivatives(q, v, u)[:2], axis=1) @ S
        # By as much as the equations of closed loops amplify rounding, a hundred times.
        assert np.abs(ours - theirs[i] @ S).max() <= 100 * TOLERANCE * max(1.0, np.abs(ours).max())


@pytest.mark.parametrize("name", sampled(CLOSED, SMALL_CLOSED))
def test_closed_loop_derivatives_match_differences(name: str) -> None:
    """Of sixth order, along the same changes; rounding of v' over the step is what is left."""
    m, _, states = closed(name)
    weights, h = ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60)), 1e-4
    for i in range(len(states)):
        q, v, u = states.q[i], states.v[i], states.u[i]

        def moved(step: float, along: Array, q: Array = q, v: Array = v, u: Array = u) -> Array:
            return m.forward_dynamics(m.integrate(q, step * along[: m.nv]), v + step * along[m.nv :], u)

        S = sf.state_space(m, q, v, u).basis
        ours = np.concatenate(m.forward_dynamics_derivatives(q, v, u)[:2], axis=1) @ S
        found = [sum(w * (moved(k * h, s) - moved(-k * h, s)) for k, w in weights) / h for s in S.T]
        assert np.abs(ours - np.array(found).T).max() <= 1e-7 * max(1.0, np.abs(ours).max())


@pytest.mark.parametrize("name", sampled(CLOSED, SMALL_CLOSED))
def test_closed_loop_derivatives_match_differences_of_pinocchio(name: str) -> None:
    """Central differences; their error of order h^2 and rounding over h leave some 1e-7."""
    m, engine, states = closed(name)
    h = 1e-5
    for i in range(len(states)):
        q, v, u = states.q[i], states.v[i], states.u[i]

        def theirs(step: Array, i: int = i, q: Array = q, v: Array = v) -> Array:
            moved = m.integrate(q, step[: m.nv]), v + step[m.nv :]
            return engine.forward_dynamics(replace(states[i : i + 1], q=moved[0][None], v=moved[1][None]))[0]

        S = sf.state_space(m, q, v, u).basis
        ours = np.concatenate(m.forward_dynamics_derivatives(q, v, u)[:2], axis=1) @ S
        found = np.array([(theirs(h * s) - theirs(-h * s)) / (2 * h) for s in S.T]).T
        assert np.abs(ours - found).max() <= 1e-6 * max(1.0, np.abs(ours).max())
