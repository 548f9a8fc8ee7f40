"""Chart -> SVG text: no library, colours from the page, so that a report stays small and follows dark mode."""

from __future__ import annotations

import math
from html import escape
from typing import NamedTuple

import numpy as np

from validation.evidence.findings import Chart, Curve, Mark

WIDTH, HEIGHT = 620, 400
_LEFT, _RIGHT, _TOP, _BOTTOM = 70, 14, 30, 50
_ROW = 17
# Points of a polyline; more are not seen.
_MOST = 600


class Axis(NamedTuple):
    """Values low ... high onto start ... end [px]; logarithms of values if `log`."""

    low: float
    high: float
    start: float
    end: float
    log: bool

    def at(self, value: float) -> float:
        """Where a value lies [px]."""
        value = math.log10(value) if self.log else value
        return self.start + (value - self.low) / (self.high - self.low) * (self.end - self.start)

    def ticks(self) -> list[float]:
        """Values with a line of the grid."""
        if self.log:
            step = max(1, math.ceil((self.high - self.low) / 7))
            decades = range(math.ceil(self.low - 1e-9), math.floor(self.high + 1e-9) + 1)
            found = [10.0**d for d in decades if d % step == 0]
            return found if len(found) > 1 else _few(10**self.low, 10**self.high)
        return _round(self.low, self.high)


def _round(low: float, high: float) -> list[float]:
    rough = (high - low) / 6
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(m * power for m in (1, 2, 5, 10) if m * power >= rough)
    return [k * step for k in range(math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9) + 1)]


def _few(low: float, high: float) -> list[float]:
    """For a logarithmic axis of less than two decades."""
    scale = 10.0 ** math.floor(math.log10(low))
    return [m * scale * p for p in (1, 10) for m in (1, 2, 5) if low * 0.999 <= m * scale * p <= high * 1.001]


def svg(chart: Chart) -> str:
    """The chart as an SVG element."""
    rows = _legend_rows(chart.curves)
    top = _TOP + _ROW * len(rows)
    x = _axis([_seen(curve, chart)[0] for curve in chart.curves], chart, "x", _LEFT, WIDTH - _RIGHT)
    y = _axis([_seen(curve, chart)[1] for curve in chart.curves], chart, "y", HEIGHT - _BOTTOM, top)
    if chart.equal:
        x, y = _alike(x, y)
    parts = [text((_LEFT + WIDTH - _RIGHT) / 2, 16, escape(chart.title), "middle", "row")]
    parts += [_legend(row, 16 + _ROW * (k + 1)) for k, row in enumerate(rows)]
    for value in x.ticks():
        parts.append(line("grid", x.at(value), x.at(value), y.start, y.end))
        parts.append(text(x.at(value), y.start + 17, shown(value, x.log), "middle", "tick"))
    for value in y.ticks():
        parts.append(line("grid", x.start, x.end, y.at(value), y.at(value)))
        parts.append(text(x.start - 7, y.at(value) + 4, shown(value, y.log), "end", "tick"))
    parts += [line("axis", x.start, x.end, y.start, y.start), line("axis", x.start, x.start, y.start, y.end)]
    parts += [_curve(curve, chart, x, y) for curve in chart.curves]
    parts += [_mark(mark, x, y) for mark in chart.marks]
    parts += [text(x.at(tag.x) - 5, y.at(tag.y) + 14, escape(tag.label), "end", "tag") for tag in chart.tags]
    parts.append(text((x.start + x.end) / 2, HEIGHT - 10, escape(chart.x), "middle", "name"))
    middle = (y.start + y.end) / 2
    turned = f'transform="rotate(-90 15 {middle:.0f})"'
    parts.append(f'<text class="name" x="15" y="{middle:.0f}" text-anchor="middle" {turned}>{escape(chart.y)}</text>')
    box = f'viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{escape(chart.title)}"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {box}>{"".join(parts)}</svg>'


def _seen(curve: Curve, chart: Chart) -> tuple[np.ndarray, np.ndarray]:
    """The points that can be drawn; a gap is NaN in y."""
    x, y = np.asarray(curve.x, float), np.asarray(curve.y, float)
    y = np.where(np.isfinite(y), y, np.nan)
    if chart.log_y:
        y = np.where(y > 0.0, y, np.nan)
    if chart.range_y is not None:
        y = np.where((y >= chart.range_y[0]) & (y <= chart.range_y[1]), y, np.nan)
    return x, y


def _axis(values: list[np.ndarray], chart: Chart, name: str, start: float, end: float) -> Axis:
    log = chart.log_x if name == "x" else chart.log_y
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


def _alike(x: Axis, y: Axis) -> tuple[Axis, Axis]:
    """Both axes with as many pixels a unit: the one that has more shows more."""
    scales = [abs(axis.end - axis.start) / (axis.high - axis.low) for axis in (x, y)]
    found = []
    for axis, scale in zip((x, y), scales, strict=True):
        room = 0.5 * (scale / min(scales) - 1.0) * (axis.high - axis.low)
        found.append(axis._replace(low=axis.low - room, high=axis.high + room))
    return found[0], found[1]


def _widened(low: float, high: float) -> tuple[float, float]:
    room = 0.04 * (high - low)
    return low if low == 0.0 else low - room, high + room


def _curve(curve: Curve, chart: Chart, x: Axis, y: Axis) -> str:
    xs, ys = _seen(curve, chart)
    if curve.kind not in ("points", "joined") and len(xs) > _MOST:
        chosen = np.linspace(0, len(xs) - 1, _MOST).astype(int)
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
        parts += [
            f'<polyline class="plot {curve.kind} e{curve.color}" points="{" ".join(run)}"/>' for run in runs if run
        ]
    if curve.kind in ("points", "joined"):
        radius = 4 if curve.kind == "points" else 3
        parts += [
            f'<circle class="point e{curve.color}" cx="{a:.1f}" cy="{b:.1f}" r="{radius}"/>'
            for a, b in filter(None, points)
        ]
    return "".join(parts)


def _mark(mark: Mark, x: Axis, y: Axis) -> str:
    label = escape(mark.label)
    if mark.axis == "y":
        at = y.at(mark.at)
        return line("limit", x.start, x.end, at, at) + text(x.end - 4, at - 5, label, "end", "limit-name")
    at = x.at(mark.at)
    turned = f'transform="rotate(-90 {at - 5:.1f} {y.end + 6:.1f})"'
    name = f'<text class="limit-name" x="{at - 5:.1f}" y="{y.end + 6:.1f}" text-anchor="end" {turned}>{label}</text>'
    return line("limit", at, at, y.start, y.end) + name


def _legend_rows(curves: tuple[Curve, ...]) -> list[list[tuple[float, Curve]]]:
    rows: list[list[tuple[float, Curve]]] = [[]]
    x = float(_LEFT)
    for curve in curves:
        width = 40 + 6.4 * len(curve.label)
        if rows[-1] and x + width > WIDTH:
            rows.append([])
            x = float(_LEFT)
        rows[-1].append((x, curve))
        x += width
    return rows


def _legend(row: list[tuple[float, Curve]], y: float) -> str:
    parts = []
    for x, curve in row:
        if curve.kind != "points":
            sample = f'<line class="plot {curve.kind} e{curve.color}" x1="{x:.0f}" x2="{x + 22:.0f}"'
            parts.append(f'{sample} y1="{y - 4:.0f}" y2="{y - 4:.0f}"/>')
        if curve.kind in ("points", "joined"):
            parts.append(f'<circle class="point e{curve.color}" cx="{x + 11:.0f}" cy="{y - 4:.0f}" r="3.5"/>')
        parts.append(text(x + 27, y, escape(curve.label), "start", "tick"))
    return "".join(parts)


def shown(value: float, log: bool) -> str:
    """A value of an axis: a power of ten where the axis is logarithmic and the value far from one."""
    if log and not 1e-2 <= value < 1e4:
        decade = f"{math.floor(math.log10(value) + 1e-9)}".replace("-", "−")
        return f'10<tspan dy="-5" font-size="9">{decade}</tspan>'
    return f"{0.0 if abs(value) < 1e-12 else value:.6g}".replace("-", "−")


def line(kind: str, x1: float, x2: float, y1: float, y2: float) -> str:
    """A straight line of a kind that the style sheet knows."""
    return f'<line class="{kind}" x1="{x1:.1f}" x2="{x2:.1f}" y1="{y1:.1f}" y2="{y2:.1f}"/>'


def text(x: float, y: float, text: str, anchor: str, kind: str) -> str:
    """A text that is escaped already; the only markup in it is our own (`shown`)."""
    return f'<text class="{kind}" x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{text}</text>'
