"""Efforts and external wrenches on a mechanism."""

from __future__ import annotations

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.blocks import Constant, ForwardDynamics
from tests.diagrams.run.test_switching import CASES, diagram, simulated

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


def test_a_mechanism_tells_functions_of_its_motion() -> None:
    """Those of the model along the run, at the parameters that an event has set by then."""
    gripper = CASES["grasp"]
    functions = ("kinetic_energy", "closure_wrenches", "joint_wrenches", "centroidal_momentum")
    run = sf.Simulation(diagram(gripper, functions=functions)).run(gripper.t_end, dt=1e-2)
    alone = simulated(gripper, dt=1e-2)
    model, after = alone.model, alone.par_over_time[-1]
    (q, v), a, lam, t = run.motion("plant"), run["plant.a"], run["plant.lam"], run.t
    last = t >= 0.8 + 1e-9
    given = {"par": after, "t": t[last]}
    np.testing.assert_allclose(run["plant.kinetic_energy"][last], model.kinetic_energy(q[last], v[last], par=after))
    wrenches = model.joint_wrenches(q[last], v[last], a[last], np.zeros((last.sum(), 0)), lam[last], **given)
    np.testing.assert_allclose(run["plant.joint_wrenches"][last], wrenches, atol=1e-9)
    held = (t > run.events["plant"][0].t) & (t < 0.4)
    names = run["plant.closure_wrenches_on_second"]
    assert np.abs(names[held]).max() > 1e-3 and not names[last].any()
    # What holds acts on both alike: the momentum of all that moves changes by the ground's joint alone.
    on_first = run["plant.closure_wrenches_on_first"]
    np.testing.assert_allclose(on_first[held][:, 0, :3], -names[held][:, 0, :3], atol=1e-9)
    momentum = run["plant.centroidal_momentum"]
    assert momentum.shape == (len(t), 6)
    np.testing.assert_allclose(momentum[last], model.centroidal_momentum(q[last], v[last], par=after), atol=1e-12)


def test_outputs_that_a_mechanism_does_not_have_are_refused() -> None:
    with pytest.raises(sf.DescriptionError, match="'contact_forces' has no entries"):
        sf.Simulation(diagram(CASES["grasp"], functions=("contact_forces",)))
