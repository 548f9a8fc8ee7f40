"""Points -> work-precision figures: the front with its runs named beside it, and methods on their best models."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from ..reporting.charts import BAD, INK, LINE, SERIES, SOFT, logarithmic, style
from ..reporting.figures import Curve, Drawing, Figure
from .front import charted, front, seconds_at
from .problem import OURS, BenchmarkProblem, Point
from .race import Result

TIME = "time of the processor  [s]"
SIZE = (310.0, 330.0)
# Series of a figure: each has a colour and a mark that no other has.
MOST = 8
_COLORS = (0, 1, 5, 6, 11, 8, 9, 7)
# Decades above the largest target error, and factor beyond the slowest run of interest, that are shown.
_ABOVE, _BEYOND = 30.0, 4.0
# Share of the axes' height that a name in the margin takes.
_LINE = 0.047


def method(point: Point) -> str:
    """The series of a run: a method of ours, or an engine with whatever of its methods is best."""
    return point.method if point.who == OURS else point.who


def figure(problem: BenchmarkProblem, result: Result) -> Figure:
    """All runs with the front; and each method on the model with which it is fastest at the smallest target error."""
    points = charted(problem, result.points)
    best, methods = front(points), grouped(points, method)
    error = min((target.error for target in problem.targets), default=0.0)

    def rank(some: Sequence[Point]) -> tuple[float, float]:
        """The fastest at the smallest target error first; those that miss it by their least error."""
        return seconds_at(some, error), min(p.error for p in some)

    names = tuple(dict.fromkeys([*map(method, best), *sorted(methods, key=lambda name: rank(methods[name]))]))
    fronted = [name for name in names[:MOST] if any(method(p) == name for p in best)]
    floors = [(1.0, value, name, BAD) for name, value in result.floors.items()]

    def paint_front(axes: Any) -> None:
        _frame(axes, problem, points)
        for ours, mark in ((True, "o"), (False, "x")):
            beaten = [p for p in points if p not in best and (p.who == OURS) is ours]
            axes.plot(*_xy(beaten), mark, color=SOFT, alpha=0.3, markersize=4, markeredgewidth=1)
        corners = [(b.seconds, a.error) for a, b in pairwise(best)] + [(p.seconds, p.error) for p in best]
        axes.plot(*zip(*sorted(corners, key=lambda at: (at[0], -at[1])), strict=True), color=SOFT, linewidth=1)
        for k, name in enumerate(fronted):
            axes.plot(*_xy([p for p in best if method(p) == name]), **_style(name, k, "points"), zorder=3)
        colors = {name: SERIES[_COLORS[k]] for k, name in enumerate(fronted)}
        runs = [(p.seconds, p.error, f"{p.model}, {p.setting}", colors.get(method(p), LINE)) for p in best]
        _margin(axes, runs + [(x, y, f"floor of second-order beams, {name}", color) for x, y, name, color in floors])

    def paint_methods(axes: Any) -> None:
        _frame(axes, problem, points)
        for k, name in enumerate(names[:MOST]):
            series = min(grouped(methods[name], lambda p: p.series).values(), key=rank)
            axes.plot(*_xy(sorted(series, key=lambda p: p.seconds)), **_style(name, k, "joined"))
        _margin(axes, [(x, y, f"floor of second-order beams, {name}", color) for x, y, name, color in floors])

    hidden = f" Not drawn: {', '.join(names[MOST:])}; the table of methods has them." if names[MOST:] else ""
    caption = f"""Down is more accurate, left is faster. First: the front, which no run beats in both, and what its runs
    are, from the fastest to the most accurate; runs that are beaten are grey (crosses: other engines). Second: each
    method on its best model.{hidden}"""
    title = f"{problem.title}: the front and its runs"
    return Figure(
        caption,
        (
            Drawing(title, TIME, problem.axis, paint_front, size=SIZE),
            Drawing("methods, each on its best model", TIME, problem.axis, paint_methods, size=SIZE),
        ),
    )


def grouped(points: Sequence[Point], name: Callable[[Point], Any]) -> dict[Any, list[Point]]:
    """Points by a name."""
    return {key: [p for p in points if name(p) == key] for key in dict.fromkeys(map(name, points))}


def _style(name: str, k: int, kind: Any) -> dict[str, Any]:
    return style(Curve(name, (), (), _COLORS[k], kind, k - _COLORS[k]), 7.0 if kind == "points" else 6.0)


def _xy(points: Sequence[Point]) -> tuple[list[float], list[float]]:
    return [p.seconds for p in points], [p.error for p in points]


def _frame(axes: Any, problem: BenchmarkProblem, points: Sequence[Point]) -> None:
    """Logarithmic axes over what matters: from the front to somewhat beyond the target errors and their times."""
    best, targets = front(points), problem.targets
    top = _ABOVE * max((target.error for target in targets), default=1.0)
    slowest = [seconds_at((p for p in points if p.who == target.engine), target.error) for target in targets]
    right = max([best[-1].seconds, *filter(np.isfinite, slowest)]) * _BEYOND
    for name, low, high in (("x", best[0].seconds / 2, right), ("y", best[-1].error / 2, max(top, 2 * best[0].error))):
        getattr(axes, f"set_{name}scale")("log")
        getattr(axes, f"set_{name}lim")(low, high)
        logarithmic(getattr(axes, f"{name}axis"))


def _margin(axes: Any, rows: Sequence[tuple[float, float, str, str]]) -> None:
    """Names at the right of the axes, each joined to its point, none over another.

    Args:
        axes: The axes.
        rows: Abscissa, ordinate, name, colour of the line that joins them; a limit goes across, to its abscissa 1.
    """
    rows = sorted(rows, key=lambda row: -row[1])
    low, high = np.log10(axes.get_ylim())
    places = [(np.log10(row[1]) - low) / (high - low) for row in rows]
    for k in range(1, len(places)):
        places[k] = min(places[k], places[k - 1] - _LINE)
    places = [max(place, (len(places) - 1 - k) * _LINE) for k, place in enumerate(places)]
    for (x, y, name, color), place in zip(rows, places, strict=True):
        limit = color == BAD
        if limit:
            axes.axhline(y, color=BAD, linewidth=1.2, linestyle=(0, (6, 2)), zorder=1.5)
        coordinates = axes.get_yaxis_transform() if limit else "data"
        arrow = {"arrowstyle": "-", "color": color, "linewidth": 0.6, "shrinkA": 1, "relpos": (0, 0.5), "shrinkB": 2}
        text = {"color": BAD if limit else INK, "va": "center", "fontsize": 9.5}
        axes.annotate(name, (x, y), (1.03, place), coordinates, "axes fraction", arrow, **text)
