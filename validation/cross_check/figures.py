"""Figures of the cross-check: distributions of errors, and errors against the condition number."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from ..adapters import ROUTES, in_order
from ..comparison.errors import BIN_EDGES, HIGHEST_DECADE, LOWEST_DECADE
from ..contract.quantities import MOTION_ENERGY, QUANTITIES, SOLVE
from ..reporting.charts import BAD, SERIES, power
from ..reporting.figures import Chart, Curve, Drawing, Mark
from .record import NO_ENGINE, Distributions, Record, is_independent

TITLE = "Distribution of relative errors for each quantity and engine"
EPS = 2.0**-52


def engine_label(engine: str) -> str:
    """Name in legends: which opinions are our own is said."""
    return engine if is_independent(engine) else f"{engine} (our own)"


def _color(engine: str) -> str:
    """Color of an engine by its place among the engines; of others than those of ROUTES, of one more."""
    return SERIES[(list(ROUTES).index(engine) if engine in ROUTES else len(ROUTES)) % len(SERIES)]


def error_distributions(distributions: Distributions) -> tuple[Drawing, ...]:
    """How many states err by how much: a row a quantity, an outline an engine, a bar where the tolerance is.

    All models together. Exact agreement has a place of its own left of the axis.
    """
    rows = {q: distributions[q.name] for q in (*QUANTITIES.values(), MOTION_ENERGY) if distributions.get(q.name)}
    engines = in_order(name for group in rows.values() for name in group if name not in NO_ENGINE)
    if not rows:
        return ()

    def paint(axes: Any) -> None:
        for k, (quantity, group) in enumerate(rows.items()):
            for n, engine in enumerate(engines):
                if sum(group.get(engine, ())):
                    share = 2.0 * n / len(engines) + LOWEST_DECADE - 2.5
                    _outline(axes, group[engine], share, 1.8 / len(engines), -k, _color(engine))
            at = math.log10(quantity.tolerance)
            axes.plot([at, at], [-k, 0.85 - k], color=BAD, linewidth=2.2, label="" if k else "tolerance")
        for engine in engines:
            axes.plot([], [], "s", color=_color(engine), markersize=8, label=engine_label(engine))
        axes.set_yticks([-k for k in range(len(rows))], [quantity.name.replace("_", " ") for quantity in rows])
        ticks = range(LOWEST_DECADE + 2, HIGHEST_DECADE, 2)
        axes.set_xticks([LOWEST_DECADE - 1.5, *ticks], ["exact", *(power(10.0**decade) for decade in ticks)])
        axes.set_xlim(LOWEST_DECADE - 2.6, max(math.log10(quantity.tolerance) for quantity in rows) + 1.5)

    x = "relative error of a state  [1]; height: share of states  [1]"
    return (Drawing(TITLE, x, "", paint, size=(640.0, 34.0 * len(rows))),)


def _outline(axes: Any, counts: Sequence[int], left: float, width: float, base: float, color: str) -> None:
    """The share of states in each bin, the fullest as high as the row; the share that is exact as a bar at the left."""
    between = np.array(counts[1:-1])
    filled = np.flatnonzero(between)
    if len(filled):
        inside = slice(filled[0], filled[-1] + 1)
        edges = np.log10(BIN_EDGES)[filled[0] : filled[-1] + 2]
        heights = base + 0.75 * between[inside] / max(counts[1:])
        axes.stairs(heights, edges, baseline=base, fill=True, facecolor=(color, 0.12), edgecolor=color, linewidth=1.3)
    axes.bar(left, 0.75 * counts[0] / sum(counts), width, base, align="edge", color=color)


def error_against_condition(record: Record) -> tuple[Chart, ...]:
    """Forward dynamics: a point a model and engine, its largest error over the condition number of M."""
    rows = [
        row
        for row in record.compared
        if row.quantity == "forward_dynamics" and row.error and math.isfinite(row.extra.get("condition", math.inf))
    ]
    if not rows:
        return ()
    curves = []
    for k, engine in enumerate(in_order([*ROUTES, *record.engines])):
        own = [row for row in rows if row.engine == engine]
        x, y = [row.extra["condition"] for row in own], [row.error or 0.0 for row in own]
        curves += [Curve(engine_label(engine), x, y, k, "points")] if own else []
    span = np.array([1.0, max(row.extra["condition"] for row in rows)])
    curves.append(Curve("cond(M) · 2.2e-16", span, EPS * span, 4, "dashed"))
    chart = Chart(
        "forward dynamics: error against the condition number of the mass matrix",
        "largest condition number of M  [1]",
        "largest relative error  [1]",
        tuple(curves),
        (Mark("tolerance", SOLVE),),
        log="xy",
    )
    return (chart,)
