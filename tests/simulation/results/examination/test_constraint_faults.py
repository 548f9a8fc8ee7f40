"""What went wrong with the constraints of a run, each where it is asked for alone."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.simulation.results.examination import constraint_faults
from symofros.simulation.results.examination.constraint_faults import jump, violation
from symofros.simulation.stepping.status import Status


def skate() -> sf.Model:
    """A body in the plane on a knife edge that keeps it from sideways motions."""
    body = sf.RigidBody("body", sf.Joint("p", "planar", axis=(0, 0, 1)), sf.Inertia(1.0, moments=(1.0, 1.0, 1.0)))
    edge = sf.KnifeEdge("edge", ("body", None), "y")
    return sf.compile(sf.System("skate", (body,), constraints=(edge,)), sf.Options(backend="tape"))


@pytest.mark.parametrize("project", [False, True])
@pytest.mark.parametrize(("sideways", "said"), [(0.02, False), (0.4, True)])
def test_a_condition_is_violated_by_a_tenth_of_its_terms(sideways: float, said: bool, project: bool) -> None:
    """Where nothing projects."""
    model = skate()
    states = (
        np.arange(2.0),
        np.zeros((2, model.nq)),
        np.array([[1.0, 0.0, 0.0], [1.0, sideways, 0.0]]),
        np.zeros((2, 0)),
    )
    turned = model.integrate(model.neutral(), [0.0, 0.0, 0.7])
    states[1][:] = turned
    c, s = np.cos(0.7), np.sin(0.7)
    states[2][:, :2] = states[2][:, :2] @ np.array([[c, s], [-s, c]])
    run: Any = SimpleNamespace(
        model=model,
        settings=SimpleNamespace(project=project),
        states=states,
        stepper=SimpleNamespace(par=model.parameter_values),
    )
    found = violation(run)
    assert (found is not None) == (said and not project)
    assert found is None or (found.t == 1.0 and found.share > 0.1)


def test_rows_are_examined_where_constraints_may_have_ended_a_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of no run that has come to its end, and of none that ended for another reason."""
    ends = "ENERGY_LOST DIVERGED SINGULAR STEP_TOO_SMALL NO_CONVERGENCE PROJECTION_FAILED RUNNING".split()
    monkeypatch.setattr(constraint_faults, "jump_ahead", lambda *_: "seen")
    model = skate()
    stepper: Any = SimpleNamespace(
        state=(0.5, model.neutral(), np.zeros(model.nv)), run=SimpleNamespace(), model=model, inputs_now=None, par=None
    )
    for status in Status:
        for t_end in (0.5, 1.0):
            stepper.run.t_end = t_end
            assert jump(stepper, status) == ("seen" if status.name in ends and t_end > 0.5 else None)
