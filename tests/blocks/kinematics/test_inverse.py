"""Inverse kinematics: what comes out takes the frame where it should be, by sf.Model's own kinematics."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import symofros as sf
from reference_models import MODELS
from symofros.blocks import CartesianTrajectory, Constant, InverseKinematics, JointTrajectory, Sine
from symofros.diagrams.diagram import Diagram
from symofros.diagrams.program.variants import with_functions
from tests.blocks.support import refused
from tests.models import sampled

PERIOD = 0.01


def run_both(diagram: Diagram, t_end: float) -> Any:
    """The compiled run, once the interpreted one agrees on the block "ik"."""
    simulation = sf.Simulation(diagram)
    found = simulation.run(t_end, dt=PERIOD, record=PERIOD)
    assert found.outcome.ok
    other = simulation.interpret(t_end, dt=PERIOD, record=PERIOD)
    for port in ("q", "v", "a", "error"):
        np.testing.assert_allclose(other[f"ik.{port}"], found[f"ik.{port}"], rtol=1e-9, atol=1e-9)
    return found


def arm_diagram(period: float | None, **fields: Any) -> tuple[Diagram, sf.Model, np.ndarray]:
    """Six joints that follow a pose along a path which begins where the arm is."""
    system = MODELS["rx90"]
    model = sf.compile(system)
    start = dict(zip(model.names.q, [0.2, -0.5, 1.0, 0.3, 0.6, -0.4], strict=True))
    q0 = np.array(list(start.values()))
    p, R = model.frame_pose("tool", q0)
    other = model.frame_pose("tool", q0 + [0.4, 0.3, -0.3, 0.2, 0.4, 0.3])
    diagram = sf.Diagram("arm")
    diagram.add_model("m", system, start)
    quaternions = Rotation.from_matrix([R, other[1]]).as_quat()
    diagram.add(CartesianTrajectory(name="path", points=[p, other[0]], times=[0.1, 0.9], quaternions=quaternions))
    block = InverseKinematics(
        name="ik", model="m", frame="tool", rows=("x", "y", "z", "rx", "ry", "rz"), period=period, **fields
    )
    diagram.add(block, p="path.p", R="path.R", v="path.v", a="path.a")
    return diagram, model, q0


@pytest.mark.parametrize("period", sampled((PERIOD, None), [PERIOD]), ids=["sampled", "continuous"])
def test_an_arm_follows_a_pose(period: float | None) -> None:
    diagram, model, q0 = arm_diagram(period)
    found = run_both(diagram, 0.4)
    q, v, a = (found[f"ik.{key}"] for key in "qva")
    np.testing.assert_allclose(q[0], q0, atol=1e-12)
    p, R = model.frame_pose("tool", q)
    # Sampled: Newton's method to rounding. Continuous: the error of Runge-Kutta's steps of 10 ms.
    close = 1e-12 if period else 1e-6
    np.testing.assert_allclose(p, found["path.p"], atol=close)
    np.testing.assert_allclose(R, found["path.R"], atol=close)
    np.testing.assert_allclose(model.frame_velocity("tool", q, v), found["path.v"], atol=100 * close)
    np.testing.assert_allclose(model.frame_acceleration("tool", q, v, a), found["path.a"], atol=1e4 * close)
    assert np.abs(found["ik.error"]).max() < close
    # Speeds are the rates of the joints: second differences of q are of order PERIOD^2.
    np.testing.assert_allclose((q[2:] - q[:-2]) / (2 * PERIOD), v[1:-1], atol=5e-3 * np.abs(v).max())


def test_errors_of_continuous_inverse_kinematics_decay_exponentially() -> None:
    diagram, model, q0 = arm_diagram(None, gain=8.0)
    away = dict(zip(model.names.q, q0 + [0.05, -0.04, 0.06, 0.1, -0.08, 0.05], strict=True))
    diagram.models["m"] = replace(diagram.models["m"], start=away)
    found = sf.Simulation(diagram).run(0.5, dt=1e-3, record=1e-3)
    # Positions: e' = -gain e. Of orientations the path turns the axis, and the angle does likewise.
    decay, e = np.exp(-8.0 * found.t[:, None]), found["ik.error"]
    np.testing.assert_allclose(e[:, :3], e[0, :3] * decay, atol=1e-9)
    angle = np.linalg.norm(e[:, 3:], axis=1, keepdims=True)
    np.testing.assert_allclose(angle, angle[0] * decay, atol=1e-9)


def test_accelerations_off_the_path_are_derivatives_of_speeds() -> None:
    diagram = sf.Diagram("back")
    diagram.add_model("control", MODELS["planar_robot"], {"q1": 0.3, "q2": 0.7, "q3": 0.4}, functions=0)
    diagram.add(CartesianTrajectory(name="path", points=[[0.7, 0.5], [0.5, 0.6]], times=[0.0, 0.5]))
    block = InverseKinematics(name="ik", model="control", frame="tool", rows=("x", "y"), joints=("q1", "q2"), gain=8.0)
    diagram.add(block, p="path.p", v="path.v", a="path.a")
    found = sf.Simulation(diagram).run(0.5, dt=2e-4, record=2e-4)
    assert np.linalg.norm(found["ik.error"][0]) > 0.1
    v, a = found["ik.v"], found["ik.a"]
    # Central differences of v err by h^2/6 times its third derivative.
    np.testing.assert_allclose((v[2:] - v[:-2]) / 4e-4, a[1:-1], atol=1e-4 * np.abs(a).max())


def test_a_redundant_arm_moves_with_least_norm() -> None:
    system = MODELS["chain7"]
    model = sf.compile(system)
    frame = model.names.frames[-1]
    q0 = np.linspace(0.3, 0.9, model.nq)
    diagram = sf.Diagram("redundant")
    diagram.add_model("m", system, dict(zip(model.names.q, q0, strict=True)))
    p = model.frame_pose(frame, q0)[0]
    diagram.add(CartesianTrajectory(name="path", points=[p, p + [-0.05, 0.04, 0.03]], times=[0.0, 0.5]))
    diagram.add(InverseKinematics(name="ik", model="m", frame=frame, period=PERIOD), p="path.p", v="path.v", a="path.a")
    found = run_both(diagram, 0.5)
    q, v, a = (found[f"ik.{key}"][25] for key in "qva")
    J = model.frame_jacobian(frame, q)[:3]
    np.testing.assert_allclose(v, np.linalg.pinv(J) @ found["path.v"][25], atol=1e-12)
    drift = model.frame_acceleration(frame, q, v, 0 * v)[:3]
    np.testing.assert_allclose(a, np.linalg.pinv(J) @ (found["path.a"][25] - drift), atol=1e-10)


@pytest.mark.slow
def test_a_direction_in_the_plane_is_followed_by_an_angle() -> None:
    system = MODELS["planar_robot"]
    diagram = sf.Diagram("angle")
    diagram.add_model("control", system, {"q1": 0.3, "q2": 1.6, "q3": -0.5}, functions=0)
    model = sf.compile(with_functions(system, 0))
    q0 = np.array([0.3, 0.0, 1.6, -0.5])
    diagram.add(Constant(name="p", value=model.frame_pose("tool", q0)[0][:2]))
    # Beyond half a turn the angle goes on.
    diagram.add(JointTrajectory(name="path", points=[[1.4], [4.0]], times=[0.0, 0.6]))
    diagram.add(sf.blocks.Reshape(name="angle"), u="path.q")
    for key in "va":
        diagram.add(Constant(name=f"no_{key}", value=[0.0, 0.0]))
        diagram.add(sf.blocks.Join(name=key), u1=f"no_{key}.y", u2=f"path.{key}")
    diagram.add(
        InverseKinematics(name="ik", model="control", frame="tool", rows=("x", "y", "rz"), period=PERIOD),
        p="p.y",
        angle="angle.y",
        v="v.y",
        a="a.y",
    )
    found = run_both(diagram, 0.6)
    np.testing.assert_allclose(found["ik.q"].sum(axis=1), found["path.q"][:, 0], atol=1e-10)
    np.testing.assert_allclose(model.frame_pose("tool", found["ik.q"])[0][:, :2], found["p.y"], atol=1e-10)


@pytest.mark.parametrize("period", [PERIOD, None], ids=["sampled", "continuous"])
def test_loops_stay_closed(period: float | None) -> None:
    system = MODELS["four_bar"]
    model = sf.compile(system)
    q0 = sf.assemble(model, [1.2, -1.2, 1.2]).q
    p = model.frame_pose("coupler", q0)[0]
    diagram = sf.Diagram("loop")
    diagram.add_model("m", system, dict(zip(model.names.q, q0, strict=True)))
    diagram.add(Sine(name="x", amplitude=[0.02], frequency=1.0, mean=p[0], phase=0.0))
    diagram.add(
        InverseKinematics(name="ik", model="m", frame="coupler", rows=("x",), period=period),
        p="x.y",
        v="x.rate",
        a="x.acceleration",
    )
    simulation = sf.Simulation(diagram)
    found = simulation.run(1.0, dt=PERIOD, record=PERIOD)
    q, v, a = (found[f"ik.{key}"] for key in "qva")
    close = 1e-11 if period else 1e-6
    np.testing.assert_allclose(model.constraint(q), 0.0, atol=close)
    np.testing.assert_allclose(model.frame_pose("coupler", q)[0][:, 0], found["x.y"][:, 0], atol=close)
    G = model.constraint_jacobian(q)
    np.testing.assert_allclose(np.einsum("nij,nj->ni", G, v), 0.0, atol=100 * close)
    np.testing.assert_allclose(np.einsum("nij,nj->ni", G, a), model.constraint_bias(q, v), atol=1e4 * close)


def make(**fields: Any) -> None:
    diagram = sf.Diagram("one")
    diagram.add_model("m", MODELS["space_arm"])
    diagram.add(InverseKinematics(**{"name": "ik", "model": "m", "frame": "grip", **fields}))
    sf.Simulation(diagram)


@pytest.mark.parametrize(
    ("fields", "found", "remedy"),
    [
        ({"rows": ("y", "x")}, "('y', 'x')", "write for example"),
        ({"joints": ("boomm",)}, "'boomm'", "did you mean 'boom'"),
        ({"joints": ("base.px",)}, "'base.px'", "use one of: shoulder, boom"),
        ({"steps": 0}, "0", "choose one"),
        ({"damping": 0.0}, "0.0", "within"),
        ({}, "nothing", "connect"),
    ],
)
def test_invalid_inverse_kinematics_fields_are_refused(fields: dict[str, Any], found: str, remedy: str) -> None:
    refused(lambda: make(**fields), found, remedy)
