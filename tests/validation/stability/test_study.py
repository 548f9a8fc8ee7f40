"""Maps: what is good, wrong and stopped, where the edge is, and the picture of it."""

from __future__ import annotations

import math
import re
from collections import Counter
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import symofros as sf
from validation.reporting.charts import draw
from validation.reporting.command import Run
from validation.reporting.findings import Finding
from validation.stability import heatmap
from validation.stability.closed_loops import baumgarte
from validation.stability.measure import measure
from validation.stability.report import TOPIC
from validation.stability.study import Cell, Grid, Limit, Map, Subject, cell, decades


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

    def test_picture(self) -> None:
        grid = Grid("p [-]", (1.0, 10.0, 100.0), (1.0, 100.0))
        found = a_map(
            [[0.1, 0.1, 0.1], [0.1, 0.1, 5.0], [0.1, math.nan, 7.0]],
            limits=(Limit("one", np.array([1.0, 100.0]), lambda x: np.full_like(x, 10.0)),),
        )
        svg = draw(heatmap.draw(found, grid, grid, "a < b [m]"))
        kinds = [[heatmap.cell(one, found.bound)[0] for one in row] for row in found.cells]
        assert Counter(kind for row in kinds for kind in row) == {"good": 6, "bad": 2, "ended": 1}
        # The edge: below the two bad columns, left of the middle and of the right one.
        columns = rows = heatmap.borders(found.x, grid)
        assert len(heatmap.edge(found.good, columns, rows)) == 4 and columns == pytest.approx(10 ** np.arange(-0.5, 3))
        for name in ("numbers: decade of the a &lt; b [m]", "at most 1", "more", "ended before (×)", "one"):
            assert f">{name}</text>" in svg, name
        # The closed form at 10 runs through the middle row.
        ((start, end),) = re.findall(
            r'd="M [\d.]+ ([\d.]+) L [\d.]+ ([\d.]+) " clip-path="[^"]*" style="[^"]*--good', svg
        )
        (top, bottom) = re.findall(r'<path d="M [\d.]+ ([\d.]+) L [\d.]+ [\d.]+ L [\d.]+ ([\d.]+)', svg)[1]
        assert start == end and float(start) == pytest.approx((float(top) + float(bottom)) / 2, abs=0.2)


def test_decades() -> None:
    assert decades(0.1, 10.0, 1) == (0.1, 1.0, 10.0)


def test_ctrl_c_within_a_run_ends_the_atlas(monkeypatch: pytest.MonkeyPatch) -> None:
    """The run itself makes an outcome of it, with the part before it kept."""

    def stopped(*given: Any, **settings: Any) -> sf.Trajectory:
        run = whole(*given, **settings)
        return replace(run, outcome=sf.Outcome("interrupted", 0.0, "Ctrl-C; the part up to here is kept"))

    whole = sf.simulate
    monkeypatch.setattr(sf, "simulate", stopped)
    assert measure(Run(TOPIC), ["deflection", "redundant"], quick=True)["unfinished"] == ("deflection", "redundant")
