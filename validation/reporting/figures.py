"""Figures of a report, drawn as SVG text: they need no library, and take their colours from the page."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from html import escape
from typing import NamedTuple

from validation.adapters import ROUTES
from validation.comparison.errors import BIN_EDGES, BINS_PER_DECADE, HIGHEST_DECADE, LOWEST_DECADE, Comparison
from validation.contract.quantities import MOTION_ENERGY, QUANTITIES, SOLVE, Quantity
from validation.reporting.record import Record

WIDTH = 1000
_LEFT, _RIGHT, _TOP, _BOTTOM = 190, 16, 26, 44
_ROW = 44
EPS = 2.0**-52


class Scale(NamedTuple):
    """A logarithmic axis: decades low … high onto start … end [px]."""

    low: float
    high: float
    start: float
    end: float

    def at(self, decade: float) -> float:
        """Where a decade lies [px], kept inside the axis."""
        share = (min(max(decade, self.low), self.high) - self.low) / (self.high - self.low)
        return self.start + share * (self.end - self.start)

    def ticks(self, step: int) -> list[int]:
        """Whole decades on the axis that are multiples of `step`."""
        return [d for d in range(math.ceil(self.low), math.floor(self.high) + 1) if d % step == 0]


def error_distributions(record: Record) -> str:
    """How many states err by how much: a row a quantity, a curve an engine, a bar where the tolerance is.

    All models together. Exact agreement has a place of its own left of the axis.
    """
    rows = _rows_by_quantity(record)
    engines = [name for name in ROUTES if any(row.engine == name for group in rows.values() for row in group)]
    highest = max((_highest_decade(row) for group in rows.values() for row in group), default=-8)
    x = Scale(LOWEST_DECADE + 1, max(highest, -8), _LEFT + 46, WIDTH - _RIGHT)
    height = _TOP + _ROW * len(rows) + _BOTTOM
    parts = [_decade_grid(x, _TOP, height - _BOTTOM, 2)]
    for k, (quantity, group) in enumerate(rows.items()):
        base = _TOP + _ROW * (k + 1)
        parts.append(_label(_LEFT - 12, base - 10, quantity.name.replace("_", " "), "end", "row"))
        parts.append(f'<line class="axis" x1="{_LEFT}" x2="{WIDTH - _RIGHT}" y1="{base}" y2="{base}"/>')
        parts += [_curve(engine, group, x, base) for engine in engines]
        parts.append(_tolerance_mark(quantity, x, base))
    bottom = height - _BOTTOM
    parts.append(_label(_LEFT + 18, bottom + 17, "exact", "middle", "tick"))
    title = "relative error of a state; height: share of the states"
    parts.append(_label((x.start + x.end) / 2, bottom + 38, title, "middle", "name"))
    parts.append(_legend(engines, x.start, 14))
    return _svg(height, "Distribution of relative errors for each quantity and engine", parts)


def _rows_by_quantity(record: Record) -> dict[Quantity, list[Comparison]]:
    rows: dict[Quantity, list[Comparison]] = {}
    for quantity in [*QUANTITIES.values(), MOTION_ENERGY]:
        group = [row for row in record.compared if row.quantity == quantity.name and row.counts]
        if group:
            rows[quantity] = group
    return rows


def _highest_decade(row: Comparison) -> int:
    filled = max(k for k, count in enumerate(row.counts) if count)
    reached = LOWEST_DECADE + math.ceil(filled / BINS_PER_DECADE)
    return min(max(reached, math.ceil(math.log10(row.tolerance)) + 1), HIGHEST_DECADE)


def _curve(engine: str, group: Sequence[Comparison], x: Scale, base: float) -> str:
    """The share of states in each bin as a stepped outline, scaled so that the fullest bin fills the row."""
    counts = [sum(column) for column in zip(*(row.counts for row in group if row.engine == engine), strict=True)]
    total = sum(counts)
    if not total:
        return ""
    fullest = max(max(counts[1:]), 1)
    room = _ROW - 10
    filled = [k for k, count in enumerate(counts[1:-1]) if count] or [0]
    points = []
    for k in range(filled[0], filled[-1] + 1):
        y = base - room * counts[k + 1] / fullest
        points += [f"{x.at(math.log10(edge)):.1f},{y:.1f}" for edge in BIN_EDGES[k : k + 2]]
    points = [_foot(points[0], base), *points, _foot(points[-1], base)]
    exact = counts[0] / total
    index = list(ROUTES).index(engine)
    width = 36 / len(ROUTES)
    bar = (
        f'<rect class="bar e{index}" x="{_LEFT + index * width:.1f}" y="{base - room * exact:.1f}" width="{width:.1f}" '
        f'height="{room * exact:.1f}"><title>{escape(engine)}: {exact:.0%} exact</title></rect>'
    )
    title = f"<title>{escape(engine)}: {total} states</title>"
    return f'{bar}<polygon class="curve e{index}" points="{" ".join(points)}">{title}</polygon>'


def _foot(point: str, base: float) -> str:
    return f"{point.partition(',')[0]},{base}"


def _tolerance_mark(quantity: Quantity, x: Scale, base: float) -> str:
    at = x.at(math.log10(quantity.tolerance))
    return (
        f'<line class="limit" x1="{at:.1f}" x2="{at:.1f}" y1="{base}" y2="{base - _ROW + 4}">'
        f"<title>tolerance {quantity.tolerance:g}</title></line>"
    )


def error_against_condition(record: Record) -> str:
    """Forward dynamics: a point a model and engine, its largest error over the condition number of M."""
    rows = [
        row
        for row in record.compared
        if row.quantity == "forward_dynamics" and row.error and math.isfinite(row.extra.get("condition", math.inf))
    ]
    if not rows:
        return ""
    conditions = [math.log10(row.extra["condition"]) for row in rows]
    x = Scale(min(0.0, *conditions), max(math.ceil(max(conditions)), 1), _LEFT - 90, WIDTH - _RIGHT - 40)
    top, bottom = 30.0, 330.0
    y = Scale(-17, max(-8, math.ceil(max(math.log10(row.error) for row in rows if row.error))), bottom, top)
    parts = [_decade_grid(x, top, bottom, 1), *(_level(y, decade, x) for decade in y.ticks(2))]
    parts.append(_line("limit", x.start, x.end, y.at(math.log10(SOLVE)), y.at(math.log10(SOLVE))))
    parts.append(_label(x.end, y.at(math.log10(SOLVE)) - 6, f"tolerance {SOLVE:g}", "end", "limit-name"))
    parts.append(_rounding_guide(x, y))
    parts += [_point(row, x, y) for row in rows]
    parts.append(_label((x.start + x.end) / 2, bottom + 38, "largest condition number of M", "middle", "name"))
    middle = (top + bottom) / 2
    turned = f'transform="rotate(-90 34 {middle})"'
    parts.append(f'<text class="name" x="34" y="{middle}" text-anchor="middle" {turned}>largest relative error</text>')
    parts.append(_legend([name for name in ROUTES if any(row.engine == name for row in rows)], x.start, 14))
    return _svg(bottom + 48, "Error of forward dynamics against the condition number of the mass matrix", parts)


def _rounding_guide(x: Scale, y: Scale) -> str:
    """The line error = eps cond(M), as far as it lies in the picture, named a third of the way up."""
    eps = math.log10(EPS)
    last, third = min(x.high, y.high - eps), x.low + (x.high - x.low) / 3
    line = _line("guide", x.start, x.at(last), y.at(eps + x.low), y.at(eps + last))
    return line + _label(x.at(third) - 10, y.at(eps + third) - 10, "cond(M) · 2.2e-16", "end", "tick")


def _point(row: Comparison, x: Scale, y: Scale) -> str:
    assert row.error is not None
    at = f'cx="{x.at(math.log10(row.extra["condition"])):.1f}" cy="{y.at(math.log10(row.error)):.1f}"'
    title = f"<title>{escape(row.model)}, {escape(row.engine)}: {row.error:.1e}</title>"
    return f'<circle class="point e{list(ROUTES).index(row.engine)}" {at} r="5">{title}</circle>'


def _level(y: Scale, decade: int, x: Scale) -> str:
    at = y.at(decade)
    return _line("grid", x.start, x.end, at, at) + _label(x.start - 8, at + 4, _power(decade), "end", "tick")


def _decade_grid(x: Scale, top: float, bottom: float, step: int) -> str:
    lines = [
        _line("grid", x.at(d), x.at(d), top, bottom) + _label(x.at(d), bottom + 17, _power(d), "middle", "tick")
        for d in x.ticks(step)
    ]
    return "".join(lines)


def _legend(engines: Iterable[str], left: float, y: float) -> str:
    parts, x = [], left
    for engine in engines:
        color = f"e{list(ROUTES).index(engine)}"
        parts.append(f'<rect class="swatch {color}" x="{x:.0f}" y="{y - 9}" width="12" height="10"/>')
        parts.append(_label(x + 17, y, engine, "start", "tick"))
        x += 34 + 7.2 * len(engine)
    return "".join(parts)


def _power(decade: int) -> str:
    if -3 < decade < 3:
        return f"{10.0**decade:g}"
    return f'10<tspan dy="-5" font-size="9">{str(decade).replace("-", "−")}</tspan>'


def _line(kind: str, x1: float, x2: float, y1: float, y2: float) -> str:
    return f'<line class="{kind}" x1="{x1:.1f}" x2="{x2:.1f}" y1="{y1:.1f}" y2="{y2:.1f}"/>'


def _label(x: float, y: float, text: str, anchor: str, kind: str) -> str:
    """A text; the only markup in it is our own (`_power`)."""
    return f'<text class="{kind}" x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{text}</text>'


def _svg(height: float, title: str, parts: Iterable[str]) -> str:
    box = f'viewBox="0 0 {WIDTH} {height:.0f}" role="img" aria-label="{escape(title)}"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {box}>{"".join(parts)}</svg>'
