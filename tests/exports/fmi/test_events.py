"""Events of FMUs: Co-Simulation looks for them and does what they do; Model Exchange is not offered."""

from __future__ import annotations

from pathlib import Path

import fmpy
import pytest

import symofros as sf
from tests.diagrams.run.test_switching import CASES
from tests.exports.c.test_events import BALL, STRIKE
from tests.exports.fmi.logs import heard
from tests.exports.fmi.test_fmu import quickly


@pytest.mark.parametrize("version", [2, 3])
def test_a_ball_bounces_in_co_simulation(tmp_path: Path, version: int) -> None:
    """As in sf.simulate, whatever the communication step; kept states know which events have acted for good."""
    events = {**STRIKE, "heavy": sf.Event("t - 0.1", action={"dz": "dz - 1"}, once=True)}
    with quickly():
        sf.export(BALL, f"fmu{version}", tmp_path, events=events, start={"z": 0.8})  # type: ignore[arg-type]
    unit = str(tmp_path / "ball.fmu")
    assert fmpy.read_model_description(unit).modelExchange is None
    done = fmpy.simulate_fmu(unit, stop_time=0.9, output_interval=0.01, output=["q.z", "v.z"])
    run = sf.simulate(sf.compile(BALL), [0.8], t_end=0.9, events=events, dt=1e-3)
    assert len(run.events) >= 3 and done["q.z"][-1] == pytest.approx(run.q[-1, 0], abs=1e-9)
    assert done["v.z"][-1] == pytest.approx(run.v[-1, 0], abs=1e-8)


@pytest.mark.parametrize("version", [2, 3])
def test_a_ball_rests_and_is_lifted_in_co_simulation(tmp_path: Path, version: int) -> None:
    """As in sf.simulate, which has the same threshold here."""
    stated = CASES["rest"]
    with quickly():
        sf.export(stated.system, f"fmu{version}", tmp_path, events=stated.events, start=stated.start)  # type: ignore[arg-type]
    unit = str(tmp_path / "resting.fmu")
    done = fmpy.simulate_fmu(unit, stop_time=1.0, output_interval=0.01, output=["q.z", "v.z"])
    run = sf.simulate(sf.compile(stated.system), [0.05], t_end=1.0, events=stated.events, dt=1e-3)
    assert run.events[-1].name == "strike opens" and abs(done["q.z"][50]) < 1e-12
    assert done["q.z"][-1] == pytest.approx(run.q[-1, 0], abs=1e-11)
    assert done["v.z"][-1] == pytest.approx(run.v[-1, 0], abs=1e-11)


def test_importers_are_told_that_a_motion_has_ended(tmp_path: Path) -> None:
    """Who repeats a step that is discarded asks whether that makes sense: a start below the floor never moves on."""
    stated = CASES["rest"]
    with quickly():
        sf.export(stated.system, "fmu2", tmp_path, events=stated.events, start=stated.start)
    unit = str(tmp_path / "resting.fmu")
    with heard() as (logger, log):
        done = fmpy.simulate_fmu(
            unit, stop_time=1.0, output_interval=0.01, start_values={"q.z": -0.1}, output=["q.z"], logger=logger
        )
    assert done["time"][-1] == 0.0 and len(log) < 20
    assert "a contact that rests is penetrated" in "".join(log)
