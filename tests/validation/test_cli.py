import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner, Result

from tests.validation.subjects import URDF
from validation.__main__ import app
from validation.adapters.pinocchio import tree as pinocchio
from validation.checking import failed
from validation.contract.interface import Subject

KEYS = {"model", "engine", "quantity", "states", "error", "tolerance", "ok"}


@pytest.fixture
def arm(tmp_path: Path) -> Path:
    path = tmp_path / "arm.urdf"
    path.write_text(URDF)
    return path


@pytest.fixture
def run(tmp_path: Path) -> Any:
    def invoke(*arguments: object) -> Result:
        common = ["--states", "10", "--report", str(tmp_path / "reports")]
        return CliRunner().invoke(app, ["check", *map(str, arguments), *common])

    return invoke


def test_an_agreeing_model_exits_with_zero(run: Any, arm: Path, tmp_path: Path) -> None:
    result = run(arm)
    assert result.exit_code == 0, result.output
    assert "pinocchio-urdf" in result.stdout and "agree" in result.stdout and "not asked in full" not in result.stdout
    for name in ("check.html", "check.md", "check.json"):
        assert (tmp_path / "reports" / name).stat().st_size > 500


def test_json_is_all_there_is_on_stdout(run: Any, arm: Path) -> None:
    result = run(arm, "--json")
    content = json.loads(result.stdout)
    assert content["ok"] is True and result.exit_code == 0
    assert all(row.keys() >= KEYS and row["ok"] and row["error"] <= row["tolerance"] for row in content["comparisons"])
    engines = {row["engine"] for row in content["comparisons"]}
    assert engines >= {"pinocchio", "mujoco", "pinocchio-urdf", "mujoco-urdf", "interpreted"}
    assert {row["states"] for row in content["comparisons"] if row["engine"] == "mujoco-urdf"} >= {10}


def test_missing_files_and_unknown_words_are_errors_in_four_parts(tmp_path: Path) -> None:
    for arguments, words in (
        (["check", str(tmp_path / "nosuch.urdf")], "does not exist"),
        (["stabiltiy"], "did you mean 'stability'?"),
        (["simulation"], "its question is answered by 'pareto'"),
        (["check", "no_such_robot"], "no_such_robot"),
        (["check", "ur5", "--engine", "exodyn"], "exodyn"),
    ):
        result = CliRunner().invoke(app, arguments)
        assert result.exit_code == 2 and words in result.output and "DISAGREES" not in result.output, result.output
        assert all(part in result.output for part in ("found:", "rule:", "remedy:")), result.output


def test_a_file_that_does_not_load_fails_the_check(run: Any, arm: Path, tmp_path: Path) -> None:
    broken = tmp_path / "broken.urdf"
    broken.write_text("<robot name='x'><link")
    result = run(broken, arm, "--json", "--workers", 1)
    content = json.loads(result.stdout)
    assert result.exit_code == 2 and content["ok"] is False
    (row,) = (row for row in content["comparisons"] if not row["ok"])
    assert row["model"] == "broken" and row["quantity"] == "load" and row["error"] is None
    assert any(row["model"] == "arm" and row["ok"] for row in content["comparisons"])


def test_a_disagreeing_model_exits_with_one(run: Any, arm: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A gravity that is one part in a billion off."""
    right = pinocchio.build

    def build(subject: Subject) -> Any:
        engine: Any = right(subject)
        engine.model.gravity.linear = engine.model.gravity.linear * (1 + 1e-9)
        return engine

    monkeypatch.setattr(pinocchio, "build", build)
    result = run(arm)
    assert result.exit_code == 1
    assert "arm, pinocchio: gravity: error 1.0e-09" in result.stdout and "disagree" in result.stdout


def test_an_interrupted_check_keeps_its_rows(arm: Path, run: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(cases: Any, settings: Any, workers: Any, done: Any) -> None:
        done(failed(cases[0].label, "load", "x"))
        raise KeyboardInterrupt

    monkeypatch.setattr("validation.cross_check.measure.run_cases", interrupt)
    result = run(arm, "ur5")
    assert result.exit_code == 130 and "Interrupted: 1 model not checked" in result.stdout


def unasked(*arguments: str) -> Result:
    return CliRunner().invoke(app, ["check", "--states", "10", *arguments])


def test_a_check_of_some_models_writes_no_report_unasked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    result = unasked("pendulum", "--engine", "pinocchio")
    assert result.exit_code == 0 and "--report FOLDER" in result.stdout
    assert not (tmp_path / "reports").exists()


@pytest.mark.slow
def test_a_run_cut_short_leaves_the_whole_report(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = "pendulum", "cart_pole", "--engine", "pinocchio", "--report", str(tmp_path)
    assert unasked(*asked).exit_code == 0
    whole = (tmp_path / "check.json").read_bytes()

    def interrupted(cases: Any, settings: Any, workers: int, done: Any) -> None:
        done(failed(cases[0].label, "check", "x"))
        raise KeyboardInterrupt

    monkeypatch.setattr("validation.cross_check.measure.run_cases", interrupted)
    result = unasked(*asked)
    assert result.exit_code == 130 and "stays that of a whole run" in result.stdout
    assert (tmp_path / "check.json").read_bytes() == whole
    assert unasked(*asked[:-1], str(tmp_path / "other")).exit_code == 130
    assert (tmp_path / "other" / "check.json").exists()


def test_a_model_that_no_engine_can_judge_did_not_fail(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("validation.reporting.command._PAUSE", 0.0)  # A line for each model, whichever comes last.
    result = unasked("flexible_pendulum", "pendulum", "cart_pole", "--engine", "mujoco")
    assert result.exit_code == 1 and "flexible_pendulum: 1 agree, judged by no engine" in result.stderr
    (row,) = (line for line in result.stdout.splitlines() if line.startswith(" flexible_pendulum "))
    assert row.rstrip().endswith("not judged") and "missed" not in result.stdout and "fail" not in result.stdout.lower()
    assert "not compared: flexible_pendulum, mujoco: joint" in result.stdout
    assert "1 model judged by no independent engine." in result.stdout
