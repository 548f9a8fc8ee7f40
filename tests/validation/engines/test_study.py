"""The whole matrix: half of the questions in a second process, with the cells of one."""

from __future__ import annotations

import os
from types import SimpleNamespace

import pytest

from tests.late import require
from validation.engines import study
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
