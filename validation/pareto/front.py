"""Points of (error, seconds): the front that nobody beats, and the time that an error takes."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise

from .problem import BenchmarkProblem, Point


def usable(points: Iterable[Point]) -> list[Point]:
    """Points of complete runs, with an error and a time that logarithms take."""
    return [p for p in points if not p.ended and 0.0 < p.error < math.inf and 0.0 < p.seconds < math.inf]


def charted(problem: BenchmarkProblem, points: Iterable[Point]) -> list[Point]:
    """Points worth a chart: errors far beyond those asked for, or beyond all of a motion, are left out."""
    worst = max((target.error for target in problem.targets), default=math.inf)
    return [p for p in usable(points) if p.error <= max(1e2 * worst, 1e-2)]


def front(points: Iterable[Point]) -> list[Point]:
    """The points than which no other is both as fast and as accurate, from the fastest to the most accurate."""
    best: list[Point] = []
    for point in sorted(usable(points), key=lambda p: (p.seconds, p.error)):
        if not best or point.error < best[-1].error:
            best.append(point)
    return best


def seconds_at(points: Iterable[Point], error: float) -> float:
    """Least time that keeps an error.

    Within a series, whose step may take any value, between two neighbouring points of its own front by straight lines
    of logarithms; a series that is better throughout counts by its fastest point. Between series nothing is drawn:
    half of one model and half of another is no model.

    Returns:
        [s]; infinity where no point keeps it.
    """
    series: dict[tuple[str, str, str], list[Point]] = {}
    for point in usable(points):
        series.setdefault(point.series, []).append(point)
    return min((_within(front(members), error) for members in series.values()), default=math.inf)


def _within(best: Sequence[Point], error: float) -> float:
    if best[-1].error > error:
        return math.inf
    if best[0].error <= error:
        return best[0].seconds
    coarse, fine = next((a, b) for a, b in pairwise(best) if b.error <= error)
    share = math.log(coarse.error / error) / math.log(coarse.error / fine.error)
    return float(coarse.seconds * (fine.seconds / coarse.seconds) ** share)


def ratio(points: Sequence[Point], own: str, engine: str, error: float) -> float:
    """The least time of an engine over that of our own models at an error.

    Returns:
        Infinity where only we keep it, 0 where we don't, NaN where nobody does.
    """
    own_seconds = seconds_at((p for p in points if p.who == own), error)
    engine_seconds = seconds_at((p for p in points if p.who == engine), error)
    if math.isinf(own_seconds):
        return math.nan if math.isinf(engine_seconds) else 0.0
    return engine_seconds / own_seconds
