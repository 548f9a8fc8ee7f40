"""The words follow from the points: whoever wins is named, with the factor."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import pytest

from validation.pareto import verdicts
from validation.pareto.catalogue import PROBLEMS
from validation.pareto.figures import MOST, figure
from validation.pareto.problem import OURS, BenchmarkProblem, Point, Target
from validation.pareto.race import Result
from validation.reporting.charts import draw
from validation.reporting.numbers import duration

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


def test_who_alone_keeps_an_error_wins() -> None:
    problem = replace(PROBLEM, targets=(Target("Exudyn", 1.5e-3, 1.0),))
    (verdict,) = verdicts.verdicts(problem, result(1e-4, 1e-1).points)
    assert verdict.winner == "Exudyn alone" and not verdict.ok


def test_the_fastest_run_that_keeps_an_error_is_chosen_and_below_the_floor_an_engine() -> None:
    kept, finer = verdicts.choices(PROBLEM, result(1e-4, 1e-1))
    assert (kept.best.method, kept.best.setting, kept.best.seconds) == ("rk4", "20 ms", 1e-4)
    assert kept.rival == kept.other and kept.other is not None and kept.other.seconds == 1e-1
    assert finer.best.model == "8 elements" and finer.rival is None and finer.error == "< 0.2 % (floor)"
    assert len(verdicts.choices(PROBLEM, result(1e-4, 1e-1, best=3e-3))) == 1, "no run goes below the floor"


def test_below_the_floor_of_second_order_rods_of_ours_count() -> None:
    found = result(1e-4, 1e-1)
    least = min(found.floors.values()) / 2.0
    rod = replace(found.points[0], who="symofros", model="rod of 4 strains", error=least, seconds=1e-3)
    _, finer = verdicts.choices(PROBLEM, replace(found, points=(*found.points, rod)))
    assert finer.best == rod and finer.other is not None and finer.other.who == "Exudyn"


def test_runs_that_did_not_come_to_their_end_are_named() -> None:
    assert any("lost" in said for said in verdicts.refused(result(1e-4, 1e-1)))


def test_the_front_is_named_beside_the_figure_and_what_is_far_off_does_not_stretch_it() -> None:
    found = result(1e-4, 1e-1)
    far_off = Point(OURS, "none", "euler", "1 s", 1e3, 1e-9)
    every, methods = (draw(one) for one in figure(PROBLEM, replace(found, points=(far_off, *found.points))).charts)
    for name in ("3 modes, 20 ms", "8 elements, 1 ms", "floor of second-order beams, first order", "Exudyn", "rk4"):
        assert f">{name}</text>" in every, name
    assert "4 elements, 5 ms" not in every and ">euler<" not in methods and ">10⁻⁷<" not in every


def test_at_most_eight_methods_are_drawn_and_the_others_are_named() -> None:
    points = tuple(Point(OURS, "1 mode", f"method{k}", "1 ms", 5e-3, 1e-3 * (k + 1)) for k in range(10))
    drawn = figure(PROBLEM, replace(result(1e-4, 1e-1), points=points))
    assert len(re.findall(">method[0-9]</text>", draw(drawn.charts[1]))) == MOST
    assert "Not drawn: method8, method9;" in drawn.caption


@pytest.mark.parametrize(("seconds", "shown"), [(2.0, "2 s"), (3e-3, "3 ms"), (4.56e-5, "45.6 µs"), (math.inf, "-")])
def test_durations(seconds: float, shown: str) -> None:
    assert duration(seconds) == shown


@pytest.mark.parametrize("problem", PROBLEMS.values(), ids=PROBLEMS)
def test_problems_say_what_they_compare(problem: BenchmarkProblem) -> None:
    assert problem.targets and problem.sources and problem.axis.endswith("]")
    assert all(target.error > problem.trust for target in problem.targets), "references must tell what is asked"
    assert {target.engine for target in problem.targets} <= {
        word for e in ("Exudyn", "MuJoCo") for word in [e] if e in problem.tuned
    }


def test_a_quick_run_in_which_nobody_keeps_the_error_is_no_miss() -> None:
    target = Target("MuJoCo", 1e-6, 2.0)
    nobody = verdicts.Verdict(target, math.inf, math.inf, math.nan, quick=True)
    assert nobody.ok is None
    assert verdicts.Verdict(target, math.inf, math.inf, math.nan).ok is False
    assert verdicts.Verdict(target, math.inf, 1.0, 0.0, quick=True).ok is False
