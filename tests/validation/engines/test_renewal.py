"""Cells of the matrix: half of the questions in a second process, an interrupted run, stored cells and proofs."""

from __future__ import annotations

import os
from collections.abc import Collection
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from tests.late import require
from validation.engines import parts, renewal
from validation.engines.asking import asker
from validation.engines.interface import Tree, Unsupported
from validation.engines.matrix import Judged
from validation.engines.models.kinds import tree_of
from validation.engines.plugins import OWN
from validation.engines.proving.proofs import faults
from validation.engines.releases import Opened
from validation.engines.report import TOPIC
from validation.engines.verdicts import Cell
from validation.engines.workers import Answer, Crashed, Worker
from validation.reporting.command import Run

NAMES = ("revolute x", "prismatic oblique", "ball")


@pytest.mark.parametrize("engine", ["exudyn"])
def test_two_processes_give_the_cells_of_one(engine: str, monkeypatch: pytest.MonkeyPatch) -> None:
    require(engine, "validation")
    every, reported, asked = {name: tree_of(name) for name in NAMES}, list[str](), dict.fromkeys(NAMES, (engine,))
    run = SimpleNamespace(advance=reported.append, expect=lambda *_: None)
    with Worker() as worker:
        reach = Opened({engine: OWN[engine]}, worker=worker)
        found = []
        for processors in (1, 2):
            monkeypatch.setattr(os, "cpu_count", lambda processors=processors: processors)
            cells = renewal.all_cells(run, reach, every, asked, {}, parts.Finished(False))  # type: ignore[arg-type]
            found.append([one.cell for one in cells])
    assert found[0] == found[1] and {cell.model for cell in found[0]} == set(NAMES)
    assert sorted(reported) == sorted(2 * NAMES)


def test_an_interrupted_run_goes_on_where_it_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    require("mujoco", "validation")
    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(os, "cpu_count", lambda: 1)
    every, reported, run, stops = {name: tree_of(name) for name in NAMES}, list[str](), Run(TOPIC), {NAMES[1]}
    plugins = {"mujoco": OWN["mujoco"]}
    ask = asker(plugins, None)  # type: ignore[arg-type]  # In this process.

    def interrupted(question: Tree, engines: Collection[str]) -> list[Judged]:
        reported.append(question.name)
        if question.name in stops:
            stops.clear()
            raise KeyboardInterrupt
        return ask(question, engines)

    monkeypatch.setattr(renewal, "asker", lambda *_: interrupted)
    reach, digests = Opened(plugins), {("mujoco", name): name for name in NAMES}

    def cells() -> list[Judged]:
        finished = parts.Finished()
        found = renewal.all_cells(run, reach, every, dict.fromkeys(NAMES, ("mujoco",)), digests, finished)
        finished.forget()
        return found

    with pytest.raises(KeyboardInterrupt):
        cells()
    found = cells()
    assert reported == [NAMES[0], NAMES[1], NAMES[1], NAMES[2]]
    assert [one.cell for one in found] == [one.cell for name in NAMES for one in ask(every[name], plugins)]
    reported.clear()  # The report has them: whoever asks once more measures once more.
    assert len(cells()) == len(found)
    assert reported == list(NAMES)


def _crashed(engine: str, model: str) -> Judged:
    answer = Answer("gravity", Crashed("no answer in time"))
    return Judged(Cell(engine, model, "gravity", "crashes"), answer, None, Tree(model, ()))


def test_only_what_is_known_to_be_unchanged_is_taken_over(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SYMOFROS_CACHE", str(tmp_path / "cache"))
    finished, asked = parts.Finished(), {"mujoco": "1", "exudyn": "2"}
    kept = replace(_crashed("mujoco", "ball"), answer=Answer("gravity", Unsupported("no")))
    finished.keep("ball", asked, [kept, _crashed("exudyn", "ball")])
    assert finished.of("ball", asked) == {"mujoco": [kept]} == parts.Finished().of("ball", asked)
    assert finished.of("ball", asked | {"mujoco": "3"}) == {} == parts.Finished(False).of("ball", asked)
    (path,) = (tmp_path / "cache" / "asked").glob("*/*")
    path.write_bytes(path.read_bytes()[:-9])
    assert finished.of("ball", asked) == {}
    monkeypatch.setattr(parts, "_LEFT", path.stat().st_size)
    finished.keep("revolute x", asked, [kept])
    assert finished.of("revolute x", asked) == {}
    monkeypatch.setattr(parts, "distributions", lambda: [SimpleNamespace(name="mujoco", version="0")])
    parts.Finished()
    assert not path.exists()


def _proof(cell: Cell) -> dict[str, object]:
    return {"engine": cell.engine, "function": cell.function, "model": cell.model, "models": [], "proven": True}


def test_stored_proofs_are_of_the_faults_that_there_are_now() -> None:
    """A fault has its stored proof as long as a cell of it has; a new one is proven, one without an answer asked."""
    asked, other = (_crashed("a", name) for name in ("ball", "free"))
    stored = [replace(other.cell, model=name) for name in ("helical", "planar")]
    known = faults([asked], stored, [_proof(stored[0])])
    assert [proof["models"] for proof in known.proven] == [("ball", "helical", "planar")]
    assert not known.open and not known.unasked
    new = faults([asked], stored, [])
    assert [(one.first, one.models) for one in new.open] == [(asked, ("ball", "helical", "planar"))]
    assert faults([], stored, []).unasked == {("a", "helical")}


def test_a_stored_fault_without_a_proof_is_asked_about_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    require("mujoco", "validation")
    cell = Cell("mujoco", "ball", "gravity", "wrong", 1.0)
    rows = [vars(cell)]
    part = {
        **dict.fromkeys(("corrected", "identities", "functions", "absent"), {}),
        "cells": parts.nested(rows, parts.CELLS),
        "asked": {"mujoco": {"ball": ["1"], "free": ["2"]}},
        "engines": [{"name": "mujoco"}],
        "proofs": [],
    }
    again = replace(_crashed("mujoco", "ball"), cell=replace(cell, verdict="right"))
    monkeypatch.setattr(renewal, "asker", lambda *_: lambda *_: [again])
    with Worker() as worker:
        reach = Opened({"mujoco": OWN["mujoco"]}, worker=worker)
        found = renewal.Found(reach, {"ball": tree_of("ball")}, [], [part])
        renewal._prove(Run(TOPIC, tmp_path), found, None)
        assert found.cells == [] and found.kept == [part]
        renewal._prove(Run(TOPIC, tmp_path), found, 0)
    assert found.cells == [again] and found.proofs == []
    assert [parts.places(one) for one in found.kept] == [[("mujoco", "free")]]


def test_a_report_counts_what_was_not_asked_of_engines_that_are_not_here() -> None:
    asked = {("mujoco", "ball"): "1", ("away", "ball"): "2", ("away", "free"): "3", ("kept", "ball"): "4"}
    part = {"asked": {"kept": {"ball": ["4"]}}, "engines": [], "functions": {}, "proofs": []}
    found = renewal.Found(Opened({"mujoco": OWN["mujoco"]}), {"ball": tree_of("ball")}, [], [part], asked)
    whole = renewal.report_of(found, {})
    assert whole["left"] == {"away": 2}
    assert parts.places(whole) == [("kept", "ball"), ("mujoco", "ball")]
