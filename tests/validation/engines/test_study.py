"""The command that measures the matrix: what leaves its report alone, and what an update asks."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from tests.late import require
from validation.__main__ import app
from validation.engines import parts, renewal, study
from validation.engines.interface import Registry
from validation.engines.models.kinds import tree_of
from validation.engines.plugins import OWN

NAMES = ("revolute x", "prismatic oblique", "ball")
ENGINES = ("mujoco", "exudyn")


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two engines and three trees."""
    for engine in ENGINES:
        require(engine, "validation")
    known = Registry({name: OWN[name] for name in ENGINES})
    monkeypatch.setattr(study, "questions", lambda: {name: tree_of(name) for name in NAMES})
    for module in (study, renewal):
        monkeypatch.setattr(module, "registry", lambda: known)


def stored(**changes: Any) -> str:
    """A report of MuJoCo that does not say what its cells answer."""
    data: dict[str, Any] = dict.fromkeys(("cells", "corrected", "identities", "functions", "absent"), {})
    engine = {"name": "mujoco", "version": OWN["mujoco"].version(), "conventions": [], "functions": {}}
    data |= {"engines": [engine], "models": NAMES, "proofs": [], "revision": "old", "date": ""}
    return json.dumps(data | changes)


@pytest.mark.parametrize(
    ("options", "writes"),
    [
        ("", True),
        ("--engine mujoco --engine exudyn", True),
        ("--engine exudyn", False),
        ("--engine exudyn --report apart", True),
        ("--engine exudyn --part stored.json", True),
        ("--kinds ball", False),
        ("--kinds ball --report apart", True),
        ("--smoke", False),
        ("--engine exudyn --update", True),
        ("--update", True),
    ],
)
def test_partial_runs_leave_the_whole_report(
    few: None, options: str, writes: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(study, "within_a_minute", lambda *_: [])
    monkeypatch.setattr(renewal, "all_cells", lambda *_: [])
    path = tmp_path / ("reports/engines.json" if "--update" in options else "stored.json")
    path.parent.mkdir(exist_ok=True)
    path.write_text(stored(), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(app, ["engines", *options.split()])
    assert result.exit_code in (0, 1), result.output
    written = tmp_path / ("apart" if "apart" in options else "reports") / "engines.json"
    is_written = written.exists() and json.loads(written.read_text())["revision"] != "old"
    assert is_written is writes and ("Report: " in result.output) is writes
    if "--update" in options:
        assert set(parts.engines_of([json.loads(written.read_text())])) == set(ENGINES)


def test_an_update_asks_what_is_new_or_changed_and_engines_that_are_named(
    few: None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    reported: list[dict[str, list[str]]] = []
    monkeypatch.setattr(renewal, "all_cells", lambda *given: reported.append(dict(given[3])) or [])
    path = tmp_path / "reports" / "engines.json"
    path.parent.mkdir()
    path.write_text(stored(), encoding="utf-8")
    monkeypatch.chdir(tmp_path)

    def asked(*options: str) -> dict[str, list[str]]:
        reported.clear()
        result = CliRunner().invoke(app, ["engines", "--update", *options])
        assert result.exit_code in (0, 1), result.output
        return reported[0]

    def change(**changed: Any) -> None:
        path.write_text(json.dumps(json.loads(path.read_text()) | changed))

    assert asked() == dict.fromkeys(NAMES, list(ENGINES))  # The stored report does not say what it answers.
    assert asked() == {}
    assert asked("--engine", "exudyn") == dict.fromkeys(NAMES, ["exudyn"])
    digests = json.loads(path.read_text())["asked"]
    change(asked={"mujoco": digests["mujoco"] | {"ball": ["another"]}, "exudyn": {"ball": digests["exudyn"]["ball"]}})
    assert asked() == {"revolute x": ["exudyn"], "prismatic oblique": ["exudyn"], "ball": ["mujoco"]}
    assert asked() == {}
