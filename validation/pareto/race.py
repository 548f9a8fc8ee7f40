"""Runs the contestants of a problem, each several times."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from ..reporting.plain import Number
from .problem import OURS, BenchmarkProblem, Contestant, Point, Prepared

# A run is repeated until it was done so often, or has taken so much time in all; always twice where it is short.
REPEATS, ENOUGH = 9, 0.4


@dataclass(frozen=True)
class Result:
    """A problem that was run.

    Attributes:
        points: Error and time of each contestant.
        agreement: Largest distance between the references.
        references: Origin of the references, in words.
        floors: Error that a beam model leaves at any step, by what it retains.
        seconds: Wall time of it all.
    """

    points: tuple[Point, ...]
    agreement: Number
    references: str
    floors: Mapping[str, float]
    seconds: float


def race(
    problem: BenchmarkProblem,
    quick: bool,
    begun: Callable[[int], None] = lambda _: None,
    done: Callable[[], None] = lambda: None,
) -> Result:
    """Prepare a problem and run it; `begun` hears how many contestants there are, `done` is called after each."""
    start = time.perf_counter()
    prepared: Prepared = problem.prepare(quick)
    begun(len(prepared.contestants))
    points = []
    for contestant in prepared.contestants:
        points.append(_run(contestant, 2 if quick else REPEATS, 0.1 if quick else ENOUGH))
        done()
    return Result(tuple(points), prepared.agreement, prepared.references, prepared.floors, time.perf_counter() - start)


def _run(one: Contestant, repeats: int, enough: float) -> Point:
    began = time.perf_counter()
    runs = [one.run()]
    while not runs[0].ended and len(runs) < repeats and time.perf_counter() - began < enough:
        runs.append(one.run())
    seconds = min(run.seconds for run in runs)
    error = runs[0].error
    ended = runs[0].ended
    if not ended and not math.isfinite(error):
        ended = "its numbers grew beyond all bounds"
    return Point(one.who, one.model, one.method, one.setting, math.nan if ended else error, seconds, ended)


def engines(points: tuple[Point, ...]) -> tuple[str, ...]:
    """Engines other than ours that have a point, in order of appearance."""
    return tuple(dict.fromkeys(p.who for p in points if p.who != OURS))
