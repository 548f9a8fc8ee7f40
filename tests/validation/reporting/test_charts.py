"""Charts place points by their values; what can not be drawn leaves a gap."""

from __future__ import annotations

import re

import numpy as np
import pytest

from validation.reporting import charts, html
from validation.reporting.figures import Chart, Curve, Mark


def points(svg: str) -> list[tuple[float, float]]:
    (text,) = re.findall(r'points="([^"]*)"', svg)
    return [(float(x), float(y)) for x, y in (pair.split(",") for pair in text.split())]


def test_a_chart_places_points_by_their_values() -> None:
    x = np.array([1.0, 10.0, 100.0])
    chart = Chart("t", "x  [1]", "y  [1]", (Curve("c", x, x**2),), (Mark("limit", 1e2),), log="xy")
    (x0, y0), (x1, y1), (x2, y2) = points(charts.draw(chart).svg)
    assert x1 - x0 == pytest.approx(x2 - x1, abs=0.2) and y0 - y1 == pytest.approx(y1 - y2, abs=0.2)
    (mark,) = re.findall(r'class="limit l0"[^>]*y1="([\d.]+)"', charts.draw(chart).svg)
    assert float(mark) == pytest.approx(y1, abs=0.2)


@pytest.mark.parametrize("gap", [np.nan, np.inf, -1.0])
def test_what_can_not_be_drawn_leaves_a_gap(gap: float) -> None:
    y = np.array([1.0, 2.0, gap, 2.0, 1.0])
    chart = Chart("t", "x", "y", (Curve("a < b", np.arange(5.0), y),), log="y")
    drawn, page = charts.draw(chart).svg, html.chart(chart)
    assert drawn.count("<polyline") == 2 and "nan" not in drawn and "a &lt; b" in page


def test_a_range_cuts_curves() -> None:
    x = np.linspace(0.0, 10.0, 11)
    shown = points(charts.draw(Chart("t", "x", "y", (Curve("c", x, x),), range_y=(0.0, 5.0))).svg)
    assert len(shown) == 6
