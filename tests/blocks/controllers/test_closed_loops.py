"""Controllers in closed loops: they do what their equations promise."""

from __future__ import annotations

import numpy as np

import symofros as sf
from reference_models import MODELS
from symofros.blocks import CartesianFeedback, Constant, ForwardDynamics


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
