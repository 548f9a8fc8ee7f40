"""A run held to a stored one: what became worse is named, what rounding and noise explain is not."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ElementTree
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import junitparser
import pytest
from typer.testing import CliRunner, Result

from tests.validation.subjects import URDF, pendulum
from validation.__main__ import app
from validation.checking import ModelResult, Settings, check, failed
from validation.comparison.errors import Comparison
from validation.contract.interface import Subject
from validation.cross_check import measure, speed
from validation.cross_check.baseline import Baseline, BaselineError, Regression, machine_of, slowest
from validation.cross_check.measure import to_junit
from validation.cross_check.record import Record, as_data
from validation.cross_check.speed import Speed, paired

NASTY = "<b>&\x00\x1b[1m'\""
STATUSES = {"disagree": junitparser.Failure, "failed": junitparser.Error, "unsupported": junitparser.Skipped}


@pytest.fixture(scope="module")
def models() -> list[ModelResult]:
    good = check(Subject("pendulum", pendulum()), Settings(states=20))
    wrong = Comparison(NASTY, "mujoco", "bias", "disagree", 20, 3e-7, 1e-12, 1e-7, 4)
    cannot = Comparison(NASTY, "mujoco-urdf", "all", "unsupported", note=NASTY)
    return [
        good,
        ModelResult(NASTY, (wrong, cannot), seconds={"mujoco": 1.25, "compile": 0.5}),
        failed("gone", "load", "no"),
    ]


def parsed(text: str) -> junitparser.JUnitXml:
    return junitparser.JUnitXml.fromstring(text.encode())


def test_counts_names_and_times_match_the_run(models: list[ModelResult]) -> None:
    read = parsed(to_junit(models, 12.3))
    assert read.time == 12.3
    for suite, model in zip(read, models, strict=True):
        statuses = Counter(row.status for row in model.comparisons)
        assert suite.tests == len(model.comparisons) == len(list(suite))
        assert (suite.failures, suite.errors, suite.skipped) == tuple(statuses[name] for name in STATUSES)
        assert suite.time == pytest.approx(sum(model.seconds.values()), abs=1e-3)
        for case, row in zip(suite, model.comparisons, strict=True):
            assert case.name == row.quantity
            assert [type(one) for one in case.result] == [STATUSES[name] for name in (row.status,) if name in STATUSES]
    assert [suite.name for suite in read] == ["pendulum", NASTY.replace("\x00", "?").replace("\x1b", "?"), "gone"]


def test_the_suite_of_regressions_has_all_counts(models: list[ModelResult]) -> None:
    worse = Regression("arm", "mujoco", "bias", "less accurate", "1e-9 after 1e-15")
    *_, suite = parsed(to_junit(models[:1], 1.0, (worse,)))
    assert (suite.name, suite.tests, suite.failures, suite.errors, suite.skipped) == ("baseline", 1, 1, 0, 0)
    ((failure,),) = (case.result for case in suite)
    assert isinstance(failure, junitparser.Failure) and failure.message == "less accurate: 1e-9 after 1e-15"


def test_the_command_writes_the_listed_files(tmp_path: Path) -> None:
    (tmp_path / "arm.urdf").write_text(URDF)
    asked = ["check", str(tmp_path / "arm.urdf"), str(tmp_path / "gone.urdf"), "--states", "10", "--engine", "mujoco"]
    file = tmp_path / "junit.xml"
    done = CliRunner().invoke(app, [*asked, "--workers", "1", "--report", str(tmp_path), "--junit", str(file)])
    assert done.exit_code == 2, done.output
    arm, gone = junitparser.JUnitXml.fromfile(str(file))
    assert (arm.name, arm.failures, arm.errors) == ("arm", 0, 0) and arm.tests > 5 and arm.time > 0.0
    assert (gone.name, gone.tests, gone.errors) == ("gone", 1, 1)


SETTINGS = Settings(states=20)
SPEEDS = (Speed("pendulum", "mass_matrix", 0.5, 0.02, 50.0),)


@pytest.fixture(scope="module")
def checked() -> ModelResult:
    return check(Subject("pendulum", pendulum()), SETTINGS)


@pytest.fixture
def stored(checked: ModelResult, tmp_path: Path) -> Path:
    path = tmp_path / "check.json"
    path.write_text(json.dumps(as_data(SETTINGS, [checked], 1.0, (), SPEEDS)))
    return path


def judged(
    path: Path,
    result: ModelResult,
    change: Callable[[Comparison], Comparison | None] = lambda row: row,
    speeds: tuple[Speed, ...] = SPEEDS,
) -> list[tuple[str, str, str]]:
    rows = tuple(row for row in map(change, result.comparisons) if row is not None)
    data = as_data(SETTINGS, [replace(result, comparisons=rows)], 1.0, (), speeds)
    regressions, notes = Baseline.read(path).judge(Record.of(data), machine_of(data))
    assert notes == []
    return [(worse.quantity, worse.engine, worse.kind) for worse in regressions]


def only(quantity: str, engine: str, **changes: Any) -> Callable[[Comparison], Comparison]:
    def change(row: Comparison) -> Comparison:
        return replace(row, **changes) if (row.quantity, row.engine) == (quantity, engine) else row

    return change


def test_the_same_run_gives_no_regression(stored: Path, checked: ModelResult) -> None:
    assert judged(stored, checked) == []


def test_a_grown_error_is_a_regression_even_within_tolerance(stored: Path, checked: ModelResult) -> None:
    # Forward dynamics may be off by what the condition of M makes of rounding; the stored run was not.
    change = only("forward_dynamics", "pinocchio", error=1e-9, tolerance=1e-8)
    assert judged(stored, checked, change) == [("forward_dynamics", "pinocchio", "less accurate")]


def test_errors_of_rounding_move_with_the_order_of_summation(stored: Path, checked: ModelResult) -> None:
    assert judged(stored, checked, only("mass_matrix", "mujoco", error=1e-14)) == []
    assert judged(stored, checked, only("mass_matrix", "mujoco", error=1e-13)) != []


def test_missing_comparisons_are_named(stored: Path, checked: ModelResult) -> None:
    def without(row: Comparison) -> Comparison | None:
        return None if (row.quantity, row.engine) == ("bias", "mujoco") else row

    assert judged(stored, checked, without) == [("bias", "mujoco", "not compared")]
    refused = only("bias", "mujoco", status="unsupported", error=None, note="refused")
    assert judged(stored, checked, refused) != []


def test_a_slowdown_of_30_percent_is_named_and_noise_is_not(stored: Path, checked: ModelResult) -> None:
    slower = (replace(SPEEDS[0], ratio=1.3 * SPEEDS[0].ratio),)
    assert judged(stored, checked, speeds=slower) == [("mass_matrix", "", "slower")]
    assert judged(stored, checked, speeds=(replace(SPEEDS[0], ratio=1.05 * SPEEDS[0].ratio),)) == []


@pytest.mark.parametrize(
    ("noise", "growth", "decided"),
    [(0.0, 1.0, True), (0.05, 1.0, True), (0.2, 1.0, False), (0.2, 1.3, False), (1.0, 2.0, False)],
)
def test_speed_changes_within_noise_are_not_decided(
    stored: Path, checked: ModelResult, noise: float, growth: float, decided: bool
) -> None:
    data = as_data(SETTINGS, [checked], 1.0, (), (replace(SPEEDS[0], ratio=growth * SPEEDS[0].ratio, noise=noise),))
    regressions, notes = Baseline.read(stored).judge(Record.of(data), machine_of(data))
    assert regressions == [] and any("not decided" in note for note in notes) != decided


def test_speeds_of_another_machine_are_not_compared(stored: Path, checked: ModelResult) -> None:
    data = as_data(SETTINGS, [checked], 1.0, (), (replace(SPEEDS[0], ratio=9.0),))
    regressions, notes = Baseline.read(stored).judge(Record.of(data), ("another processor", "", "", ""))
    assert regressions == [] and "another machine" in notes[0]


def test_a_changed_description_is_noted_and_not_compared(stored: Path, checked: ModelResult) -> None:
    data = as_data(SETTINGS, [replace(checked, hash="0" * 16)], 1.0, ())
    regressions, notes = Baseline.read(stored).judge(Record.of(data), machine_of(data))
    assert regressions == [] and "its description has changed" in notes[0]


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("{", "can't be read as JSON"),
        ("[]", "no record of a check"),
        ('{"schema": 1, "comparisons": []}', "damaged"),
        ('{"schema": 1, "comparisons": [{"model": 3}], "models": [{"model": 1}]}', "damaged"),
    ],
)
def test_an_invalid_baseline_file_is_refused(text: str, complaint: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.json"
    path.write_text(text)
    with pytest.raises(BaselineError, match=complaint):
        Baseline.read(path)


def test_a_run_over_other_states_is_refused(stored: Path) -> None:
    with pytest.raises(BaselineError, match="--states 20 --seed 0"):
        Baseline.read(stored).require(21, 0)


def test_speed_ratios_are_measured_in_processor_time(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = 0

    def takes(nanoseconds: int) -> Callable[[], None]:
        def run() -> None:
            nonlocal clock
            clock += nanoseconds

        return run

    monkeypatch.setattr(speed.time, "thread_time_ns", lambda: clock)
    ratio, noise, nanoseconds = paired(takes(130_000), takes(100_000))
    assert (ratio, noise, nanoseconds) == (1.3, 0.0, 130_000)
    stored = Speed("m", "f", 1.0, 0.02, 1.0)
    assert slowest(stored, replace(stored, noise=0.03)) == pytest.approx(1.1)
    assert slowest(stored, replace(stored, noise=0.08)) == pytest.approx(1.2)


def invoke(folder: Path, *arguments: object) -> Result:
    engine = ["--engine", "pinocchio"]
    common = ["check", "pendulum", "--states", "10", *engine, "--report", str(folder)]
    return CliRunner().invoke(app, [*common, *map(str, arguments)])


def test_the_command_fails_where_a_stored_run_was_faster(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def timed(factor: float) -> Callable[[Subject], list[Speed]]:
        return lambda subject: [Speed(subject.label, "bias", factor, 0.01, 10.0 * factor)]

    monkeypatch.setattr(measure, "measure_speed", timed(1.0))
    assert invoke(tmp_path / "a", "--speed").exit_code == 0
    file = tmp_path / "a/check.json"
    assert invoke(tmp_path / "b", "--baseline", file).exit_code == 0
    monkeypatch.setattr(measure, "measure_speed", timed(1.3))
    junit = tmp_path / "junit.xml"
    result = invoke(tmp_path / "c", "--baseline", file, "--junit", junit)
    assert result.exit_code == 1, result.output
    assert "30% slower" in " ".join(result.stdout.split()) and "1 cell worse" in result.stdout
    suites = {suite.get("name"): suite for suite in ElementTree.parse(junit).getroot()}
    assert suites["baseline"].get("failures") == "1"
    assert suites["baseline"][0].get("name") == "bias"
