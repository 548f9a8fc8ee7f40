"""What follows from the points, in words: who wins where, and which to use when."""

from __future__ import annotations

import math
from dataclasses import dataclass

from validation.pareto.front import charted, front, ratio, seconds_at, usable
from validation.pareto.problem import OURS, BenchmarkProblem, Point, Target
from validation.pareto.race import Result, engines
from validation.reporting.numbers import duration


@dataclass(frozen=True)
class Verdict:
    """A target and what was reached.

    Attributes:
        target: Ratio that is asked for, and at which error.
        seconds: Least time of our models that keeps the error [s]; infinity where none does.
        engine_seconds: Least time of the engine that keeps the error [s]; infinity where none does.
        ratio: The least seconds of the engine over ours.
    """

    target: Target
    seconds: float
    engine_seconds: float
    ratio: float

    @property
    def ok(self) -> bool:
        """Whether it is met; NaN is not."""
        return bool(self.ratio >= self.target.ratio)

    @property
    def winner(self) -> str:
        """Who is first at the error, and by which factor; "alone" where the other side does not keep it."""
        if math.isnan(self.ratio):
            return "nobody"
        who = OURS if self.ratio >= 1.0 else self.target.engine
        factor = self.ratio if self.ratio >= 1.0 or not self.ratio else 1.0 / self.ratio
        return f"{who} by {factor:.3g}" if 0.0 < self.ratio < math.inf else f"{who} alone"


def verdicts(problem: BenchmarkProblem, points: tuple[Point, ...]) -> list[Verdict]:
    """The verdict on each target."""
    judged = []
    for target in problem.targets:
        sides = [seconds_at((p for p in points if p.who == who), target.error) for who in (OURS, target.engine)]
        judged.append(Verdict(target, sides[0], sides[1], ratio(points, OURS, target.engine, target.error)))
    return judged


def below_the_floor(problem: BenchmarkProblem, result: Result) -> str:
    """Who serves those who want less than our model's own error."""
    if not result.floors:
        return ""
    least = min(result.floors.values())
    finer = [p for p in usable(result.points) if p.who != OURS and p.error < least]
    floors = ", ".join(f"{problem.shown(value)} ({name})" for name, value in result.floors.items())
    said = f"Our beam model leaves {floors}, whatever its functions and method (a step's error may hide some of it)"
    if not finer:
        return f"{said}; no run here goes below it."
    first = min(finer, key=lambda p: p.seconds)
    return (
        f"{said}; below {problem.shown(least)} {first.who} is the tool: {first.model}, {first.method}, "
        f"{first.setting} reach {problem.shown(first.error)} in {duration(first.seconds)}."
    )


def methods(problem: BenchmarkProblem, result: Result) -> str:
    """Which of our methods is first at the errors that matter."""
    mine = [p for p in usable(result.points) if p.who == OURS]
    if not mine:
        return "No run of ours came to its end."
    parts = []
    # References can't tell what is below their disagreement.
    least = max(min(p.error for p in mine), result.agreement)
    for error in sorted({target.error for target in problem.targets if target.error >= least} | {least}, reverse=True):
        by: dict[str, float] = {}
        for p in mine:
            by[p.method] = min(by.get(p.method, math.inf), seconds_at((o for o in mine if o.method == p.method), error))
        first, *rest = sorted((s, m) for m, s in by.items() if math.isfinite(s))
        second = f", then {rest[0][1]} ({duration(rest[0][0])})" if rest else ""
        parts.append(f"at {problem.shown(error)} {first[1]} ({duration(first[0])}){second}")
    return "Of our methods the fastest are " + "; ".join(parts) + "."


def overall(results: dict[str, tuple[BenchmarkProblem, Result]]) -> str:
    """What holds across problems: whose the front is, and our first method at the smallest error asked for."""
    firsts: dict[str, list[str]] = {}
    for problem, result in results.values():
        if not problem.targets:
            continue
        error = min(target.error for target in problem.targets)
        mine = [p for p in usable(result.points) if p.who == OURS]
        by = {p.method: seconds_at((o for o in mine if o.method == p.method), error) for p in mine}
        if by and math.isfinite(min(by.values())):
            firsts.setdefault(min(by, key=lambda m: by[m]), []).append(problem.title)
    said = [f"{method} on {', '.join(where)}" for method, where in firsts.items()]
    floors = [problem.title for problem, result in results.values() if result.floors]
    where = ", ".join(floors)
    beams = (
        f" Below the floors of our beams, on {where}, the tool is a nonlinear finite element: Exudyn." if where else ""
    )
    return f"At the smallest error asked for, the first of our methods is {'; '.join(said) or 'none'}.{beams}"


def see(problem: BenchmarkProblem, result: Result) -> str:
    """The sentence under a figure."""
    others = " and ".join(engines(result.points)) or "nobody else"
    best = front(charted(problem, result.points))
    mine, total = sum(p.who == OURS for p in best), len(best)
    return (
        f"Down is more accurate, left is faster. {mine} of the {total} runs on the green front are ours. Cold "
        f"colours are ours, warm ones those of {others}. Letters name the runs of the front in the table "
        "below. At the right, each method on the model with which it comes closest."
    )


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
