"""Maps: what is good, wrong and stopped, where the edge is, and the picture of it."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from validation.reporting.command import Run
from validation.stability.closed_loops import baumgarte
from validation.stability.report import TOPIC, measure
from validation.stability.study import Cell, Map, Subject, cell


def test_a_stability_map_counts_outcomes_and_finds_its_edge() -> None:
    values = ((0.1, 0.1, 0.1), (0.1, 0.1, 5.0), (0.1, math.nan, 7.0))
    cells = tuple(tuple(Cell(v) if math.isfinite(v) else Cell(v, "diverged", "why") for v in row) for row in values)
    decades = np.array([1.0, 10.0, 100.0])
    found = Map(Subject("s", lambda x, y: Cell(0.0)), decades, decades, cells, 1.0)
    assert (int(found.good.sum()), found.wrong, found.stopped) == (6, 2, 1)
    for limit, missed in ((20.0, 2.0), (10.0, 1.0), (200.0, 20.0), (5.0, 2.0)):
        assert found.miss("y", lambda x: limit) == pytest.approx(missed)  # noqa: B023


def test_a_run_that_stops_keeps_its_reason() -> None:
    found = cell(baumgarte.swing("rk4", 1e-2, 1e4), baumgarte.violation)
    assert found.ended == "diverged" and "fastest speed" in found.note and math.isnan(found.value)


def test_ctrl_c_within_a_run_ends_the_atlas(monkeypatch: pytest.MonkeyPatch) -> None:
    """The run itself makes an outcome of it, with the part before it kept."""

    def stopped(*given: Any, **settings: Any) -> sf.Trajectory:
        run = whole(*given, **settings)
        return replace(run, outcome=sf.Outcome("interrupted", 0.0, "Ctrl-C; the part up to here is kept"))

    whole = sf.simulate
    monkeypatch.setattr(sf, "simulate", stopped)
    assert measure(Run(TOPIC), ["energy", "redundant"], quick=True)["unfinished"] == ("energy", "redundant")
