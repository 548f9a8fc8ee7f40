"""Events that a description states: they are those of an argument, wherever a model is run."""

from __future__ import annotations

import pickle
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import symofros as sf
import symofros.blocks as blocks
from reference_models import MODELS
from symofros.exports.exporting import Target
from tests.simulation.mechanisms import slide

STATED = MODELS["docking"]
BARE = replace(STATED, events={})
GIVEN: dict[str, Any] = {
    "slips": sf.Event("wrench.grasp.fx^2 + wrench.grasp.fy^2 - 100^2", "rising", action={"grip": 0}, once=True),
    "catches": sf.Event("part.x^2 + part.y^2 - 1.3^2", "rising", action={"taut": 1}, once=True),
    "turns": "dshoulder",
}
START = dict(zip(sf.compile(BARE).names.q, sf.assemble(sf.compile(BARE)).q.tolist(), strict=True))
MET = ["turns", "slips", "catches"]


def by_argument(**options: Any) -> sf.Trajectory:
    return sf.simulate(sf.compile(BARE), START, t_end=2.5, events=GIVEN, **options)


@pytest.mark.parametrize("method", ["rk4", "dopri5", "rodas4"])
def test_runs_are_those_by_argument_to_the_bit(method: str) -> None:
    """With the events met; from a pickled description, too."""
    run, other = sf.simulate(sf.compile(STATED), START, t_end=2.5, method=method), by_argument(method=method)
    assert [found.name for found in run.events if found.name != "turns"] == MET[1:] and run.outcome.ok
    assert [found.t for found in run.events] == [found.t for found in other.events]
    again = sf.simulate(sf.compile(pickle.loads(pickle.dumps(STATED))), START, t_end=2.5, method=method)
    for one in (run, again):
        assert all(np.array_equal(getattr(one, name), getattr(other, name)) for name in ("t", "q", "v"))
    assert sf.compile(STATED).record.hash == sf.compile(BARE).record.hash


def test_batches_and_steppers_act_as_runs_do() -> None:
    """Bit by bit."""
    model, run = sf.compile(STATED), by_argument(dt=1e-3, method="rk4")
    q0, par = np.tile(run.q[0], (3, 1)), model.checked_parameters(model.parameters)
    many = sf.simulate_batch(model, q0, t_end=2.5, dt=1e-3, method="rk4")
    for i in range(3):
        assert [found.name for found in many.events(i)] == [found.name for found in run.events]
        assert np.array_equal(many[i].q[-1], run.q[-1])
    stepper = sf.Stepper(model, dt=1e-3)
    stepper.reset(START)
    while stepper.t < 2.5 - 1e-9 and stepper.step():
        pass
    assert np.array_equal(stepper.q, run.q[-1]) and np.array_equal(stepper.par, run.par_over_time[-1])
    assert not np.array_equal(stepper.par, par) and [one.name for one in stepper.events] == [
        one.name for one in run.events
    ]
    steppers = sf.Steppers(model, 2, dt=1e-3)
    steppers.reset(np.tile(run.q[0], (2, 1)))
    while steppers.t[0] < 2.5 - 1e-9:
        steppers.step()
    assert np.array_equal(steppers.q[1], run.q[-1])


@pytest.mark.parametrize("target", ["c", "mex", "sfunction"])
def test_exported_texts_are_those_by_argument(tmp_path: Path, target: Target) -> None:
    """Every file; S-functions, which look for no events, say so."""
    given: dict[str, Any] = {} if target == "sfunction" else {"events": GIVEN}
    written = sf.export(STATED, target, tmp_path / "stated", start=START)
    other = sf.export(BARE, target, tmp_path / "bare", start=START, **given)
    note = "events of the model are left out, and what they do: slips, catches, turns"
    assert (note in written.notes) == (target == "sfunction")
    for file in written.files:
        if file.suffix != ".md":
            assert file.read_bytes() == (other.files[0].parent / file.name).read_bytes(), file.name


@pytest.mark.parametrize("target", ["urdf", "mjcf", "cuda"])
def test_targets_without_steps_note_that_events_are_left_out(tmp_path: Path, target: Target) -> None:
    """Those of an argument are refused, as before."""
    system = slide(gravity=(0, 0, -9.81))
    notes = sf.export(replace(system, events={"low": "x + 1"}), target, tmp_path / target).notes
    assert "events of the model are left out, and what they do: low" in notes
    with pytest.raises(sf.ExportError, match=f"'{target}' looks for no events"):
        sf.export(system, target, tmp_path / "other", events={"low": "x + 1"})


def test_a_caller_adds_replaces_and_leaves_out() -> None:
    """By name."""
    model = sf.compile(STATED)
    early = sf.Event("t - 0.5", action={"grip": 0})
    changed = sf.simulate(model, START, t_end=2.5, dt=1e-3, events={"slips": early, "turns": None, "half": "t - 1.2"})
    expected = {"slips": early, "catches": GIVEN["catches"], "half": "t - 1.2"}
    other = sf.simulate(sf.compile(BARE), START, t_end=2.5, dt=1e-3, events=expected)
    assert {found.name for found in changed.events} == {*expected}
    assert np.array_equal(changed.q, other.q)
    with pytest.raises(sf.UnknownNameError, match="no event 'slip' to leave out"):
        sf.simulate(model, START, t_end=0.1, events={"slip": None})
    given: dict[str, Any] = {"t_end": 0.1, "method": "ida"}
    with pytest.raises(sf.SymofrosError, match="event 'slips' has an action"):
        sf.simulate(model, START, **given)
    assert sf.simulate(model, START, **given, events=dict.fromkeys(STATED.events)).outcome.ok


def test_what_looks_for_no_events_refuses_those_that_act() -> None:
    """Rollouts, which would go on as if nothing happened; crossings alone change nothing."""
    system = slide(gravity=(1, 0, 0))
    u = np.zeros((3, sf.compile(system).nu))
    for event, refused in (("x - 1", False), (sf.Event("x - 1", action={"dx": 0}), True)):
        model = sf.compile(replace(system, events={"there": event}))
        if refused:
            with pytest.raises(sf.SymofrosError, match="rollout: events of model"):
                sf.rollout(model, [0.0], [0.0], u, dt=0.01)
        else:
            assert len(sf.rollout(model, [0.0], [0.0], u, dt=0.01).q)


def diagram(system: sf.System, **options: Any) -> sf.Diagram:
    made = sf.Diagram("docking")
    made.add_model("m", system, START)
    made.add(blocks.ForwardDynamics(name="plant", model="m", **options))
    return made


def test_diagrams_act_as_their_models_state() -> None:
    """The block's own events come after, or in the place of those; `engaged` contradicts both."""
    run = sf.Simulation(diagram(STATED)).run(2.5, dt=1e-3)
    other = sf.Simulation(diagram(BARE, events=GIVEN)).run(2.5, dt=1e-3)
    assert [found.name for found in run.events["plant"]] == [found.name for found in other.events["plant"]]
    assert np.array_equal(run["plant.q"], other["plant.q"])
    fewer = sf.Simulation(diagram(STATED, events=dict.fromkeys(STATED.events) | {"half": "t - 1.2"})).run(2.5, dt=1e-3)
    assert [found.name for found in fewer.events["plant"]] == ["half"]
    engaged = diagram(STATED, engaged=True)
    engaged.add(blocks.Constant(name="all", value=[1.0, 1.0, 1.0], period=0.01))
    engaged.connect("all.y", "plant.engaged")
    with pytest.raises(sf.DescriptionError, match=r"engaged constraints beside events\n.*events: slips, catches"):
        sf.Simulation(engaged)


@pytest.mark.parametrize("name", ["x", "t"])
def test_events_of_time_and_constants_are_those_by_argument(name: str) -> None:
    """Time was written `t`, as what is called t is: any event of time ended runs by "unknown symbol"."""
    (body,) = slide().bodies
    assert body.joint is not None
    bare = replace(slide(gravity=(1, 0, 0)), bodies=(replace(body, joint=replace(body.joint, name=name)),))
    events = {"there": sf.Event(f"`{name}` + t - pi/4", action={f"d`{name}`": f"t*pi - d`{name}`"})}
    runs = [
        sf.simulate(sf.compile(system), t_end=1.0, dt=0.01, events=given)
        for system, given in ((replace(bare, events=events), None), (bare, events))
    ]
    assert len(runs[0].events) == 1 and np.array_equal(runs[0].q, runs[1].q)
