"""Maps: what is good, wrong and stopped, where the edge is, and the picture of it."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from validation.reporting.command import Run
from validation.reporting.findings import Finding
from validation.stability.closed_loops import baumgarte
from validation.stability.measure import measure
from validation.stability.report import TOPIC
from validation.stability.study import Cell, Limit, Map, Subject, cell


def a_map(values: list[list[float]], bound: float = 1.0, limits: tuple[Limit, ...] = ()) -> Map:
    cells = tuple(tuple(Cell(v) if math.isfinite(v) else Cell(v, "diverged", "why") for v in row) for row in values)
    x, y = 10.0 ** np.arange(len(values[0])), 10.0 ** np.arange(len(values))
    return Map(Subject("s", lambda x, y: Cell(0.0), limits), x, y, cells, bound)


class TestMaps:
    FOUND = a_map([[0.1, 0.1, 0.1], [0.1, 0.1, 5.0], [0.1, math.nan, 7.0]])

    def test_what_is_good_wrong_and_stopped(self) -> None:
        assert (int(self.FOUND.good.sum()), self.FOUND.wrong, self.FOUND.stopped) == (6, 2, 1)

    def test_edges(self) -> None:
        assert self.FOUND.edge("y") == [(10.0, 10.0, 100.0), (100.0, 1.0, 10.0)]
        assert self.FOUND.edge("x") == [(10.0, 10.0, 100.0), (100.0, 1.0, 10.0)]

    @pytest.mark.parametrize(("limit", "missed"), [(20.0, 2.0), (10.0, 1.0), (200.0, 20.0), (5.0, 2.0)])
    def test_how_far_a_closed_form_misses_the_edge(self, limit: float, missed: float) -> None:
        assert self.FOUND.miss("y", lambda x: limit) == pytest.approx(missed)

    def test_no_edge_misses_every_bound(self) -> None:
        assert not Finding("", a_map([[0.1, 0.1]]).miss("x", lambda y: 1.0), 100.0).ok

    def test_a_run_that_ends_without_a_number_is_refused(self) -> None:
        with pytest.raises(ArithmeticError, match="has no number"):
            Cell(math.nan)

    def test_a_run_that_stops_keeps_its_reason(self) -> None:
        run = baumgarte.swing("rk4", 1e-2, 1e4)
        found = cell(run, baumgarte.violation)
        assert found.ended == "diverged" and "fastest speed" in found.note and math.isnan(found.value)

    def test_a_run_that_ends_as_asked_keeps_its_notes_alone(self) -> None:
        run = baumgarte.swing("rk4", 1e-2, 20.0, 0.1)
        kept = cell(run, baumgarte.violation)
        assert kept.ended == "finished" and kept.note == "; ".join(run.outcome.notes)


def test_ctrl_c_within_a_run_ends_the_atlas(monkeypatch: pytest.MonkeyPatch) -> None:
    """The run itself makes an outcome of it, with the part before it kept."""

    def stopped(*given: Any, **settings: Any) -> sf.Trajectory:
        run = whole(*given, **settings)
        return replace(run, outcome=sf.Outcome("interrupted", 0.0, "Ctrl-C; the part up to here is kept"))

    whole = sf.simulate
    monkeypatch.setattr(sf, "simulate", stopped)
    assert measure(Run(TOPIC), ["energy", "redundant"], quick=True)["unfinished"] == ("energy", "redundant")
