"""The words follow from the points: whoever wins is named, with the factor."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from validation.pareto import verdicts
from validation.pareto.problem import OURS, Point, Target
from validation.pareto.race import Result
from validation.pareto.report import PROBLEMS

PROBLEM = replace(PROBLEMS["spin_up"], targets=(Target("Exudyn", 1e-2, 200.0),))


def result(mine: float, theirs: float, best: float = 1e-3) -> Result:
    points = (
        Point(OURS, "3 modes", "rk4", "20 ms", 5e-3, mine),
        Point(OURS, "3 modes", "rk4", "200 ms", math.nan, mine, "lost"),
        Point("Exudyn", "4 elements", "alpha", "5 ms", 5e-3, theirs),
        Point("Exudyn", "8 elements", "alpha", "1 ms", best, 9.0),
    )
    return Result(points, 1e-5, "two", {"first order": 2e-3}, 1.0)


@pytest.mark.parametrize(
    ("mine", "theirs", "winner", "met"),
    [(1e-4, 1e-1, OURS, True), (1e-3, 1e-1, OURS, False), (1e-1, 1e-2, "Exudyn", False)],
)
def test_the_winner_is_named(mine: float, theirs: float, winner: str, met: bool) -> None:
    (verdict,) = verdicts.verdicts(PROBLEM, result(mine, theirs).points)
    assert verdict.winner == f"{winner} by {max(theirs / mine, mine / theirs):.3g}" and verdict.ok is met
    assert verdict.ratio == pytest.approx(theirs / mine)


def test_the_fastest_run_that_keeps_an_error_is_chosen_and_below_the_floor_an_engine() -> None:
    kept, finer = verdicts.choices(PROBLEM, result(1e-4, 1e-1))
    assert (kept.best.method, kept.best.setting, kept.best.seconds) == ("rk4", "20 ms", 1e-4)
    assert kept.rival == kept.other and kept.other is not None and kept.other.seconds == 1e-1
    assert finer.best.model == "8 elements" and finer.rival is None and finer.error == "< 0.2 % (floor)"
    assert len(verdicts.choices(PROBLEM, result(1e-4, 1e-1, best=3e-3))) == 1, "no run goes below the floor"


def test_a_quick_run_without_valid_points_is_not_a_miss() -> None:
    target = Target("MuJoCo", 1e-6, 2.0)
    nobody = verdicts.Verdict(target, math.inf, math.inf, math.nan, quick=True)
    assert nobody.ok is None
    assert verdicts.Verdict(target, math.inf, math.inf, math.nan).ok is False
    assert verdicts.Verdict(target, math.inf, 1.0, 0.0, quick=True).ok is False
