"""Races of motions: each side moves the scene it says, and errs as little as it says."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from validation.__main__ import app
from validation.studies import simulation


def test_arm_is_the_same_motion_on_both_sides() -> None:
    row = simulation.arm(1, span=0.5)
    assert row.theirs is not None
    # RK4 with a millisecond on both sides: alike to a fraction of their error, and far from the start.
    assert 0 < row.ours.error < 1e-4 and row.theirs.error == pytest.approx(row.ours.error, rel=0.05)


def test_spinning_beam_at_equal_accuracy() -> None:
    row = simulation.spinning_beam(1, meshes=((8, 0.0125),))
    assert row.theirs is not None
    assert row.ours.error < 2.5e-3 and row.theirs.error <= row.ours.error


def test_planar_robot() -> None:
    row = simulation.planar_robot(1, span=0.2)
    assert row.theirs is None and row.ours.error < 1e-2 and row.real_time > 0


def test_report(tmp_path: Path) -> None:
    found = CliRunner().invoke(
        app, ["simulation", "--scene", "planar_robot", "--repeats", "1", "--report", str(tmp_path)]
    )
    assert found.exit_code == 0
    assert json.loads((tmp_path / "simulation.json").read_text())["races"][0]["scene"].startswith("planar")
    assert "| planar flexible robot with friction |" in (tmp_path / "simulation.md").read_text()


def test_unknown_scene() -> None:
    found = CliRunner().invoke(app, ["simulation", "--scene", "moon"])
    assert found.exit_code == 2 and "no scene 'moon'" in found.output
