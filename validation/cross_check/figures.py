"""Figures of the cross-check: distributions of errors, and errors against the condition number."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape

import numpy as np

from validation.adapters import ROUTES
from validation.comparison.errors import BIN_EDGES, BINS_PER_DECADE, HIGHEST_DECADE, LOWEST_DECADE
from validation.contract.quantities import MOTION_ENERGY, QUANTITIES, SOLVE, Quantity
from validation.cross_check.record import Distributions, Record
from validation.reporting.axes import Axis, line, shown, svg, text
from validation.reporting.figures import SHAPES, Chart, Curve, Drawing, Mark

WIDTH = 760
_LEFT, _EXACT, _RIGHT, _TOP, _BOTTOM = 225, 46, 30, 8, 28
_ROW = 42
EPS = 2.0**-52


def engine_label(engine: str) -> str:
    """Name in legends: which opinions are our own is said."""
    return engine if ROUTES[engine].independent else f"{engine} (our own)"


def error_distributions(distributions: Distributions) -> Drawing | None:
    """How many states err by how much: a row a quantity, a curve an engine, a bar where the tolerance is.

    All models together. Exact agreement has a place of its own left of the axis.
    """
    rows = {q: distributions[q.name] for q in (*QUANTITIES.values(), MOTION_ENERGY) if distributions.get(q.name)}
    engines = [name for name in ROUTES if any(name in group for group in rows.values())]
    if not rows:
        return None
    highest = max(_highest_decade(quantity, counts) for quantity, group in rows.items() for counts in group.values())
    x = Axis(LOWEST_DECADE + 1, max(highest, -8), _LEFT + _EXACT, WIDTH - _RIGHT, log=True)
    bottom = _TOP + _ROW * len(rows)
    parts = []
    for decade in range(LOWEST_DECADE + 2, int(x.high) + 1, 2):
        at = x.at(10.0**decade)
        parts += [
            line("grid", at, at, _TOP, bottom),
            text(at, bottom + 17, shown(10.0**decade, True), "middle", "tick"),
        ]
    for k, (quantity, group) in enumerate(rows.items()):
        base = _TOP + _ROW * (k + 1)
        parts.append(text(_LEFT - 10, base - 10, quantity.name.replace("_", " "), "end", "row"))
        parts.append(line("axis", _LEFT, WIDTH - _RIGHT, base, base))
        parts += [_outline(engine, group[engine], x, base) for engine in engines if engine in group]
        at = x.at(quantity.tolerance)
        parts.append(line("bound", at, at, base, base - _ROW + 4))
    parts.append(text(_LEFT + _EXACT / 2 - 5, bottom + 17, "exact", "middle", "tick"))
    legend = [
        (f'<rect class="bar {_color(name)}" x="6" width="12" height="12"/>', engine_label(name)) for name in engines
    ]
    legend.append((line("bound", 12, 12, 0, 12), "tolerance"))
    title = "Distribution of relative errors for each quantity and engine"
    said = "relative error of a state [1]; height: share of states [1]"
    return Drawing(title, tuple(legend), svg(WIDTH, bottom + _BOTTOM, title, parts), said)


def _color(engine: str) -> str:
    return f"e{list(ROUTES).index(engine)}"


def _highest_decade(quantity: Quantity, counts: Sequence[int]) -> int:
    filled = max((k for k, count in enumerate(counts) if count), default=0)
    reached = LOWEST_DECADE + math.ceil(filled / BINS_PER_DECADE)
    return min(max(reached, math.ceil(math.log10(quantity.tolerance)) + 1), HIGHEST_DECADE)


def _outline(engine: str, counts: Sequence[int], x: Axis, base: float) -> str:
    """The share of states in each bin as a stepped outline, scaled so that the fullest bin fills the row."""
    total = sum(counts)
    if not total:
        return ""
    fullest = max(max(counts[1:]), 1)
    height = _ROW - 10
    filled = [k for k, count in enumerate(counts[1:-1]) if count] or [0]
    points = []
    for k in range(filled[0], filled[-1] + 1):
        y = base - height * counts[k + 1] / fullest
        points += [f"{max(x.at(edge), x.start):.1f},{y:.1f}" for edge in BIN_EDGES[k : k + 2]]
    feet = [f"{point.partition(',')[0]},{base}" for point in (points[0], points[-1])]
    exact = counts[0] / total
    width = (_EXACT - 10) / len(ROUTES)
    bar = (
        f'<rect class="bar {_color(engine)}" x="{_LEFT + list(ROUTES).index(engine) * width:.1f}" '
        f'y="{base - height * exact:.1f}" width="{width:.1f}" height="{height * exact:.1f}">'
        f"<title>{escape(engine)}: {exact:.0%} exact</title></rect>"
    )
    title = f"<title>{escape(engine)}: {total} states</title>"
    outline = " ".join((feet[0], *points, feet[1]))
    return f'{bar}<polygon class="area {_color(engine)}" points="{outline}">{title}</polygon>'


def error_against_condition(record: Record) -> Chart | None:
    """Forward dynamics: a point a model and engine, its largest error over the condition number of M."""
    rows = [
        row
        for row in record.compared
        if row.quantity == "forward_dynamics" and row.error and math.isfinite(row.extra.get("condition", math.inf))
    ]
    if not rows:
        return None
    curves = []
    for k, engine in enumerate(ROUTES):
        own = [row for row in rows if row.engine == engine]
        x, y = [row.extra["condition"] for row in own], [row.error or 0.0 for row in own]
        hints = tuple(f"{row.model}: {row.error:.1e}" for row in own)
        curves += [Curve(engine_label(engine), x, y, k, "points", k % SHAPES, hints)] if own else []
    span = np.array([1.0, max(row.extra["condition"] for row in rows)])
    curves.append(Curve("cond(M) · 2.2e-16", span, EPS * span, 4, "dashed"))
    return Chart(
        "forward dynamics: error against the condition number of the mass matrix",
        "largest condition number of M  [1]",
        "largest relative error  [1]",
        tuple(curves),
        (Mark("tolerance", SOLVE),),
        log="xy",
    )


def errors_by_engine(record: Record) -> Chart:
    """Share of comparisons that err by no more than so much, an engine a curve; exact agreement at 1e-17."""
    curves = []
    for k, (engine, route) in enumerate(ROUTES.items()):
        errors = [row.error for row in record.compared if row.engine == engine and row.error is not None]
        if errors and route.independent:
            share = np.arange(1, len(errors) + 1) / len(errors)
            curves.append(Curve(engine, np.maximum(np.sort(errors), 1e-17), share, k))
    return Chart(
        "how close independent engines are",
        "largest relative error of a comparison  [1]",
        "share of the comparisons  [1]",
        tuple(curves),
        log="x",
        range_y=(0.0, 1.0),
    )
