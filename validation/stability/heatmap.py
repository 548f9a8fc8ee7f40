"""Map -> drawing: a cell a run, the edge between good and bad, and closed forms over it; colours from the page."""

from __future__ import annotations

import math
from html import escape

import numpy as np
import numpy.typing as npt

from validation.mechanics.geometry import Array
from validation.reporting.axes import Axis, line, shown, svg, text
from validation.reporting.figures import Drawing
from validation.stability.study import FINISHED, Grid, Limit, Map

WIDTH, HEIGHT = 620, 376
_RIGHT, _TOP, _BOTTOM = 14, 12, 28
# Width of a letter [px].
_LETTER = 7.5
# Decades below and above the bound at which colours are full.
_DEEP = {"good": 8.0, "bad": 4.0}
# Opacity from which on light letters are read more easily.
_DARK = 0.55
# Values of an axis that are all named.
_FEW = 14
# Decades are written so far apart [px] that they can be read.
_APART = (22.0, 12.5)
_NARROW = 13.0


def draw(mapped: Map, x: Grid, y: Grid, quantity: str) -> Drawing:
    """The map as a drawing with its legend.

    Args:
        mapped: Runs of one subject.
        x: The parameter along.
        y: The parameter across.
        quantity: Quantity of the criterion, with its unit.
    """
    longest = max(len(y.label(value)) for value in mapped.y) if y.labels else 0
    left = 20.0 + max(_LETTER * longest, 34.0)
    columns, across = _borders(mapped.x, x, left, WIDTH - _RIGHT)
    rows, down = _borders(mapped.y, y, HEIGHT - _BOTTOM, _TOP)
    parts = _cells(mapped, columns, rows)
    parts += _edge(mapped.good, columns, rows)
    parts += _named(mapped.x, x, across, columns, "x", rows[0])
    parts += _named(mapped.y, y, down, rows, "y", left)
    parts += [_limit(limit, across, down, k) for k, limit in enumerate(mapped.subject.limits)]
    picture = svg(WIDTH, HEIGHT, mapped.subject.name, parts, "map")
    return Drawing(mapped.subject.name, _legend(mapped), picture, x.name, y.name, f"numbers: decade of the {quantity}")


def _borders(values: Array, grid: Grid, start: float, end: float) -> tuple[list[float], Axis | None]:
    """Where cells meet [px], halfway between neighbours, and the axis; None for categories, which are evenly spaced."""
    n = len(values)
    if grid.labels or n == 1:
        return [start + (end - start) * k / n for k in range(n + 1)], None
    at = np.log10(values) if grid.log else values
    middle = (at[1:] + at[:-1]) / 2
    ends = np.array([2 * at[0] - middle[0], *middle, 2 * at[-1] - middle[-1]])
    axis = Axis(float(ends[0]), float(ends[-1]), start, end, grid.log)
    return [start + (end - start) * (e - ends[0]) / (ends[-1] - ends[0]) for e in ends], axis


def _stride(borders: list[float], apart: float) -> int:
    """Every how many cells a decade can be written."""
    return math.ceil(apart / float(np.median(np.abs(np.diff(borders)))) - 1e-9)


def _cells(mapped: Map, columns: list[float], rows: list[float]) -> list[str]:
    """The cells, those of one colour as one path, which keeps the page small; then what is written into them."""
    every_x, every_y = _stride(columns, _APART[0]), _stride(rows, _APART[1])
    areas: dict[str, list[str]] = {}
    written: dict[str, list[str]] = {"decade": [], "decade light": []}
    for j, line_of_cells in enumerate(mapped.cells):
        for i, one in enumerate(line_of_cells):
            left, top, width, height = columns[i], rows[j + 1], columns[i + 1] - columns[i], rows[j] - rows[j + 1]
            colour, sign, dark = _cell(one.value, one.ended, mapped.bound)
            areas.setdefault(colour, []).append(f"M{left:.1f} {top:.1f}h{width:.1f}v{height:.1f}h{-width:.1f}z")
            if i % every_x == 0 and j % every_y == 0 and width * every_x > _NARROW:
                place = f'x="{left + width / 2:.1f}" y="{top + height / 2 + 3.5:.1f}"'
                written["decade light" if dark else "decade"].append(f"<text {place}>{sign}</text>")
    filled = [f'<path {colour} d="{"".join(boxes)}"/>' for colour, boxes in areas.items()]
    return filled + [f'<g class="{kind}">{"".join(texts)}</g>' for kind, texts in written.items() if texts]


def _cell(value: float, ended: str, bound: float) -> tuple[str, str, bool]:
    """The colour, what is written into the cell, and whether that must be light."""
    if ended not in FINISHED:
        kind = "refused" if ended == "refused" else "ended"
        sign = "r" if ended == "refused" else "×"
        return f'class="{kind}"', sign, kind == "ended"
    over = math.log10(max(value, 1e-300) / bound)
    kind = "bad" if over > 0.0 else "good"
    depth = 0.12 + 0.78 * min(abs(over) / _DEEP[kind], 1.0)
    decade = f"{min(max(round(math.log10(max(value, 1e-300))), -99), 99)}".replace("-", "−")
    return f'class="{kind}-cell" fill-opacity="{depth:.2f}"', decade, depth > _DARK


def _edge(good: npt.NDArray[np.bool_], columns: list[float], rows: list[float]) -> list[str]:
    """Lines between cells that meet the criterion and cells that don't."""
    parts = []
    ny, nx = good.shape
    for j in range(ny):
        for i in range(nx):
            if i + 1 < nx and good[j, i] != good[j, i + 1]:
                parts.append(line("edge", columns[i + 1], columns[i + 1], rows[j], rows[j + 1]))
            if j + 1 < ny and good[j, i] != good[j + 1, i]:
                parts.append(line("edge", columns[i], columns[i + 1], rows[j + 1], rows[j + 1]))
    return parts


def _named(values: Array, grid: Grid, axis: Axis | None, borders: list[float], name: str, edge: float) -> list[str]:
    if axis is None:
        places = [(borders[k] + borders[k + 1]) / 2 for k in range(len(values))]
        pairs = [(place, escape(grid.label(value))) for place, value in zip(places, values, strict=True)]
    else:
        # A few round values are named themselves; many get the ticks of a chart.
        few = len(values) <= _FEW and all(value == 0.0 or 0.01 <= value < 1e4 for value in values)
        named = values.tolist() if few else axis.ticks()
        pairs = [(axis.at(value), f"{value:g}" if few else shown(value, axis.log)) for value in named]
    if name == "x":
        return [text(at, edge + 17, label, "middle", "tick") for at, label in pairs]
    return [text(edge - 7, at + 4, label, "end", "tick") for at, label in pairs]


def _limit(limit: Limit, across: Axis | None, down: Axis | None, k: int) -> str:
    """The part of a closed form that lies on the map; its name stands in the legend."""
    if across is None or down is None:
        return ""
    known = np.arange(len(limit.x))
    fine = np.linspace(0.0, len(known) - 1.0, 40 * len(known))
    # Straight between the points of the map, which are logarithms where an axis is logarithmic.
    px, py = (np.interp(fine, known, [axis.at(v) for v in of]) for axis, of in ((across, limit.x), (down, limit.y)))
    inside = (across.start <= px) & (px <= across.end) & (down.end <= py) & (py <= down.start)
    points = " ".join(f"{u:.1f},{w:.1f}" for u, w in zip(px[inside], py[inside], strict=True))
    return f'<polyline class="form f{k}" points="{points}"/>' if points else ""


def _legend(mapped: Map) -> tuple[tuple[str, str], ...]:
    """What colours, signs and lines mean."""
    ended = {c.ended for row in mapped.cells for c in row}
    items = [("good-cell", f"at most {mapped.bound:.3g}"), ("bad-cell", "more")]
    items += [("ended", "ended before (×)")] if ended - {*FINISHED, "refused"} else []
    items += [("refused", "refused (r)")] if "refused" in ended else []
    legend = [
        (f'<rect class="{kind}" fill-opacity="0.6" x="6" y="0" width="12" height="12"/>', label)
        for kind, label in items
    ]
    legend.append((line("edge", 0, 24, 6, 6), "edge as measured"))
    legend += [(line(f"form f{k}", 0, 24, 6, 6), limit.label) for k, limit in enumerate(mapped.subject.limits)]
    return tuple(legend)
