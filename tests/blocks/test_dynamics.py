"""Efforts and external wrenches on a mechanism."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.blocks import Constant, ForwardDynamics

WRENCH = [1.0, 0.0, -2.0, 0.0, 0.3, 0.0]


def start() -> dict[str, float]:
    model = sf.compile(MODELS["four_bar"])
    q = sf.assemble(model, model.neutral() + np.array([0.9, 0.4, -0.5])).q
    return dict(zip(model.names.q, map(float, q), strict=True))


def test_a_wrench_on_a_frame_with_a_dot_is_a_load_of_the_model() -> None:
    """M a + h = J^T wrench + G^T lam, by the model's own functions."""
    d = sf.Diagram("pushed")
    d.add_model("bars", MODELS["four_bar"], start())
    d.add(Constant(name="push", value=WRENCH))
    d.add(ForwardDynamics(name="plant", model="bars", perturbed=("coupler.end",)), wrench_coupler_end="push.y")
    model = sf.compile(MODELS["four_bar"])
    run = sf.Simulation(d).run(0.02, dt=1e-3, record=0.01)
    q, v = run.motion("plant")
    J, G = model.frame_jacobian("coupler.end", q), model.constraint_jacobian(q)
    left = model.inverse_dynamics(q, v, run["plant.a"]) - np.einsum("nij,ni->nj", G, run["plant.lam"])
    np.testing.assert_allclose(left, np.einsum("nij,i->nj", J, WRENCH), rtol=0, atol=1e-10)


def test_two_frames_of_one_port_are_refused() -> None:
    d = sf.Diagram("pushed")
    d.add_model("bars", MODELS["four_bar"])
    d.add(ForwardDynamics(name="b", model="bars", perturbed=("coupler.end", "coupler.end")))
    with pytest.raises(sf.DescriptionError, match="two frames have one port"):
        sf.Simulation(d)
