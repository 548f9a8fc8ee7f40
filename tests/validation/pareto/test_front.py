"""The front, times at an error, ratios: on points made up here, whose answers are known."""

from __future__ import annotations

import math
import random

import pytest

from validation.pareto.front import front, ratio, seconds_at, usable
from validation.pareto.problem import Point


def at(error: float, seconds: float, who: str = "one", method: str = "m", ended: str = "") -> Point:
    return Point(who, "model", method, "step", error, seconds, ended)


def test_every_point_off_the_front_is_dominated() -> None:
    draw = random.Random(2)
    points = [at(10 ** draw.uniform(-8, 0), 10 ** draw.uniform(-5, 0)) for _ in range(200)]
    best = front(points)
    assert 1 < len(best) < 40
    for a, b in zip(best, best[1:], strict=False):
        assert a.seconds < b.seconds and a.error > b.error
    for p in points:
        assert p in best or any(q.error <= p.error and q.seconds <= p.seconds for q in best)


@pytest.mark.parametrize(
    "point", [at(math.nan, 1.0), at(math.inf, 1.0), at(0.0, 1.0), at(1.0, math.nan), at(1e-9, 1e-9, ended="diverged")]
)
def test_points_without_a_number_are_not_on_the_front(point: Point) -> None:
    assert usable([point]) == [] and front([point, at(1.0, 1.0)]) == [at(1.0, 1.0)]


@pytest.mark.parametrize("order", [1, 2, 4])
def test_times_between_steps_follow_the_order(order: int) -> None:
    """Error h^p, time 1/h: the time of an error e is e^(-1/p)."""
    points = [at(h**order, 1.0 / h) for h in (0.5, 0.1, 0.02)]
    for h in (0.3, 0.1, 0.05):
        assert seconds_at(points, h**order) == pytest.approx(1.0 / h, rel=1e-12)


def test_nothing_is_interpolated_between_methods() -> None:
    points = [at(1e-1, 1.0, method="coarse"), at(1e-5, 100.0, method="fine")]
    assert seconds_at(points, 1e-3) == 100.0


def test_ratios_compare_fronts_at_equal_error() -> None:
    points = [at(1e-1, 1.0, "us"), at(1e-3, 10.0, "us"), at(1e-1, 50.0, "them"), at(1e-5, 5000.0, "them")]
    assert ratio(points, "us", "them", 1e-1) == pytest.approx(50.0)
    assert ratio(points, "us", "them", 1e-3) == pytest.approx(500.0 / 10.0)
    assert ratio(points, "us", "them", 1e-4) == 0.0, "we don't keep it: they win"
    assert ratio(points, "them", "us", 1e-4) == math.inf
    assert math.isnan(ratio(points, "us", "them", 1e-9))
