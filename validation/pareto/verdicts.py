"""What follows from the points: whether targets are met, and which run to take at which error."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from .front import ratio, seconds_at, usable
from .problem import OURS, BenchmarkProblem, Point, Target
from .race import Result


@dataclass(frozen=True)
class Verdict:
    """A target and what was reached.

    Attributes:
        target: Ratio that is asked for, and at which error.
        seconds: Least time of our models that keeps the error [s]; infinity where none does.
        engine_seconds: Least time of the engine that keeps the error [s]; infinity where none does.
        ratio: The least seconds of the engine over ours.
        quick: Whether few contestants ran: where none keeps the error, nothing was measured.
    """

    target: Target
    seconds: float
    engine_seconds: float
    ratio: float
    quick: bool = False

    @property
    def ok(self) -> bool | None:
        """Whether it is met; a NaN is not, but in a quick run, where it is no verdict."""
        return None if self.quick and math.isnan(self.ratio) else bool(self.ratio >= self.target.ratio)

    @property
    def winner(self) -> str:
        """The faster side and its factor; "alone" where the other does not keep the error, "nobody" where none does."""
        if math.isnan(self.ratio):
            return "nobody"
        who = OURS if self.ratio >= 1.0 else self.target.engine
        factor = self.ratio if self.ratio >= 1.0 or not self.ratio else 1.0 / self.ratio
        return f"{who} by {factor:.3g}" if 0.0 < self.ratio < math.inf else f"{who} alone"


def verdicts(problem: BenchmarkProblem, points: tuple[Point, ...], quick: bool = False) -> list[Verdict]:
    """The verdict on each target."""
    judged = []
    for target in problem.targets:
        sides = [seconds_at((p for p in points if p.who == who), target.error) for who in (OURS, target.engine)]
        judged.append(Verdict(target, sides[0], sides[1], ratio(points, OURS, target.engine, target.error), quick))
    return judged


@dataclass(frozen=True)
class Choice:
    """The fastest run that keeps an error, and those it leaves behind.

    Attributes:
        error: Error to keep, for people.
        best: The run.
        rival: Fastest run of another method; None where no other keeps the error.
        other: Fastest run of another side: an engine, or ours.
    """

    error: str
    best: Point
    rival: Point | None
    other: Point | None


def choices(problem: BenchmarkProblem, result: Result) -> list[Choice]:
    """The best choice at each target error, and below the floors of second order, which of ours only rods pass."""
    chosen = []
    for error in sorted({target.error for target in problem.targets}, reverse=True):
        chosen += _choice(problem.shown(error), (p for p in usable(result.points) if p.error <= error))
    if result.floors:
        least = min(result.floors.values())
        finer = (p for p in usable(result.points) if (p.who != OURS or p.model.startswith("rod")) and p.error < least)
        chosen += _choice(f"< {problem.shown(least)} (floor)", finer)
    return chosen


def _choice(error: str, points: Iterable[Point]) -> list[Choice]:
    runs = sorted(points, key=lambda p: p.seconds)
    if not runs:
        return []
    best = runs[0]
    rival = next((p for p in runs if (p.who, p.method) != (best.who, best.method)), None)
    return [Choice(error, best, rival, next((p for p in runs if p.who != best.who), None))]


def refused(result: Result) -> list[str]:
    """Runs that did not come to their end: whose, how many, and the first one's reason."""
    ended: dict[tuple[str, str], list[Point]] = {}
    for p in result.points:
        if p.ended:
            ended.setdefault((p.who, p.method), []).append(p)
    return [
        f"{who}, {method}: {len(runs)} ({runs[0].model}, {runs[0].setting}: {runs[0].ended})"
        for (who, method), runs in ended.items()
    ]
