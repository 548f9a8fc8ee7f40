"""One beam under one load states one error of its theory, whatever asks (docs/theory/beams.md, 26a)."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import symofros as sf
from symofros import blocks
from symofros.studio.viewer.drawing.poses import Mechanism
from tests.models import sampled
from tests.simulation.beam_models import at_rest, cantilever_system, column_diagram

SHARES = [-5.0, -2.0, -0.5, 0.0, 0.5, 0.8, 0.9, 0.95]


@pytest.mark.parametrize("share", sampled(SHARES, [-5.0, 0.0, 0.8, 0.95]))
@pytest.mark.parametrize("L", [1e-3, 30.0])
def test_diagrams_state_the_error_of_rest(share: float, L: float) -> None:
    model, rest = at_rest(share, L)
    simulation, span = sf.Simulation(column_diagram(model, rest.q)), 0.05 * L**2
    given = {"dt": span / 20, "record": span / 4}
    runs = simulation.run(span, **given), simulation.interpret(span, **given)
    for run in runs:
        assert [bent.error for bent in run.bendings] == pytest.approx([rest.bendings[0].error] * 2, rel=1e-6)
        noted = [note for note in run.outcome.notes if "second-order theory errs" in note]
        assert len(noted) == 2 * int(rest.bendings[0].error > 0.01)


def test_a_diagram_ends_beyond_theory_by_its_axial_loads() -> None:
    model, rest = at_rest(0.95, 1.0)
    simulation, given = sf.Simulation(column_diagram(model, rest.q)), {"dt": 0.01, "record": 0.02, "beam_limit": 0.02}
    assert rest.bendings[0].error > 0.02 > model.beams()[0].bending(rest.q).error
    for outcome in (simulation.run(0.1, **given).outcome, simulation.interpret(0.1, **given).outcome):
        assert outcome.kind == "beyond theory" and not outcome.ok


@pytest.mark.parametrize("share", SHARES)
def test_postures_state_the_error_of_rest(share: float) -> None:
    """Inverse kinematics and the viewer judge a posture as what is released there."""
    model, rest = at_rest(share, 1.0)
    tip, _ = model.frame_pose("blade.tip", rest.q)
    reached = sf.inverse_kinematics(model, {"blade.tip": sf.Target(tip)}, rest.q, held=model.names.v)
    assert reached.bendings[0].error == pytest.approx(rest.bendings[0].error, rel=1e-6)
    mechanism = viewed()
    (bent,) = mechanism.bendings(mechanism.state(rest.q, par=model.parameter_values))
    assert bent.error == pytest.approx(rest.bendings[0].error, rel=1e-6)


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("L", [1e-3, 30.0])
def test_efforts_of_a_motion_state_the_error_of_rest(share: float, L: float) -> None:
    """Efforts on all elastic coordinates, which vanish at rest, in two states at once."""
    model, rest = at_rest(share, L)
    still, q = np.zeros((2, model.nv)), np.array([0.5 * rest.q, rest.q])
    efforts = sf.actuator_efforts(model, q, still, still, model.names.v, par=model.parameter_values)
    assert efforts.bendings[0].error == pytest.approx(rest.bendings[0].error, rel=1e-6)


@cache
def viewed() -> Mechanism:
    """The column as the viewer has it."""
    return Mechanism(cantilever_system())


@pytest.mark.slow
def test_diagrams_of_closed_loops_state_the_error_of_runs() -> None:
    """The axial load of a rod that drives a slider is a constraint's, and that of its inertia."""
    rod = sf.Beam("rod", sf.Joint("swing", "revolute", position=(0, 0.1, 0)), 0.3, 0.5, EI_z=2.0, bend_y=2)
    slider = sf.RigidBody("slider", sf.Joint("slide", "prismatic", axis=(1, 0, 0)), sf.Inertia(20.0, moments=(1, 1, 1)))
    pin = sf.Closure("pin", ("slider", None), ("rod", "tip"), translations=("x", "y"))
    system = sf.System("slider", (rod, slider), gravity=(60, -9.81, 0), constraints=(pin,))
    model = sf.compile(system)
    diagram = sf.Diagram("press")
    start = sf.assemble(model, {"swing": -0.34, "slide": 0.28, "rod.bend_y[1]": 0.006}).q
    diagram.add_model("plant", system, start=dict(zip(model.names.q, start.tolist(), strict=True)))
    diagram.add(blocks.ForwardDynamics(name="press", model="plant"))
    simulation, given = sf.Simulation(diagram), {"dt": 1e-4, "record": 1e-4}
    runs = simulation.run(0.01, **given), simulation.interpret(0.01, **given)
    alone = sf.simulate(model, start, t_end=0.01, dt=1e-4)
    (bent,), (beam,) = alone.bendings, model.beams()
    unloaded = max(beam.bending(q[beam.in_q]).error for q in alone.q)
    assert not 0.95 < bent.error / unloaded < 1.05
    for run in runs:  # the slack of (26d): interpreted runs evaluate every step whose error may be larger
        assert [b.error for b in run.bendings] == pytest.approx([bent.error], rel=0.1)
