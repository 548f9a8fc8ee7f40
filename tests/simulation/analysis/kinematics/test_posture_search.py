"""Which of two postures that miss their targets is taken."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf
from symofros.simulation.analysis.kinematics.least_squares import FreeLimits
from symofros.simulation.analysis.kinematics.posture_search import Posture, PostureSearch
from tests.simulation.mechanisms import links


class _Gaps:
    """A task whose configuration is its errors: two of targets, one of a loop."""

    wishes = 2

    def error(self, q: np.ndarray) -> np.ndarray:
        return q

    def bounds(self, tolerance: float) -> np.ndarray:
        return np.full(3, tolerance)


@pytest.mark.parametrize("gap", [1e-6, 1e-3, 0.5])
def test_a_closed_loop_comes_before_targets_that_are_met(gap: float) -> None:
    task: Any = _Gaps()
    search = PostureSearch(task, np.zeros(3), None, np.arange(3), (), 1e-9, 10)
    closed, broken = (search._missed(Posture(np.array(q), False, 1)) for q in ([3.0, 4.0, 1e-12], [0.0, 0.0, gap]))
    assert closed == (0.0, 5.0) and broken == (gap, 0.0) and closed < broken
    turned = search._missed(Posture(np.zeros(3), False, 1, wrong_way_round=True))
    assert closed < turned, "a closure with its axes apart is none"


@pytest.mark.parametrize("wish", [-2.0, -1e-9, 0.0, 1e-9, 2.0])
def test_a_coordinate_at_its_limit_moves_away_from_it_alone(wish: float) -> None:
    """The second of two that are at their lower limits, and at their upper ones; the first is held."""
    limits = {i: sf.Limits(-1.0, 0.5) for i in range(3)}
    model = sf.compile(
        sf.System("arm", links((1.0,) * 3, limits=limits)), sf.Options(("mass_matrix",), backend="interpreter")
    )
    free = FreeLimits(model, np.array([1, 2]))
    low, high, within = np.array([-1.0, -1.0, 0.0]), np.array([0.5, 0.5, 0.0]), np.array([9.0, -0.9, 0.4])
    wishes = np.array([0.0, wish, wish])
    assert free.movable(low, wishes).tolist() == ([2] if wish < 0.0 else [1, 2])
    assert free.movable(high, wishes).tolist() == ([2] if wish > 0.0 else [1, 2])
    assert free.movable(within, wishes).tolist() == [1, 2]
    assert free.within(within + [0.0, -5.0, 5.0]).tolist() == [9.0, -1.0, 0.5]


def test_without_rest_a_solution_is_taken_as_it_is() -> None:
    """The first, after no further step."""
    task: Any = _Gaps()
    search = PostureSearch(task, np.zeros(3), None, np.arange(3), (), 1e-9, 10)
    found = search._nearest_to_rest([np.array([1.0, 2.0, 3.0]), np.zeros(3)])
    assert found.q.tolist() == [1.0, 2.0, 3.0] and found.solved and found.steps == 0
