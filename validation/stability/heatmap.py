"""Map -> drawing: a cell a run, the edge between good and bad, and closed forms over it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..mechanics.geometry import Array
from ..reporting.charts import BAD, GOOD, INK, PAPER, SERIES, library, logarithmic
from ..reporting.figures import Drawing
from .study import FINISHED, Cell, Grid, Map

SIZE = (430.0, 280.0)
# Kind of a cell -> its colour.
COLORS = {"good": SERIES[0], "bad": SERIES[1], "ended": BAD, "refused": SERIES[4]}
# Decades below and above the bound at which colours are full, in so many levels.
_DEEP, _LEVELS = {"good": 8.0, "bad": 4.0}, 8
# Opacity from which on light letters are read more easily.
_DARK = 0.55
# Room of a number written into a cell [px].
_APART = (15.0, 10.0)
# Values of an axis that are all named.
_FEW = 14


def draw(mapped: Map, x: Grid, y: Grid, quantity: str) -> Drawing:
    """The map of a subject, x along and y across, with its legend; `quantity` is that of the criterion, with unit."""

    def paint(axes: Any) -> None:
        columns, rows = borders(mapped.x, x), borders(mapped.y, y)
        _scaled(axes, "x", mapped.x, x, columns)
        _scaled(axes, "y", mapped.y, y, rows)
        _cells(axes, mapped, columns, rows)
        lines = edge(mapped.good, columns, rows)
        axes.add_collection(library("matplotlib.collections").LineCollection(lines, colors=INK, linewidths=1.8))
        for k, limit in enumerate(mapped.subject.limits):
            dashed = {"color": (GOOD, SERIES[6])[k % 2], "linewidth": 2, "linestyle": (0, (5, 2.5))}
            axes.plot(limit.x, limit.form(limit.x), label=limit.label, **dashed)
        axes.plot([], [], color=INK, linewidth=1.8, label="edge as measured")

    return Drawing(mapped.subject.name, x.name, y.name, paint, f"numbers: decade of the {quantity}", SIZE)


def borders(values: Array, grid: Grid) -> Array:
    """Borders of the cells, halfway between neighbours on the axis as drawn; categories are a unit wide."""
    if grid.labels or len(values) == 1:
        return np.arange(-0.5, len(values))
    at = np.log10(values) if grid.log else values
    middle = (at[1:] + at[:-1]) / 2
    ends = np.array([2 * at[0] - middle[0], *middle, 2 * at[-1] - middle[-1]])
    return np.power(10.0, ends) if grid.log else ends


def _scaled(axes: Any, name: str, values: Array, grid: Grid, ends: Array) -> None:
    axis = getattr(axes, f"{name}axis")
    if grid.labels or len(values) == 1:
        axis.set_ticks(range(len(values)), [grid.label(value) for value in values])
    elif grid.log:
        getattr(axes, f"set_{name}scale")("log")
    getattr(axes, f"set_{name}lim")(ends[0], ends[-1])
    if grid.log and len(values) > 1 and not grid.labels:
        logarithmic(axis)
    if not grid.labels and len(values) <= _FEW and all(value == 0.0 or 0.01 <= value < 1e4 for value in values):
        axis.set_ticks(values, [f"{value:g}" for value in values])


def _cells(axes: Any, mapped: Map, columns: Array, rows: Array) -> None:
    """Draw the cells, those of one colour and depth as one path, their texts, and the legend's entries."""
    ends = zip(_APART, (columns, rows), SIZE, strict=True)
    strides = [math.ceil(apart * (len(values) - 1) / size) for apart, values, size in ends]
    middles = _middles(columns, axes.xaxis), _middles(rows, axes.yaxis)
    areas: dict[tuple[str, float], list[list[tuple[float, float]]]] = {}
    for j, i in np.ndindex(len(rows) - 1, len(columns) - 1):
        kind, depth, sign = cell(mapped.cells[j][i], mapped.bound)
        (left, right), (low, high) = columns[i : i + 2], rows[j : j + 2]
        areas.setdefault((kind, depth), []).append([(left, low), (right, low), (right, high), (left, high)])
        if i % strides[0] == 0 and j % strides[1] == 0:
            ink = {"color": PAPER if depth > _DARK else INK, "fontsize": 7, "in_layout": False}
            axes.text(middles[0][i], middles[1][j], sign, ha="center", va="center", **ink)
    for (kind, depth), boxes in areas.items():
        path = library("matplotlib.path").Path.make_compound_path_from_polys(np.array(boxes))
        filled = {"facecolor": COLORS[kind], "alpha": depth, "edgecolor": PAPER, "linewidth": 0.3}
        axes.add_patch(library("matplotlib.patches").PathPatch(path, **filled))
    named = {
        "good": f"at most {mapped.bound:.3g}",
        "bad": "more",
        "ended": "ended before (×)",
        "refused": "refused (r)",
    }
    for kind in (kind for kind in named if kind in {"good", "bad", *(kind for kind, _ in areas)}):
        axes.plot([], [], "s", color=COLORS[kind], alpha=0.7, markersize=8, label=named[kind])


def _middles(ends: Array, axis: Any) -> Array:
    """The middles of cells as drawn."""
    low, high = ends[:-1], ends[1:]
    return np.sqrt(low * high) if axis.get_scale() == "log" else (low + high) / 2


def cell(one: Cell, bound: float) -> tuple[str, float, str]:
    """Kind of a run, depth of its colour, and text of its cell."""
    if one.ended not in FINISHED:
        return ("refused", 0.5, "r") if one.ended == "refused" else ("ended", 0.85, "×")
    decades = math.log10(max(one.value, 1e-300))
    over = decades - math.log10(bound)
    kind = "bad" if over > 0.0 else "good"
    depth = 0.12 + 0.78 * round(min(abs(over) / _DEEP[kind], 1.0) * _LEVELS) / _LEVELS
    text = f"{min(max(round(decades), -99), 99)}" if one.value else "-∞"
    return kind, depth, text.replace("-", "−")


def edge(good: Any, columns: Array, rows: Array) -> list[list[tuple[float, float]]]:
    """Lines between cells that meet the criterion and cells that don't."""
    upright = np.argwhere(good[:, 1:] != good[:, :-1])
    level = np.argwhere(good[1:] != good[:-1])
    return [
        *([(columns[i + 1], rows[j]), (columns[i + 1], rows[j + 1])] for j, i in upright),
        *([(columns[i], rows[j + 1]), (columns[i + 1], rows[j + 1])] for j, i in level),
    ]
