"""Damped least squares (Levenberg, Marquardt) on the error of a task, within limits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from symofros.base.arrays import Array
from symofros.runtime.constrained import LARGEST_STEP, pseudo_inverse
from symofros.runtime.model import Model
from symofros.simulation.analysis.kinematics.assembly import Indices
from symofros.simulation.analysis.kinematics.nearest_posture import coordinate_limits
from symofros.simulation.analysis.kinematics.targets import Task

# Damping, relative to the largest singular value: first value, factors after a good step and a bad one, and the
# value at which no step is left.
_DAMPING, _RELAX, _TIGHTEN, _MOST = 1e-3, 0.2, 8.0, 1e8
_SMALLEST_GAIN = 1e-16
# A start is given up where so many steps do not take a tenth of its error.
_STALLED, _MIN_SHARE = 20, 0.1


@dataclass(frozen=True)
class End:
    """Where the steps from a start end.

    Attributes:
        q: Configuration (nq).
        error: What is missing there.
        met: Whether all of it is within its bounds.
        steps: Steps taken.
    """

    q: Array
    error: Array
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
    model, limits, bounds = task.model, FreeLimits(task.model, free), task.bounds(tolerance)
    q = limits.within(start)
    error, damping, count = task.error(q), _DAMPING, 0
    square = judged = float(error @ error)
    while not _met(error, bounds) and count < iterations and np.isfinite(square):
        J = task.jacobian(q)
        if not np.all(np.isfinite(J)):
            break
        movable = limits.movable(q, J.T @ error)
        step = np.zeros(model.nv)
        step[movable] = _damped(J[:, movable], error, damping)
        step *= min(1.0, LARGEST_STEP / max(float(np.abs(step).max(initial=0.0)), 1e-300))
        tried = limits.within(model.integrate(q, step))
        error_tried = task.error(tried)
        count += 1
        before, gain = square, square - float(error_tried @ error_tried)
        if gain > 0.0:
            q, error, square, damping = tried, error_tried, square - gain, damping * _RELAX
        else:
            damping *= _TIGHTEN
        if damping > _MOST or 0.0 <= gain <= _SMALLEST_GAIN * before:
            break
        if count % _STALLED == 0:
            if square > (1.0 - _MIN_SHARE) ** 2 * judged:
                break
            judged = square
    return End(q, error, _met(error, bounds), count)


def polished(task: Task, q: Array, free: Indices) -> Array:
    """A solution after a step without damping, to rounding: objectives are compared to all digits."""
    error, J = task.error(q), task.jacobian(q)
    limits = FreeLimits(task.model, free)
    movable = limits.movable(q, J.T @ error)
    step = np.zeros(task.model.nv)
    step[movable] = pseudo_inverse(J[:, movable], task.measures.of_speeds(movable)) @ error
    tried = limits.within(task.model.integrate(q, step))
    return tried if np.linalg.norm(task.error(tried)) < np.linalg.norm(error) else q


def _met(error: Array, bounds: Array) -> bool:
    return bool((np.abs(error) <= bounds).all())


def _damped(J: Array, error: Array, damping: float) -> Array:
    """The step (n) of least |J step - error|^2 + (damping s_max |step|)^2."""
    U, s, Vt = np.linalg.svd(J, full_matrices=False)
    floor = damping * s.max(initial=0.0)
    return np.asarray(Vt.T @ (s / (s**2 + floor**2 + 1e-300) * (U.T @ error)))
