"""The whole matrix: half of the questions in a second process, with the cells of one; what leaves its report alone."""

from __future__ import annotations

import json
import os
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest
from typer.testing import CliRunner

from tests.late import require
from validation.__main__ import app
from validation.engines import parts, study
from validation.engines.interface import Registry, Tree, Unsupported
from validation.engines.matrix import Judged
from validation.engines.plugins import OWN
from validation.engines.releases import Opened
from validation.engines.report import TOPIC
from validation.engines.verdicts import Cell
from validation.engines.workers import Answer, Crashed, Worker
from validation.reporting.command import Run

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
            found.append([one.cell for one in study._all(run, reach, every, NAMES, parts.Finished(""))])  # type: ignore[arg-type]
    assert found[0] == found[1] and {cell.model for cell in found[0]} == set(NAMES)
    assert sorted(told) == sorted(2 * NAMES)


def test_an_interrupted_run_goes_on_where_it_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    require("mujoco", "validation")
    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(os, "cpu_count", lambda: 1)
    every, asked, run, stops = study.questions(), list[str](), Run(TOPIC), {NAMES[1]}
    plugins = {"mujoco": OWN["mujoco"]}
    ask = study._asker(plugins, None)  # type: ignore[arg-type]  # In this process.

    def interrupted(question: Tree) -> list[Judged]:
        asked.append(question.name)
        if question.name in stops:
            stops.clear()
            raise KeyboardInterrupt
        return ask(question)

    monkeypatch.setattr(study, "_asker", lambda *_: interrupted)
    reach = Opened(plugins)

    def cells() -> list[Judged]:
        finished = parts.Finished(study._key(run, reach))
        found = study._all(run, reach, every, NAMES, finished)
        finished.forget()
        return found

    with pytest.raises(KeyboardInterrupt):
        cells()
    found = cells()
    assert asked == [NAMES[0], NAMES[1], NAMES[1], NAMES[2]]
    assert [one.cell for one in found] == [one.cell for name in NAMES for one in ask(every[name])]
    asked.clear()  # The report has them: whoever asks once more measures once more.
    monkeypatch.setattr(parts, "distributions", lambda: [])
    assert len(cells()) == len(found)
    assert asked == list(NAMES)


def test_only_what_is_known_to_be_unchanged_is_taken_over(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run, own = Run(TOPIC), Opened({"mujoco": OWN["mujoco"]})
    key = study._key(run, own)
    assert key and key == study._key(run, own) != study._key(run, Opened({"exudyn": OWN["exudyn"]}))
    assert not study._key(run, Opened({"toy": OWN["mujoco"]}))
    monkeypatch.setattr(parts, "distributions", lambda: [SimpleNamespace(name="mujoco", version="0")])
    assert study._key(run, own) != key
    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path / "cache"))
    finished = parts.Finished("one")
    answer = Answer("gravity", Crashed("no answer in time"))
    crashed = Judged(Cell("mujoco", "ball", "gravity", "crashes"), answer, None, Tree("ball", ()))
    finished.keep("ball", [crashed])
    assert finished.of("ball") is None
    finished.keep("ball", [replace(crashed, answer=Answer("gravity", Unsupported("no")))])
    (path,) = (tmp_path / "cache" / "asked" / "one").iterdir()
    assert finished.of("ball") is not None and parts.Finished("one").of("ball") is not None
    path.write_bytes(path.read_bytes()[:-9])
    assert finished.of("ball") is None
    monkeypatch.setattr(parts, "_LEFT", path.stat().st_size)
    finished.keep("revolute x", [])
    assert finished.of("revolute x") is None
    parts.Finished("two")
    assert not path.exists()


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
