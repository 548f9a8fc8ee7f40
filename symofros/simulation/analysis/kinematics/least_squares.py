"""Damped least squares (Levenberg, Marquardt) on the error of a task, within limits: the steps are C's."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from symofros.base.arrays import Array
from symofros.runtime.constrained import pseudo_inverse
from symofros.runtime.model import Model
from symofros.simulation.analysis.kinematics.assembly import Indices
from symofros.simulation.analysis.kinematics.nearest_posture import coordinate_limits
from symofros.simulation.analysis.kinematics.targets import CLOSED_TO, Task


@dataclass(frozen=True)
class End:
    """Where the steps from a start end.

    Attributes:
        q: Configuration (nq).
        met: Whether what is missing there is within its bounds.
        steps: Steps taken.
    """

    q: Array
    met: bool
    steps: int


class FreeLimits:
    """Limits of the free coordinates of a model.

    Args:
        model: Model.
        free: Speeds that may be used.
    """

    def __init__(self, model: Model, free: Indices) -> None:
        movable = set(free.tolist())
        limits = [limit for limit in coordinate_limits(model) if limit[1] in movable and np.isfinite(limit[2:]).any()]
        self._free = free
        self._q = np.array([i for i, *_ in limits], dtype=np.intp)
        self._v = np.array([k for _, k, *_ in limits], dtype=np.intp)
        self._low = np.array([low for _, _, low, _ in limits])
        self._high = np.array([high for *_, high in limits])

    def within(self, q: Array) -> Array:
        """The configuration (nq) with its free coordinates moved to their limits where they are beyond them."""
        q = np.array(q)
        q[self._q] = np.minimum(np.maximum(q[self._q], self._low), self._high)
        return q

    def movable(self, q: Array, wish: Array) -> Indices:
        """The free speeds without those that would push a coordinate through its limit."""
        at, push = q[self._q], wish[self._v]
        stuck = self._v[((at <= self._low) & (push < 0.0)) | ((at >= self._high) & (push > 0.0))]
        return np.setdiff1d(self._free, stuck) if stuck.size else self._free


def damped_least_squares(task: Task, start: Array, free: Indices, tolerance: float, iterations: int) -> End:
    """Damped least-squares steps from a start until the error is within its bounds or no step reduces it.

    Args:
        task: Targets and constraints.
        start: Configuration (nq).
        free: Speeds that may be used.
        tolerance: Bound of the targets' largest error.
        iterations: Most steps.
    """
    solver = task.solver
    solver.use(free, tolerance, min(tolerance, CLOSED_TO))
    q = solver.descend(start, iterations)
    return End(q, bool(solver.posture.met), int(solver.posture.steps))


def polished(task: Task, q: Array, free: Indices) -> Array:
    """A solution after a step without damping, to rounding: objectives are compared to all digits."""
    error, J = task.error(q), task.jacobian(q)
    limits = FreeLimits(task.model, free)
    movable = limits.movable(q, J.T @ error)
    step = np.zeros(task.model.nv)
    step[movable] = pseudo_inverse(J[:, movable], task.measures.of_speeds(movable)) @ error
    tried = limits.within(task.model.integrate(q, step))
    return tried if np.linalg.norm(task.error(tried)) < np.linalg.norm(error) else q
