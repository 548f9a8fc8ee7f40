"""Charts place points by their values; what can not be drawn leaves a gap; nothing is cut."""

from __future__ import annotations

import re
import sys
import xml.etree.ElementTree

import numpy as np
import pytest

from validation.reporting import charts, html
from validation.reporting.figures import Chart, Curve, Mark

Y = np.array([1.0, 2.0, 3.0])


def line(svg: str) -> str:
    """The path of the only curve, in the colour of the first series; its sample in the legend is not clipped."""
    (path,) = re.findall(r'<path d="([^"]*)" clip-path="[^"]*" style="[^"]*var\(--e0\)', svg)
    return path


def points(svg: str) -> list[tuple[float, float]]:
    return [(float(x), float(y)) for x, y in re.findall(r"([\d.]+) ([\d.]+)", line(svg))]


def test_a_chart_places_points_by_their_values() -> None:
    x = np.array([1.0, 10.0, 100.0])
    svg = charts.draw(Chart("t", "x  [1]", "y  [1]", (Curve("c", x, x**2),), (Mark("limit", 1e2),), log="xy"))
    (x0, y0), (x1, y1), (x2, y2) = points(svg)
    assert x1 - x0 == pytest.approx(x2 - x1, abs=0.2) and y0 - y1 == pytest.approx(y1 - y2, abs=0.2)
    (mark,) = re.findall(r'<path d="M [\d.]+ ([\d.]+) [^"]*" clip-path="[^"]*" style="[^"]*var\(--bad\)', svg)
    assert float(mark) == pytest.approx(y1, abs=0.2) and "limit: 100" in svg


@pytest.mark.parametrize("gap", [np.nan, np.inf, -1.0])
def test_non_finite_points_leave_a_gap(gap: float) -> None:
    y = np.array([1.0, 2.0, gap, 2.0, 1.0])
    chart = Chart("t", "x", "y", (Curve("a < b", np.arange(5.0), y),), log="y")
    drawn, page = charts.draw(chart), html.chart(chart)
    assert line(drawn).count("M") == 2 and "nan" not in drawn and "a &lt; b" in page


def test_a_chart_is_valid_svg_with_its_labels() -> None:
    svg = charts.draw(Chart("t < u", "x  [m]", "y  [s]", (Curve("a", Y, 0.0125 * Y),), log="x"))
    root = xml.etree.ElementTree.fromstring(svg)
    assert root.get("role") == "img" and [root[k].text for k in (0, 1)] == ["t < u", "y  [s] against x  [m]. a."]
    assert "0.0125" in svg or "0.015" in svg, "numbers on axes keep their digits"
    identifiers = re.findall(' id="([^"]*)"', svg)
    assert len(set(identifiers)) == len(identifiers) and not re.search("#[0-9a-f]{6}", svg)


def test_without_matplotlib_the_page_names_it_in_place_of_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    page = html.chart(Chart("t", "x", "y", (Curve("a", Y, Y),)))
    assert "Not drawn: figures are drawn by Matplotlib, which is not installed: pip install" in page
