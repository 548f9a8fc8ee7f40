"""Diagrams in real time, briefly: the robot follows its path, and the report says what was measured."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import symofros as sf
from validation.__main__ import app
from validation.studies import realtime
from validation.studies.reports.realtime import compose


@pytest.mark.parametrize("python", [False, True])
def test_the_robot_follows_its_path(python: bool) -> None:
    run = sf.Simulation(realtime.robot(1e-3, python=python)).run(1.5, dt=1e-3, record=1e-2)
    path = realtime.SWING * np.sin(realtime.RATE * run.t)[:, np.newaxis]
    assert np.abs(run["plant.q"] - path)[run.t > 0.5].max() < 0.01
    if python:
        # What is received at a sample was sent at the one before, so nobody takes the last packet.
        assert run.kept["tx"]["sent"] == 1501 and run.kept["rx"]["received"] == 1500
        assert run.kept["log"]["q"].shape == (1501, 6)


@pytest.mark.slow
def test_report(tmp_path: Path) -> None:
    found = CliRunner().invoke(app, ["realtime", "--seconds", "0.1", "--report", str(tmp_path)])
    assert found.exit_code == 0, found.output
    data = json.loads((tmp_path / "realtime.json").read_text())
    rows = data["diagrams"]
    assert [row["instants"] for row in rows[:4]] == [101, 101, 101, 501]
    assert all(0 <= row["minimum"] <= row["median"] <= row["p999"] <= row["maximum"] for row in rows)
    assert {row["first"] for row in rows} == ({False, True} if realtime.may_come_first() else {False})
    text = (tmp_path / "realtime.md").read_text()
    assert "| robot, 5 kHz | ordinary |" in text and "load" in text
    assert all(row["late"]["share"][0] <= 1.0 and row["late"]["share"][-1] == 0.0 for row in rows)
    assert "share of instants that began later" in (tmp_path / "realtime.html").read_text()
    assert "late (medians)" in compose(data).summary
