"""`symofros simulate`."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

import reference_models
from symofros.__main__ import app

MODELS = Path(reference_models.__file__).parent
PENDULUM = str(MODELS / "rigid" / "double_pendulum.yaml")
DOCKING = str(MODELS / "closed" / "docking.yaml")
FOUR_BAR = str(MODELS / "closed" / "four_bar.yaml")


def run(*arguments: str):
    return CliRunner().invoke(app, ["simulate", *arguments])


def test_simulate_reports_the_outcome_and_writes_files(tmp_path: Path) -> None:
    options = "--set q1=1 --method dop853 --every 0.1 --json".split()
    found = run(PENDULUM, "0.5", *options, "-o", str(tmp_path / "r.csv"), "--picture", str(tmp_path / "r.png"))
    assert found.exit_code == 0
    said = json.loads(found.stdout)
    assert said["ok"] and said["outcome"]["kind"] == "finished" and abs(said["energy_change"]) < 1e-5
    assert len((tmp_path / "r.csv").read_text().splitlines()) == 7
    assert (tmp_path / "r.png").stat().st_size > 10_000


def test_output_without_json_is_readable_text() -> None:
    found = run(PENDULUM, "0.1", "--input", "q1=3*sin(t)")
    assert found.exit_code == 0
    assert "finished at t = 0.1 s" in found.stdout and "times real time" in found.stdout


def test_events_that_the_file_states_act_and_are_listed() -> None:
    """A hand loses its part, and a rope catches it."""
    said = json.loads(run(DOCKING, "2.5", "--json").stdout)
    acted = [(found["name"], round(found["t"], 3)) for found in said["events"] if found["name"] != "turns"]
    assert said["ok"] and acted == [("slips", 0.497), ("catches", 0.577)]
    assert sum(found["energy_lost"] for found in said["events"]) > 7.0
    text = run(DOCKING, "2.5").stdout
    assert "energy lost" in text and "catches" in text


def test_loops_are_closed_first() -> None:
    found = run(FOUR_BAR, "0.1", "--json")
    assert found.exit_code == 0 and json.loads(found.stdout)["ok"]


def test_stated_loop_coordinates_are_kept_or_refused() -> None:
    found = run(FOUR_BAR, "0.01", "--set", "q1=1", "--set", "dq1=1", "--every", "0.01", "--json")
    assert found.exit_code == 0 and not json.loads(found.stdout)["outcome"]["notes"]
    assert json.loads(found.stdout)["last"]["q1"] == pytest.approx(1.01, abs=1e-3)
    found = run(FOUR_BAR, "0.01", "--set", "q1=1", "--set", "q2=-0.5", "--set", "q3=0.3")
    assert found.exit_code != 0 and "q2 = -0.5 would be -" in " ".join(found.output.split())


def test_a_run_that_fails_ends_with_1() -> None:
    found = run(PENDULUM, "1", "--method", "euler", "--dt", "0.5", "--input", "q1=exp(q1^2+100)*1e200")
    assert found.exit_code == 1 and "try:" in found.stdout


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--set", "q9=1"], "no coordinate, speed or run-time parameter 'q9'"),
        (["--set", "q1"], "NAME=VALUE"),
        (["--set", "q1=fast"], "'q1' is given no number"),
        (["--input", "q1=__class__"], "formula"),
        (["--method", "rk5"], "no method 'rk5'"),
        (["-o", "run.xlsx"], "can't save as"),
        (["--plot", "window"], "of diagrams only"),
    ],
)
def test_invalid_arguments_of_simulate_are_refused(arguments: list[str], words: str) -> None:
    found = run(PENDULUM, "0.01", *arguments)
    assert found.exit_code == 2 and words in found.output
