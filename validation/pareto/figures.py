"""Points -> charts of error against time."""

from __future__ import annotations

from itertools import pairwise
from string import ascii_lowercase

import numpy as np

from validation.evidence.findings import Chart, Curve, Figure, Mark, Tag
from validation.pareto.front import charted, front, usable
from validation.pareto.race import Result
from validation.pareto.scene import OURS, Point, Scene

TIME = "time of the processor  [s]"
# Colours of ours and of the others, in the order in which models appear.
_OURS, _OTHERS = (0, 2, 6, 8, 10, 4), (1, 11, 7, 9, 3)
_FRONT = 5


def letters(count: int) -> list[str]:
    """a, b, ... z, a1, b1, ..."""
    return [ascii_lowercase[i % 26] + (str(i // 26) if i >= 26 else "") for i in range(count)]


def figure(scene: Scene, result: Result, words: str) -> Figure:
    """Everything that ran, by model; and the methods on the model that matters."""
    points = charted(scene, result.points)
    every = _chart(scene, result, points, "models: every run, and the front", by_model=True)
    best = _chart(scene, result, _finest(points), "methods: each on its best model", by_model=False)
    return Figure(words, (every, best))


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
    groups = _by_model(points) if by_model else _by_method(points)
    sides = [[item for item in groups.items() if (item[1][0].who == OURS) == ours] for ours in (True, False)]
    curves = [
        _curve(label, found, palette[n % len(palette)], by_model)
        for side, palette in zip(sides, (_OURS, _OTHERS), strict=True)
        for n, (label, found) in enumerate(side)
    ]
    marks = _floors(result)
    apart = all(not 0.7 < value / result.agreement < 1.4 for value in result.floors.values() if result.agreement)
    if result.agreement and apart and min(p.error for p in points) < 10 * result.agreement:
        marks.append(Mark("the references agree to this", result.agreement))
    tags: tuple[Tag, ...] = ()
    if by_model:
        best = front(points)
        stairs = [(b.seconds, a.error) for a, b in pairwise(best)] + [(p.seconds, p.error) for p in best]
        stairs.sort(key=lambda at: (at[0], -at[1]))
        curves.append(Curve("front", np.array([x for x, _ in stairs]), np.array([y for _, y in stairs]), _FRONT))
        tags = tuple(Tag(name, p.seconds, p.error) for name, p in zip(letters(len(best)), best, strict=True))
    return Chart(title, TIME, scene.axis, tuple(curves), tuple(marks), log_x=True, log_y=True, tags=tags)


def _floors(result: Result) -> list[Mark]:
    """What our beams leave; under the lowest, who goes on."""
    least = min(result.floors.values(), default=0.0)
    below = dict.fromkeys(p.who for p in usable(result.points) if p.who != OURS and p.error < least)
    tool = f"; below it use {' or '.join(below)}" if below else ""
    return [
        Mark(f"floor of our beams, {name}{tool if value == least else ''}", value)
        for name, value in result.floors.items()
    ]


def _by_method(points: list[Point]) -> dict[str, list[Point]]:
    groups: dict[str, list[Point]] = {}
    for point in points:
        groups.setdefault(f"{point.who}, {point.method}", []).append(point)
    return groups


def _by_model(points: list[Point]) -> dict[str, list[Point]]:
    """By side and model; those for which there is no colour are together."""
    labels = dict.fromkeys((p.who, p.model) for p in points)
    sides = [[label for label in labels if (label[0] == OURS) == ours] for ours in (True, False)]
    named = {
        label
        for side, palette in zip(sides, (_OURS, _OTHERS), strict=True)
        for label in (side if len(side) <= len(palette) else side[: len(palette) - 1])
    }
    groups: dict[str, list[Point]] = {}
    for point in points:
        known = (point.who, point.model) in named
        groups.setdefault(f"{point.who}, {point.model if known else 'other models'}", []).append(point)
    return groups


def _curve(label: str, points: list[Point], color: int, by_model: bool) -> Curve:
    chosen = sorted(points, key=lambda p: p.seconds)
    x, y = np.array([p.seconds for p in chosen]), np.array([p.error for p in chosen])
    return Curve(label.removeprefix(f"{OURS}, "), x, y, color, "points" if by_model else "joined")
