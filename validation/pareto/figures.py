"""Points -> charts of error against time."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from string import ascii_lowercase

from validation.pareto.front import charted, front, usable
from validation.pareto.problem import OURS, BenchmarkProblem, Point
from validation.pareto.race import Result
from validation.reporting.figures import SHAPES, Chart, Curve, Figure, Kind, Mark, Tag

TIME = "time of the processor  [s]"
# Colours of ours, which are cold, and of the others, in the order in which they appear.
_OURS, _OTHERS = (0, 2, 6, 8, 10, 4), (1, 11, 7, 9, 3)
_FRONT = 5


def letters(count: int) -> list[str]:
    """a, b, ... z, a1, b1, ..."""
    return [ascii_lowercase[i % 26] + (str(i // 26) if i >= 26 else "") for i in range(count)]


def figure(problem: BenchmarkProblem, result: Result, caption: str) -> Figure:
    """Everything that ran, by model; and the methods on the model that matters."""
    points = charted(problem, result.points)
    return Figure(caption, (models_chart(problem, result), _methods_chart(problem, result, points)))


def models_chart(problem: BenchmarkProblem, result: Result) -> Chart:
    """Every run, a colour and shape a model, and the front with the letters of its runs."""
    points = charted(problem, result.points)
    best = front(points)
    stairs = [(b.seconds, a.error) for a, b in pairwise(best)] + [(p.seconds, p.error) for p in best]
    stairs.sort(key=lambda at: (at[0], -at[1]))
    line = Curve("front", [x for x, _ in stairs], [y for _, y in stairs], _FRONT)
    tags = tuple(Tag(name, p.seconds, p.error) for name, p in zip(letters(len(best)), best, strict=True))
    title = f"{problem.title}: every run, and the front"
    curves = (*_series(points, lambda p: p.model, "points"), line)
    return Chart(title, TIME, problem.axis, curves, _marks(result, points), log="xy", tags=tags)


def _methods_chart(problem: BenchmarkProblem, result: Result, points: list[Point]) -> Chart:
    curves = _series(_finest(points), lambda p: p.method, "joined")
    title = "methods: each on its best model"
    return Chart(title, TIME, problem.axis, curves, _marks(result, points), log="xy")


def _finest(points: list[Point]) -> list[Point]:
    """The series of each method of each side that reaches the smallest error."""
    best: dict[tuple[str, str], Point] = {}
    for point in points:
        key = point.who, point.method
        if key not in best or point.error < best[key].error:
            best[key] = point
    chosen = {point.series for point in best.values()}
    return [p for p in points if p.series in chosen]


def _series(points: list[Point], name: Callable[[Point], str], kind: Kind) -> tuple[Curve, ...]:
    """A curve a side and name; no two have both colour and shape alike."""
    groups: dict[tuple[bool, str], list[Point]] = {}
    for p in points:
        label = name(p) if p.who == OURS else f"{p.who}, {name(p)}"
        groups.setdefault((p.who != OURS, label), []).append(p)
    curves, count = [], {False: 0, True: 0}
    for (other, label), members in sorted(groups.items(), key=lambda item: item[0][0]):
        palette, n = _OTHERS if other else _OURS, count[other]
        count[other] += 1
        chosen = sorted(members, key=lambda p: p.seconds)
        x, y = [p.seconds for p in chosen], [p.error for p in chosen]
        color, shape = palette[n % len(palette)], n // len(palette) % SHAPES
        curves.append(Curve(label, x, y, color, kind, shape, tuple(p.name for p in chosen)))
    return tuple(curves)


def _marks(result: Result, points: list[Point]) -> tuple[Mark, ...]:
    """Floors of our beams, under the lowest who goes on; and what the references can tell."""
    least = min(result.floors.values(), default=0.0)
    below = dict.fromkeys(p.who for p in usable(result.points) if p.who != OURS and p.error < least)
    tool = f"; below it use {' or '.join(below)}" if below else ""
    marks = [
        Mark(f"floor of our beams, {name}{tool if value == least else ''}", value)
        for name, value in result.floors.items()
    ]
    apart = all(not 0.7 < value / result.agreement < 1.4 for value in result.floors.values() if result.agreement)
    if result.agreement and apart and min((p.error for p in points), default=1.0) < 10 * result.agreement:
        marks.append(Mark("the references agree to this", result.agreement))
    return tuple(marks)
