"""Every block works with every model: rigid, flexible, closed, on a floating base; against sf.Model in NumPy."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.blocks import (
    CartesianFeedback,
    CartesianLinear,
    ComputedTorque,
    Extremities,
    ForwardKinematics,
    FrameTransform,
    FrictionCompensation,
    GravityCompensation,
    InverseDynamics,
    InverseKinematics,
    Jacobian,
    ModelFunction,
)
from symofros.blocks.model_function import OFFERED
from symofros.description.forces import Friction
from symofros.diagrams.block import Block
from symofros.diagrams.program.variants import friction_only
from tests.blocks.support import run, run_each
from tests.models import sampled

# Model -> a frame at the end of what moves.
CASES = {
    "rx90": "tool",
    "planar_robot": "tool",
    "flexible_pendulum": "",
    "four_bar": "coupler.end",
    "flexible_slider_crank": "",
    "space_arm": "grip",
    "free_boom": "tip",
    "joint_zoo": "",
    "hull": "end",
    "car": "front_left_wheel",
    "stewart": "",
}
# Quaternions below a free body, and a screw.
HULL = sf.System(
    "hull",
    (
        sf.RigidBody("hull", sf.Joint("float", "free"), sf.Inertia(2.0, (0.1, 0, 0), (1, 2, 1.5))),
        sf.RigidBody(
            "arm",
            sf.Joint("s", "ball", "hull", position=(1, 0, 0.2), actuated=True),
            sf.Inertia(1.0, (0.1, 0.2, 0), (1, 2, 1.5)),
        ),
        sf.RigidBody(
            "bit",
            sf.Joint("turn", "screw", "arm", position=(0.5, 0, 0), axis=(0, 1, 2), pitch=0.3, actuated=True),
            sf.Inertia(0.5, (0.1, 0, 0), (1, 1, 1.5)),
            (sf.Frame("end", (1, 0, 0.2)),),
        ),
    ),
)
COUNT = 3
# Another route to the same numbers; accelerations of stiff models are large, and so are their roundings.
CLOSE = {"rtol": 1e-9, "atol": 1e-9}


def system(name: str) -> sf.System:
    return HULL if name == "hull" else MODELS[name]


@cache
def model(name: str) -> sf.Model:
    return sf.compile(system(name))


def frame(name: str) -> str:
    return CASES[name] or model(name).names.frames[-1]


@cache
def states(name: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(5)
    q, v = zip(*(model(name).random_state(rng) for _ in range(COUNT)), strict=True)
    # Beams bend as far as they may.
    elastic = ["[" in item for item in model(name).names.q]
    q = np.where(elastic, 0.01 * np.array(q), q)
    return q, np.array(v), rng.normal(size=(COUNT, model(name).nv))


def through(name: str, block: Block, **inputs: np.ndarray) -> dict[str, np.ndarray]:
    return dict(through_each(name, (block, inputs))[0])


def through_each(name: str, *fed: tuple[Block, dict[str, np.ndarray]]) -> list[Mapping[str, np.ndarray]]:
    return run_each(fed, models={"m": (system(name), {})}, compare=1e-10)


# Closed; on a free base. Flexible, with friction and rotors: where forces are asked for.
SMALL = ("four_bar", "hull")
everywhere = pytest.mark.parametrize("name", sampled(tuple(CASES), SMALL))
also_flexible = pytest.mark.parametrize("name", sampled(tuple(CASES), (*SMALL, "planar_robot")))


@everywhere
def test_kinematics_blocks_match_the_model(name: str) -> None:
    """Of one frame and of all, their Jacobians, and wrenches in their axes."""
    (q, v, a), m, at = states(name), model(name), frame(name)
    frames = [item for item in m.names.frames if item != "world"]
    u = np.arange(6.0 * COUNT).reshape(COUNT, 6)
    one, every, slopes, wrench = through_each(
        name,
        (ForwardKinematics(name="one", model="m", frame=at), {"q": q, "v": v, "a": a}),
        (Extremities(name="every", model="m"), {"q": q, "v": v, "a": a}),
        (Jacobian(name="slopes", model="m", frame=at), {"q": q, "v": v}),
        (FrameTransform(name="wrench", model="m", source=at, quantity="wrench"), {"q": q, "u": u}),
    )
    p, R = m.frame_pose(at, q)
    np.testing.assert_allclose(one["p"], p, **CLOSE)
    np.testing.assert_allclose(one["R"], R, **CLOSE)
    np.testing.assert_allclose(one["velocity"], m.frame_velocity(at, q, v), **CLOSE)
    np.testing.assert_allclose(one["acceleration"], m.frame_acceleration(at, q, v, a), **CLOSE)
    for i, other in enumerate(frames):
        np.testing.assert_allclose(every["p"][:, i], m.frame_pose(other, q)[0], **CLOSE)
        np.testing.assert_allclose(every["velocity"][:, i], m.frame_velocity(other, q, v), **CLOSE)
    np.testing.assert_allclose(slopes["J"], m.frame_jacobian(at, q), **CLOSE)
    np.testing.assert_allclose(slopes["rate"], m.frame_jacobian_rate(at, q, v), **CLOSE)
    np.testing.assert_array_equal(np.concatenate([slopes["translation"], slopes["rotation"]], axis=1), slopes["J"])
    f = np.einsum("nij,nj->ni", R, u[:, :3])
    n = np.einsum("nij,nj->ni", R, u[:, 3:]) + np.cross(p, f)
    np.testing.assert_allclose(wrench["y"], np.hstack([f, n]), **CLOSE)


@also_flexible
def test_inverse_dynamics_compensations_and_computed_torque(name: str) -> None:
    (q, v, a), m = states(name), model(name)
    desired = m.integrate(q, 0.1 * a)
    wanted = {"q_desired": desired, "v_desired": 0.3 * a, "a_desired": a, "q": q, "v": v}
    rubs = friction(name, q, v)
    tau = m.inverse_dynamics(q, v, a)
    scale = {"rtol": 1e-9, "atol": 1e-10 * max(1.0, np.abs(tau).max())}
    motion = {"q": q, "v": v, "a": a}
    whole, without, friction_alone, held, control = through_each(
        name,
        (InverseDynamics(name="whole", model="m"), motion),
        (InverseDynamics(name="without", model="m", with_friction=False), motion),
        (FrictionCompensation(name="friction", model="m", factor=0.8), {"q": q, "v": v}),
        (GravityCompensation(name="gravity", model="m"), {"q": q}),
        (ComputedTorque(name="control", model="m", kp=50.0, kd=12.0), wanted),
    )
    np.testing.assert_allclose(whole["tau"], tau, **scale)
    np.testing.assert_allclose(without["tau"], tau + rubs, **scale)
    np.testing.assert_allclose(friction_alone["effort"], -0.8 * rubs, **scale)
    np.testing.assert_allclose(held["effort"], m.inverse_dynamics(q, 0 * v, 0 * a), **scale)
    # Whose error decays: its acceleration is that of an oscillator.
    error = m.difference(q, desired)
    np.testing.assert_allclose(control["error"], error, rtol=1e-9, atol=1e-12)
    tau = m.inverse_dynamics(q, v, a + 50.0 * error + 12.0 * (0.3 * a - v))
    np.testing.assert_allclose(control["tau"], tau, rtol=1e-9, atol=1e-10 * np.abs(tau).max())


@also_flexible
def test_each_function_of_a_model_is_a_block(name: str) -> None:
    (q, v, a), m, at = states(name), model(name), frame(name)
    rng = np.random.default_rng(2)
    given = {"q": q, "v": v, "a": a, "u": rng.normal(size=(COUNT, m.nu)), "lam": rng.normal(size=(COUNT, m.nc))}
    absent = {"contact_forces": m.names.contacts, "section_forces": m.names.sections, "prescribed_efforts": ()}
    offered = [key for key, row in OFFERED.items() if absent.get(key, True) and (m.nc or not row.constrained_only)]
    offered = [key for key in offered if m.record.par_names or not key.endswith("by_par")]
    assert {"kinetic_energy", "joint_wrenches", "frame_jacobian"} <= {*offered} and "contact_forces" in OFFERED
    fed = []
    for key in sorted(rng.choice(offered, 4, replace=False)):
        row = OFFERED[key]
        block = ModelFunction(name=key, model="m", function=key, frame=at if row.of_frame else "")
        fed.append((block, {group: given[group] for group in row.inputs if group != "t" and given[group].size}))
    for (block, inputs), found in zip(fed, through_each(name, *fed), strict=True):
        expected = m.evaluate(block.function, block.frame, **inputs)
        for output, values in zip(OFFERED[block.function].outputs, expected, strict=True):
            np.testing.assert_allclose(
                found[output.name], values, rtol=1e-9, atol=1e-9 * max(1.0, np.abs(values).max(initial=0))
            )


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"function": "forward_dynamics"}, "ForwardDynamics"),
        ({"function": "kinetic_enrgy"}, "kinetic_energy"),
        ({"function": "frame_pose"}, "no frame"),
        ({"function": "momentum", "frame": "rod"}, "functions of frames have one"),
        ({"function": "closure_wrenches"}, "of a tree"),
        ({"function": "contact_forces"}, "has no entries"),
    ],
)
def test_functions_that_a_block_does_not_offer_are_refused(fields: dict[str, str], words: str) -> None:
    with pytest.raises(sf.DescriptionError) as raised:
        through("hull", ModelFunction(name="b", model="m", **fields), q=states("hull")[0])
    assert words in str(raised.value)


def friction(name: str, q: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Forces of friction (nv), by a model whose joints have no others."""
    has_friction = [
        body.joint.name
        for body in system(name).bodies
        if body.joint and any(isinstance(element, Friction) for element in body.joint.elements)
    ]
    if not has_friction:
        return 0 * v
    only = sf.compile(friction_only(system(name)))
    return only.generalized_force(q, v, np.zeros(only.nu)) * [item in has_friction for item in only.names.v]


@everywhere
def test_cartesian_controllers_give_the_wrench_and_acceleration_of_their_law(name: str) -> None:
    (q, v, _), m, at = states(name), model(name), frame(name)
    rng = np.random.default_rng(1)
    J = m.frame_jacobian(at, q)[:, :3]
    # What moves in a plane follows that plane's directions.
    rows = np.flatnonzero(np.abs(J).max(axis=(0, 2)) > 1e-9)
    J, k = J[:, rows], len(rows)
    place, rate = m.frame_pose(at, q)[0][:, rows], rng.normal(size=(COUNT, k))
    given = {"p_desired": place + 0.1 * rng.normal(size=(COUNT, k)), "v_desired": rate, "q": q, "v": v}
    fields: dict[str, Any] = {"name": "b", "model": "m", "frame": at, "rows": tuple("xyz"[row] for row in rows)}
    missing, lag = given["p_desired"] - place, rate - np.einsum("nij,nj->ni", J, v)
    stiffness = [50.0, 60.0, 70.0][:k]
    found = through(name, CartesianLinear(**fields, stiffness=stiffness, damping=5.0), **given)
    wrench = stiffness * missing + 5.0 * lag
    np.testing.assert_allclose(found["wrench"], wrench, **CLOSE)
    np.testing.assert_allclose(found["effort"], np.einsum("nij,ni->nj", J, wrench), rtol=1e-9, atol=1e-8)
    feedback = CartesianFeedback(**fields, kp=30.0, kd=8.0)
    if m.nc:
        with pytest.raises(sf.DescriptionError, match="constraints"):
            through(name, feedback, **given)
        return
    a_desired = rng.normal(size=(COUNT, k))
    found = through(name, feedback, **given, a_desired=a_desired)
    M, h = m.mass_matrix(q), m.inverse_dynamics(q, v, 0 * v)
    motion = np.linalg.solve(M, (found["tau"] - h)[..., None])[..., 0]
    regular = [k and np.linalg.svd(one, compute_uv=False)[min(k, m.nv) - 1] > 0.05 and k <= m.nv for one in J]
    wanted = a_desired + 8.0 * lag + 30.0 * missing
    A = m.frame_acceleration(at, q, v, motion)[:, rows]
    np.testing.assert_allclose(A[regular], wanted[regular], rtol=1e-6, atol=1e-6)


@everywhere
def test_inverse_kinematics_reaches_the_pose(name: str) -> None:
    m, at = model(name), frame(name)
    q0 = states(name)[0][0]
    if m.nc:
        q0 = sf.assemble(m, q0).q
    joints = [item for item in m.names.v if item in m.names.q and "[" not in item]
    columns = [m.names.v.index(item) for item in joints]
    J = m.frame_jacobian(at, q0)[:3, columns]
    rows = [row for row in range(3) if np.abs(J[row]).max() > 0.05]
    # Where the joints may take it; of a closed mechanism where it is.
    step = np.zeros(m.nv)
    step[columns] = 0.0 if m.nc else 0.1
    p = m.frame_pose(at, m.integrate(q0, step))[0][rows]
    block = InverseKinematics(
        name="b", model="m", frame=at, rows=tuple("xyz"[row] for row in rows), joints=joints, period=0.01
    )
    start = dict(zip(m.names.q, q0, strict=True))
    found = run(block, {"p": np.tile(p, (8, 1))}, models={"m": (system(name), start)}, compare=1e-8)
    np.testing.assert_allclose(m.frame_pose(at, found["q"][-1])[0][rows], p, atol=1e-9)
    np.testing.assert_allclose(found["error"][-1], 0.0, atol=1e-9)
    if m.nc:
        np.testing.assert_allclose(m.constraint(found["q"][-1]), 0.0, atol=1e-9)
    still = np.setdiff1d(np.arange(m.nq), [m.names.q.index(item) for item in joints])
    np.testing.assert_array_equal(found["q"][-1][still], q0[still])
