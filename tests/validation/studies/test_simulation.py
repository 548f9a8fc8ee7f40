"""Races of motions: each side moves the motion it says, and errs as little as it says."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from validation.__main__ import app
from validation.studies import simulation


def test_arm_is_the_same_motion_on_both_sides() -> None:
    row = simulation.arm(1, span=0.5)
    assert row.engine_run is not None
    # RK4 with a millisecond on both sides: alike to a fraction of their error, and far from the start.
    assert 0 < row.generated.error < 1e-4 and row.engine_run.error == pytest.approx(row.generated.error, rel=0.05)


@pytest.mark.slow
def test_spinning_beam_at_equal_accuracy() -> None:
    row = simulation.spinning_beam(1, meshes=((8, 0.0125),))
    assert row.engine_run is not None
    assert row.generated.error < 2.5e-3 and row.engine_run.error <= row.generated.error


@pytest.mark.slow
def test_planar_robot() -> None:
    row = simulation.planar_robot(1, span=0.2)
    assert row.engine_run is None and row.generated.error < 1e-2 and row.real_time > 0


@pytest.mark.slow
def test_report(tmp_path: Path) -> None:
    found = CliRunner().invoke(
        app, ["simulation", "--motion", "planar_robot", "--repeats", "1", "--report", str(tmp_path)]
    )
    assert found.exit_code == 0
    assert json.loads((tmp_path / "simulation.json").read_text())["races"][0]["motion"].startswith("planar")
    assert "| planar flexible robot with friction |" in (tmp_path / "simulation.md").read_text()
