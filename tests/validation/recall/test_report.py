"""The command from a fault's name to its score, by a suite that answers at once, and by the harness."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from validation.__main__ import app
from validation.engines.asking import questions
from validation.engines.plugins import OWN
from validation.engines.releases import Opened, Release
from validation.faults.entry import faults
from validation.recall import report

NAME = "pinocchio_jacobian_rate_aligned"
SUITE = "{python} -c \"print('not ok' if '{version}' == '" + faults()[NAME].wrong + "' else 'ok', '%s')\""


def asked(*arguments: str) -> dict[str, object]:
    done = CliRunner().invoke(app, ["recall", NAME, *arguments, "--json"])
    rows = json.loads(done.stdout)["faults"]
    assert len(rows) == 1
    return dict(rows[0])


@pytest.mark.parametrize("check, score", [("getFrameJacobianTimeVariation of a tip", "hit"), ("colours", "miss")])
def test_a_suite_is_scored(check: str, score: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(report, "kept", lambda folder, requirements: Path(sys.executable))
    monkeypatch.setattr(report, "size_of", lambda python: 0.0)
    row = asked("--suite", SUITE % check)
    assert (row["score"], row["alarms"], row["cells"]) == (score, 0, 2)


def test_releases_that_can_not_be_asked_are_no_misses(monkeypatch: pytest.MonkeyPatch) -> None:
    @contextmanager
    def none(pairs: Sequence[tuple[object, Release]], folder: Path) -> Iterator[Opened]:
        yield Opened(failures={release: "no wheels" for _, release in pairs})

    monkeypatch.setattr(report, "opened", none)
    row = asked()
    assert (row["score"], row["why"]) == ("not asked", "no wheels")


def test_trees_are_called_as_the_engine_calls_what_they_state() -> None:
    called = report.stated_by(OWN["mujoco"], questions())
    assert called["attached chain"].done == "MjSpec, attach_body" and not called["revolute x"].done
    assert "equality/connect" in called["point between branches"].called
    written = report.stated_by(OWN["pybullet"], questions())
    assert written["urdf: plain, written"].done == "UrdfEditor.saveUrdf" and not written["urdf: plain"].done


def test_a_half_has_its_own_faults_alone() -> None:
    done = CliRunner().invoke(app, ["recall", NAME, "--frozen"])
    assert done.exit_code == 2 and NAME in done.output


OTHER = "pinocchio_universal_coriolis"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of a report of two faults, both missed."""
    monkeypatch.setattr(report, "kept", lambda folder, requirements: Path(sys.executable))
    monkeypatch.setattr(report, "size_of", lambda python: 0.0)
    named(tmp_path, NAME, OTHER, "--suite", SUITE % "colours")
    return tmp_path


def named(folder: Path, *arguments: str) -> dict[str, Any]:
    CliRunner().invoke(app, ["recall", *arguments, "--report", str(folder)])
    return dict(json.loads((folder / "recall.json").read_text(encoding="utf-8")))


def test_an_update_keeps_the_rows_of_other_faults(folder: Path) -> None:
    before = {row["name"]: row for row in named(folder, NAME, OTHER, "--suite", SUITE % "colours")["faults"]}
    after = named(folder, NAME, "--update", "--suite", SUITE % "colours")
    rows = {row["name"]: row for row in after["faults"]}
    assert rows.keys() == before.keys() == {NAME, OTHER} and "origin" not in rows[NAME]
    assert rows[OTHER].pop("origin").keys() == {"revision", "date"} and rows[OTHER] == before[OTHER]
    assert "When the 2 faults were asked, where earlier" in (folder / "recall.md").read_text(encoding="utf-8")
    after = named(folder, OTHER, "--update", "--suite", SUITE % "colours")
    assert [row["name"] for row in after["faults"] if "origin" in row] == [NAME]


def test_a_report_of_another_way_of_asking_is_not_updated(folder: Path) -> None:
    text = (folder / "recall.json").read_text(encoding="utf-8")
    for arguments in (["--smoke"], ["--suite", "another"]):
        done = CliRunner().invoke(app, ["recall", NAME, "--update", *arguments, "--report", str(folder)])
        assert done.exit_code == 2 and "ask alike" in done.output.replace("\n", " ")
    assert (folder / "recall.json").read_text(encoding="utf-8") == text
    done = CliRunner().invoke(app, ["recall", NAME, "--update", "--report", str(folder / "none")])
    assert done.exit_code == 2 and "leave --update out" in " ".join(done.output.replace("│", " ").split())
