"""Controllers in closed loops: they do what their equations promise."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.blocks import CartesianFeedback, ComputedTorque, Constant, ForwardDynamics


def test_errors_under_computed_torque_decay_as_an_oscillator() -> None:
    system = MODELS["rx90"]
    names = sf.compile(system).names.q
    diagram = sf.Diagram("decay")
    diagram.add_model("m", system, dict(zip(names, [0.1, -0.2, 0.3, 0.2, -0.1, 0.3], strict=True)))
    diagram.add(Constant(name="goal", value=np.zeros(6)))
    diagram.add(ComputedTorque(name="c", model="m", kp=25.0, kd=10.0), q_desired="goal.y", q="arm.q", v="arm.v")
    diagram.add(ForwardDynamics(name="arm", model="m"), u="c.tau")
    found = sf.Simulation(diagram).run(2.0, dt=1e-3)
    t, e = found.t[:, None], found["c.error"]
    # Critically damped, from rest: e = e_0 (1 + 5 t) exp(-5 t).
    np.testing.assert_allclose(e, e[0] * (1 + 5 * t) * np.exp(-5 * t), atol=1e-8)


def fed_back(reach: float) -> tuple[sf.Model, str, np.ndarray, sf.DiagramRun]:
    """Seven joints whose last frame is fed back towards a share of where it is, from a state in motion."""
    system = MODELS["chain7"]
    model = sf.compile(system)
    frame, q0 = model.names.frames[-1], np.linspace(0.3, 0.9, model.nq)
    diagram = sf.Diagram("redundant")
    diagram.add_model("m", system, dict(zip(model.names.q, q0, strict=True)) | {"d" + model.names.v[0]: 0.5})
    diagram.add(Constant(name="goal", value=reach * model.frame_pose(frame, q0)[0]))
    diagram.add(
        CartesianFeedback(name="c", model="m", frame=frame, kp=25.0, kd=10.0, idle=4.0),
        p_desired="goal.y",
        q="arm.q",
        v="arm.v",
    )
    diagram.add(ForwardDynamics(name="arm", model="m"), u="c.tau")
    return model, frame, q0, sf.Simulation(diagram).run(2.0, dt=1e-3)


def test_a_frame_under_feedback_decays_as_an_oscillator_and_free_motion_dies_out() -> None:
    model, frame, q0, found = fed_back(0.9)
    t, e = found.t[:, None], found["c.error"]
    rate = -model.frame_velocity(frame, q0, np.eye(model.nv)[0] * 0.5)[:3]
    # Critically damped: e = (e_0 + (e'_0 + 5 e_0) t) exp(-5 t).
    np.testing.assert_allclose(e, (e[0] + (rate + 5 * e[0]) * t) * np.exp(-5 * t), atol=1e-7)
    assert np.linalg.norm(found["arm.v"][-1]) < 0.02 * np.linalg.norm(found["arm.v"], axis=1).max()


@pytest.mark.slow
def test_feedback_goes_through_a_stretched_posture_calmly() -> None:
    model, frame, _, found = fed_back(1.04)
    least = min(np.linalg.svd(model.frame_jacobian(frame, q)[:3], compute_uv=False)[-1] for q in found["arm.q"])
    assert least < 5e-3  # It was there: damping sets in below 0.02.
    assert found.outcome.ok
    assert np.abs(found["arm.v"]).max() < 3.0  # Undamped, joints reach 1e4 rad/s.
