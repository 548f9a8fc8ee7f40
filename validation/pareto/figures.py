"""Points -> charts of error against time."""

from __future__ import annotations

import math
from string import ascii_lowercase

import numpy as np

from validation.findings import Chart, Curve, Figure, Mark, Tag
from validation.pareto.front import front, usable
from validation.pareto.race import Result
from validation.pareto.scene import OURS, Point, Scene

TIME = "time of the processor  [s]"
# Colours of ours and of the others, in the order in which models appear.
_OURS, _OTHERS = (0, 2, 6, 4), (1, 3, 7)
_FRONT = 5


def letters(count: int) -> list[str]:
    """a, b, ... z, a1, b1, ..."""
    return [ascii_lowercase[i % 26] + (str(i // 26) if i >= 26 else "") for i in range(count)]


def figure(scene: Scene, result: Result, words: str) -> Figure:
    """Everything that ran, by model; and the methods on the model that matters."""
    points = _shown(scene, result)
    title = "models: every run, and the front"
    return Figure(words, (_chart(scene, result, points, title, by_model=True),
                          _chart(scene, result, _finest(points), "methods: each on its best model", by_model=False)))  # fmt: skip


def _shown(scene: Scene, result: Result) -> list[Point]:
    """Points of use: an error of ten times the coarsest target, or of all of the motion, is none."""
    worst = max((target.error for target in scene.targets), default=math.inf)
    return [p for p in usable(result.points) if p.error <= max(1e2 * worst, 1e-2)]


def _finest(points: list[Point]) -> list[Point]:
    """Of each method of each side, the series that reaches the smallest error."""
    best: dict[tuple[str, str], Point] = {}
    for point in points:
        key = point.who, point.method
        if key not in best or point.error < best[key].error:
            best[key] = point
    chosen = {point.series for point in best.values()}
    return [p for p in points if p.series in chosen]


def _chart(scene: Scene, result: Result, points: list[Point], title: str, by_model: bool) -> Chart:
    groups: dict[str, list[Point]] = {}
    for point in points:
        label = f"{point.who}, {point.model}" if by_model else f"{point.who}, {point.method}"
        groups.setdefault(label, []).append(point)
    curves = [_curve(label, found, n, by_model) for n, (label, found) in enumerate(_ordered(groups))]
    marks = [Mark("floor of our beam model", result.floor)] if result.floor else []
    if result.agreement and min(p.error for p in points) < 10 * result.agreement:
        marks.append(Mark("the references agree to this", result.agreement))
    tags: tuple[Tag, ...] = ()
    if by_model:
        best = front(points)
        stairs = [(a.seconds, a.error) for a in best]
        curves.append(Curve("front", np.array([x for x, _ in stairs]), np.array([y for _, y in stairs]), _FRONT))
        tags = tuple(Tag(name, p.seconds, p.error) for name, p in zip(letters(len(best)), best, strict=True))
    return Chart(title, TIME, scene.measure, tuple(curves), tuple(marks), log_x=True, log_y=True, tags=tags)


def _ordered(groups: dict[str, list[Point]]) -> list[tuple[str, list[Point]]]:
    """Ours first."""
    return sorted(groups.items(), key=lambda item: not item[0].startswith(OURS))


def _curve(label: str, points: list[Point], n: int, by_model: bool) -> Curve:
    ours = points[0].who == OURS
    palette = _OURS if ours else _OTHERS
    chosen = sorted(points, key=lambda p: p.seconds)
    x, y = np.array([p.seconds for p in chosen]), np.array([p.error for p in chosen])
    short = label.removeprefix(f"{OURS}, ")
    return Curve(short, x, y, palette[n % len(palette)], "points" if by_model else "joined")
