"""One beam under one load states one error of its theory, whatever asks (docs/theory/beams.md, 26a)."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import symofros as sf
from symofros.studio.viewer.drawing.poses import Mechanism
from tests.simulation.beam_models import at_rest, cantilever_system, column_diagram

SHARES = [-5.0, 0.0, 0.8, 0.95]


@pytest.mark.parametrize("share", SHARES)
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
