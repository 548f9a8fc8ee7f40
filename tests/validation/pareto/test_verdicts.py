"""The words follow from the points: whoever wins is named, with the factor."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from validation.pareto import verdicts
from validation.pareto.catalogue import PROBLEMS
from validation.pareto.figures import figure, letters
from validation.pareto.front import charted, front
from validation.pareto.problem import OURS, BenchmarkProblem, Point, Target
from validation.pareto.race import Result
from validation.reporting.charts import draw
from validation.reporting.figures import Chart
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


def test_below_the_floor_the_engine_is_the_tool() -> None:
    assert "below 0.2 % Exudyn is the tool: 8 elements" in verdicts.below_the_floor(PROBLEM, result(1e-4, 1e-1))
    assert "no run here goes below" in verdicts.below_the_floor(PROBLEM, result(1e-4, 1e-1, best=3e-3))


def test_runs_that_did_not_come_to_their_end_are_named() -> None:
    assert any("lost" in said for said in verdicts.refused(result(1e-4, 1e-1)))


def test_the_front_is_tagged_and_the_floor_drawn() -> None:
    found = result(1e-4, 1e-1)
    far_off = Point(OURS, "none", "euler", "1 s", 1e3, 1e-9)
    drawn = figure(PROBLEM, replace(found, points=(far_off, *found.points)), "see")
    every, methods = drawn.charts
    assert isinstance(every, Chart) and isinstance(methods, Chart)
    best = front(charted(PROBLEM, (far_off, *found.points)))
    assert [(t.label, t.y) for t in every.tags] == [(letters(k + 1)[k], p.error) for k, p in enumerate(best)]
    assert [tag.label for tag in every.tags] == letters(2) and every.log == "xy"
    legend = [name for _, name in draw(every).legend]
    assert "floor of our beams, first order; below it use Exudyn: 0.002" in legend and 'class="tag"' in draw(every).svg
    assert all("[s]" in chart.x and "[1]" in chart.y for chart in (every, methods))
    assert letters(28)[25:] == ["z", "a1", "b1"]


@pytest.mark.parametrize(
    ("seconds", "shown"), [(2.0, "2 s"), (3e-3, "3 ms"), (4.56e-5, "45.6 µs"), (math.inf, "no time")]
)
def test_durations(seconds: float, shown: str) -> None:
    assert duration(seconds) == shown


@pytest.mark.parametrize("problem", PROBLEMS.values(), ids=PROBLEMS)
def test_problems_say_what_they_compare(problem: BenchmarkProblem) -> None:
    assert problem.targets and problem.sources and problem.axis.endswith("]")
    assert all(target.error > problem.trust for target in problem.targets), "references must tell what is asked"
    assert {target.engine for target in problem.targets} <= {
        word for e in ("Exudyn", "MuJoCo") for word in [e] if e in problem.tuned
    }
