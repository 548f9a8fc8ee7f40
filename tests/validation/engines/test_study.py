"""The whole matrix: half of the questions in a second process, with the cells of one; what leaves its report alone."""

from __future__ import annotations

import json
import os
from pathlib import Path
from types import SimpleNamespace

import pytest
from typer.testing import CliRunner

from tests.late import require
from validation.__main__ import app
from validation.engines import parts, study
from validation.engines.interface import Registry
from validation.engines.plugins import OWN
from validation.engines.releases import Opened
from validation.engines.workers import Worker

NAMES = ("revolute x", "prismatic oblique", "ball")


@pytest.mark.parametrize("engine", ["exudyn"])
def test_two_processes_give_the_cells_of_one(engine: str, monkeypatch: pytest.MonkeyPatch) -> None:
    require(engine, "validation")
    every, told = study.questions(), list[str]()
    run = SimpleNamespace(advance=told.append)
    with Worker() as worker:
        reach = Opened({engine: OWN[engine]}, worker=worker)
        found = []
        for processors in (1, 2):
            monkeypatch.setattr(os, "cpu_count", lambda processors=processors: processors)
            found.append([one.cell for one in study._all(run, reach, every, NAMES)])  # type: ignore[arg-type]
    assert found[0] == found[1] and {cell.model for cell in found[0]} == set(NAMES)
    assert sorted(told) == sorted(2 * NAMES)


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
    ],
)
def test_what_asks_a_part_leaves_the_whole_report(
    options: str, writes: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    require("exudyn", "validation")
    require("mujoco", "validation")
    names = tuple(NAMES)
    known = Registry({name: OWN[name] for name in ("mujoco", "exudyn")})
    monkeypatch.setattr(study, "questions", lambda: dict.fromkeys(names))
    monkeypatch.setattr(study, "registry", lambda: known)
    for asking in ("_all", "_within_a_minute"):
        monkeypatch.setattr(study, asking, lambda *_: [])
    engine = {"name": "mujoco", "version": OWN["mujoco"].version(), "conventions": [], "functions": {}}
    part: dict[str, object] = dict.fromkeys(("cells", "corrected", "identities", "functions", "absent"), {})
    part |= {"question": parts.question(), "engines": [engine], "models": names, "proofs": ()}
    stored = tmp_path / ("reports/engines.json" if "--update" in options else "stored.json")
    stored.parent.mkdir(exist_ok=True)
    stored.write_text(json.dumps(part | {"revision": "", "date": ""}), encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(app, ["engines", *options.split()])
    assert result.exit_code in (0, 1), result.output
    written = tmp_path / ("apart" if "apart" in options else "reports") / "engines.json"
    assert written.exists() is writes
    if "--update" in options:
        assert parts.engines_of([json.loads(written.read_text())]) == {"mujoco", "exudyn"}
    assert ("Report: " in result.output) is writes
