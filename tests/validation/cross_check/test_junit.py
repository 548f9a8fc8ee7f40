"""Our JUnit files as another program reads them: junitparser, which servers' tools use."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import junitparser
import pytest
from typer.testing import CliRunner

from tests.validation.subjects import URDF, pendulum
from validation.__main__ import app
from validation.checking import ModelResult, Settings, check, failed
from validation.comparison.errors import Comparison
from validation.contract.interface import Subject
from validation.cross_check.baseline import Regression
from validation.cross_check.junit import to_junit

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
