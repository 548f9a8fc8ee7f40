"""Where inverse kinematics begins, and begins again where the steps from the guess do not reach the targets.

Drawn starts are the same for the same model and guess. Those of one round lie farther and farther from the guess, the
last one anywhere within the limits.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from symofros.base.arrays import Array
from symofros.runtime.model import Model
from symofros.simulation.analysis.kinematics.nearest_posture import coordinate_limits
from symofros.simulation.analysis.kinematics.posture_solver import ROUND, PostureSolver

# Starts of one call of C, between looks at Ctrl-C.
_AT_ONCE = 16 * ROUND


def default_start(model: Model) -> Array:
    """The neutral configuration (nq), coordinates that it has beyond their limits in the middle of these."""
    q = np.array(model.neutral())
    for i, _, low, high in coordinate_limits(model):
        if not low <= q[i] <= high:
            q[i] = 0.5 * (low + high) if np.isfinite([low, high]).all() else min(max(q[i], low), high)
    return q


def start_again(
    solver: PostureSolver,
    guess: Array,
    near: Array,
    starts: int,
    steps: int,
    refused: Callable[[Array], bool] | None = None,
) -> bool:
    """Follow drawn starts until a round of them has solutions; the nearest one is where the solver ends.

    Args:
        solver: Search, with the speeds that may be used.
        guess: Configuration (carried.nq) within its limits, about which starts are drawn.
        near: Configuration (nq) that a solution is to be nearest to.
        starts: Most starts.
        steps: Most steps from each.
        refused: Whether a configuration (nq) that meets the task is no solution all the same.

    Returns:
        Whether there is a solution.
    """
    solver.reserve_starts(max(ROUND, starts))
    near = solver.joined(near)
    if not solver.windows(guess):
        return False
    if refused is None:
        return any(
            solver.again(guess, near, first, min(first + _AT_ONCE, starts), steps)
            for first in range(0, starts, _AT_ONCE)
        )
    for first in range(0, starts, ROUND):
        n = min(ROUND, starts - first)
        solver.follow_round(guess, first, n, steps)
        for i in range(n):
            if solver.round_met[i] and refused(solver.round[i, : solver.nq]):
                solver.round_met[i] = 0.0
        if solver.nearest(guess, near, n):
            return True
    return False
