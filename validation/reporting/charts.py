"""Chart -> drawing: SVG without a library, so that a report stays small and follows dark mode."""

from __future__ import annotations

import math
from html import escape

import numpy as np

from validation.mechanics.geometry import Array
from validation.reporting.axes import Axis, grid, line, point, svg, text
from validation.reporting.figures import Chart, Curve, Drawing
from validation.reporting.numbers import short

WIDTH, HEIGHT = 620, 376
_LEFT, _RIGHT, _TOP, _BOTTOM = 70, 20, 12, 28
# Points of a polyline; more are not seen.
_MOST_POINTS = 600
# Styles of the lines of limits.
_LIMITS = 3


def draw(chart: Chart) -> Drawing:
    """The chart with its legend."""
    x, y = _axes(chart)
    parts = grid(x, y)
    parts += [_limit(chart, k, x, y) for k in range(len(chart.marks))]
    parts += [_curve(curve, chart, x, y) for curve in chart.curves]
    parts += [text(x.at(tag.x) - 5, y.at(tag.y) + 14, escape(tag.label), "end", "tag") for tag in chart.tags]
    legend = [(_sample(curve), curve.label) for curve in chart.curves]
    legend += [
        (line(f"limit l{k % _LIMITS}", 0, 24, 6, 6), f"{mark.label}: {short(float(format(mark.at, '.3g')))}")
        for k, mark in enumerate(chart.marks)
    ]
    return Drawing(chart.title, tuple(legend), svg(WIDTH, HEIGHT, chart.title, parts), chart.x, chart.y)


def _axes(chart: Chart) -> tuple[Axis, Axis]:
    seen = [_seen(curve, chart) for curve in chart.curves]
    x = _axis([points[0] for points in seen], chart, "x", _LEFT, WIDTH - _RIGHT)
    y = _axis([points[1] for points in seen], chart, "y", HEIGHT - _BOTTOM, _TOP)
    return _equal(x, y) if chart.equal else (x, y)


def _seen(curve: Curve, chart: Chart) -> tuple[Array, Array]:
    """The points that can be drawn; a gap is NaN in y."""
    x, y = np.asarray(curve.x, float), np.asarray(curve.y, float)
    y = np.where(np.isfinite(y), y, np.nan)
    if "y" in chart.log:
        y = np.where(y > 0.0, y, np.nan)
    if chart.range_y is not None:
        y = np.where((y >= chart.range_y[0]) & (y <= chart.range_y[1]), y, np.nan)
    return x, y


def _axis(values: list[Array], chart: Chart, name: str, start: float, end: float) -> Axis:
    log = name in chart.log
    drawn = np.concatenate([*values, [mark.at for mark in chart.marks if mark.axis == name]])
    drawn = drawn[np.isfinite(drawn)]
    low, high = (float(drawn.min()), float(drawn.max())) if len(drawn) else (1.0, 10.0)
    if name == "y" and chart.range_y is not None:
        low, high = chart.range_y
    if log:
        low, high = math.log10(low), math.log10(high)
    if name == "y" and chart.range_y is None:
        low, high = (math.floor(low), math.ceil(high)) if log else _widened(low, high)
    if high - low < 1e-12:
        low, high = low - 1.0, high + 1.0
    return Axis(low, high, start, end, log)


def _widened(low: float, high: float) -> tuple[float, float]:
    margin = 0.04 * (high - low)
    return low if low == 0.0 else low - margin, high + margin


def _equal(x: Axis, y: Axis) -> tuple[Axis, Axis]:
    """Both axes with as many pixels a unit: the one that has more shows more."""
    scales = [abs(axis.end - axis.start) / (axis.high - axis.low) for axis in (x, y)]
    widened = []
    for axis, scale in zip((x, y), scales, strict=True):
        margin = 0.5 * (scale / min(scales) - 1.0) * (axis.high - axis.low)
        widened.append(axis._replace(low=axis.low - margin, high=axis.high + margin))
    return widened[0], widened[1]


def _curve(curve: Curve, chart: Chart, x: Axis, y: Axis) -> str:
    xs, ys = _seen(curve, chart)
    if curve.kind not in ("points", "joined") and len(xs) > _MOST_POINTS:
        chosen = np.linspace(0, len(xs) - 1, _MOST_POINTS).astype(int)
        xs, ys = xs[chosen], ys[chosen]
    points = [None if math.isnan(b) else (x.at(a), y.at(b)) for a, b in zip(xs.tolist(), ys.tolist(), strict=True)]
    parts: list[str] = []
    if curve.kind != "points":
        runs: list[list[str]] = [[]]
        for p in points:
            if p is None:
                runs.append([])
            else:
                runs[-1].append(f"{p[0]:.1f},{p[1]:.1f}")
        style = f"plot {curve.kind} e{curve.color} s{curve.shape}"
        parts += [f'<polyline class="{style}" points="{" ".join(run)}"/>' for run in runs if run]
    if curve.kind in ("points", "joined"):
        size = 4.0 if curve.kind == "points" else 3.2
        hints = curve.hints or ("",) * len(points)
        parts += [point(f"e{curve.color}", *p, curve.shape, size, h) for p, h in zip(points, hints, strict=True) if p]
    return "".join(parts)


def _limit(chart: Chart, k: int, x: Axis, y: Axis) -> str:
    mark = chart.marks[k]
    kind = f"limit l{k % _LIMITS}"
    if mark.axis == "y":
        return line(kind, x.start, x.end, y.at(mark.at), y.at(mark.at))
    return line(kind, x.at(mark.at), x.at(mark.at), y.start, y.end)


def _sample(curve: Curve) -> str:
    """The curve in the legend, 24 by 12."""
    parts = []
    if curve.kind != "points":
        parts.append(line(f"plot {curve.kind} e{curve.color} s{curve.shape}", 0, 24, 6, 6))
    if curve.kind in ("points", "joined"):
        parts.append(point(f"e{curve.color}", 12, 6, curve.shape, 4.0))
    return "".join(parts)
