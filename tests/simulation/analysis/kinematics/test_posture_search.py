"""Which of two postures that miss their targets is taken."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from symofros.simulation.analysis.kinematics.posture_search import Posture, PostureSearch


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
