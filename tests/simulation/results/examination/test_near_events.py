"""Which events are looked at where they turn: those that depend on nothing that actions set."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.simulation.results.examination import switched_run
from symofros.simulation.results.examination.near_events import _judged, event_values
from symofros.simulation.results.examination.switched_run import SwitchedRun
from tests.simulation.results.examination.test_switched_run import FINE, relay
from tests.simulation.rigid_scenes import ball_system

EVENTS = {
    "lower": sf.Event("contact.floor.gap - 0.3", "falling"),  # By the radius, which its text does not name.
    "named": sf.Event("free.pz + 0*r - 0.2", "falling"),  # It names it, and does not depend on it.
    "height": sf.Event("free.pz - 0.2", "falling"),
    "later": sf.Event("t - 0.35 + k", "rising"),
    "shrinks": sf.Event("t - 0.3", action={"r": 0.05, "k": 0.001, "free.wz": 1.0}),
}


def test_events_that_depend_on_what_actions_set_are_not_judged(monkeypatch: pytest.MonkeyPatch) -> None:
    """By what the formulas depend on, not by their words."""
    stated = ball_system()
    (floor,) = stated.connections
    parameters = (sf.Parameter("r", 0.1), sf.Parameter("k", 0.0))
    smaller = replace(stated, parameters=parameters, connections=(replace(floor, radius=sf.formula("r")),))
    runs = list[SwitchedRun]()
    monkeypatch.setattr(switched_run, "_near_event_note", lambda run, _: runs.append(run) or "")
    sf.simulate(sf.compile(smaller), {"free.pz": 1.0}, {}, 0.4, method="rk4", dt=0.01, events=EVENTS)
    (run,) = runs
    values = event_values(run.stepper, run.states)
    judged = np.flatnonzero(_judged(run.stepper, run.states, values))
    assert [run.stepper.events[i].name for i in judged] == ["named", "height", "shrinks"]


@pytest.mark.parametrize(
    ("share", "notes"),
    [
        (0.02, ["so near to zero that the steps cannot tell whether it gets there"]),
        (0.7, ["over what its events do: half of that changes it"]),  # Half the step gets there.
        (-0.5, []),
        (-30.0, []),
    ],
)
def test_events_that_turn_nearer_to_zero_than_steps_err_are_noted(share: float, notes: list[str]) -> None:
    """Levels below the top of the right motion that no steps reach, and above it by more than their error."""
    model, q, v, given = relay()
    options: dict[str, Any] = {"method": "implicit_euler", "dt": 2e-4}
    top, right = (sf.simulate(model, q, v, **(given | {"events": {}}), **one).q[:, 0].max() for one in (options, FINE))
    given["events"] = {"up": sf.Event(f"q0 - {right - share * (right - top)}", "rising", action={"side": -3})}
    run, known = (sf.simulate(model, q, v, **given, **one) for one in (options, FINE))
    assert not run.events and len(known.events) == (share > 0.0)
    assert len(run.outcome.notes) == len(notes), run.outcome
    assert all(said in note for said, note in zip(notes, run.outcome.notes, strict=True)), run.outcome
