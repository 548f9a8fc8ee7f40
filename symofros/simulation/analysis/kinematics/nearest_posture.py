"""The best posture among those that meet a task (docs/theory/constraints.md, section 9).

Minimise f(q) with e(q) = 0 and lower <= q <= upper: f is d^2/2, d the distance in the chart about a posture of rest, or
half the square of what targets out of reach are missed by. The descent stays on the solutions: a step along the null
space of the task's Jacobian, then least squares back onto e = 0.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from symofros.base.arrays import Array
from symofros.base.rotations import screw_displacement
from symofros.runtime.constrained import LARGEST_STEP, null_space, pseudo_inverse
from symofros.runtime.model import Model
from symofros.simulation.analysis.kinematics.assembly import Indices
from symofros.simulation.analysis.kinematics.targets import Task

# Restores e = 0 near a configuration with some speeds, in so many steps at most: (q, whether it is met, steps).
Restore = Callable[[Array, Indices, int], tuple[Array, bool, int]]

# Norm of the projected gradient, relative to its size where nothing is best, that counts as zero: with half of a
# double's digits in the gradient, f is the least to all of them, as it changes with the square.
OPTIMALITY = 1e-8
# Least decrease of f, as a share of what the slope promises (Armijo), and halvings of a step.
_DECREASE, _HALVINGS = 1e-4, 25
# Relative change of f that is rounding.
_ROUNDING = 1e-14
# Step of central differences, whose error is of its square.
_DIFFERENCE = 1e-5
# Distance from a limit that counts as none: coordinates are led back onto the solutions to about that.
_AT_LIMIT = 1e-12
# Curvature of f along the solutions, in the objective's own unit, below which its size is not trusted; and what is
# negative.
_MIN_CURVATURE, _NEGATIVE = 1e-3, -1e-4


def coordinate_limits(model: Model) -> list[tuple[int, int, float, float]]:
    """(index in q, index in v, lower, upper) of coordinates whose rates are the speeds."""
    limits = []
    for segment in model.record.segments:
        if segment.kind == "linear":
            for k in range(segment.size):
                i = segment.q + k
                limits.append((i, segment.v + k, model.record.q_lower[i], model.record.q_upper[i]))
    return limits


def pull(model: Model, q: Array, rest: Array) -> Array:
    """Minus the gradient (nv) of d^2/2 by motions from q; its norm is the distance d.

    Straight differences of positions and rotation vectors: the gradient of half a rotation vector's square is the
    vector itself, in the axes of either end.
    """
    chart = model.difference(q, rest)
    for segment in model.record.segments:
        if segment.kind == "pose":
            linear, angular = slice(segment.v, segment.v + 3), slice(segment.v + 3, segment.v + 6)
            chart[linear] = screw_displacement(chart[angular], chart[linear])
    return chart


class Objective(Protocol):
    """The function f(q) >= 0 to be minimised.

    Attributes:
        curvature: Unit of its second derivatives by motions.
    """

    curvature: float

    def value(self, q: Array) -> float:
        """The objective f at a configuration (nq)."""

    def pull(self, q: Array) -> Array:
        """Minus its gradient (nv) by motions from q."""

    def flat(self, q: Array) -> float:
        """Norm of a gradient at q that counts as zero."""


class FromRest:
    """Half the square of the distance d from a posture of rest.

    Args:
        model: Model.
        rest: Posture of rest (nq).
    """

    # On a flat set of solutions.
    curvature = 1.0

    def __init__(self, model: Model, rest: Array) -> None:
        self._model, self._rest = model, rest

    def pull(self, q: Array) -> Array:
        """Minus the gradient (nv) of d^2/2 by motions from q; its norm is d."""
        return pull(self._model, q, self._rest)

    def distance(self, q: Array) -> float:
        """Norm of what separates q from rest."""
        return float(np.linalg.norm(self.pull(q)))

    def value(self, q: Array) -> float:
        """Half the square of the distance."""
        return 0.5 * self.distance(q) ** 2

    def flat(self, q: Array) -> float:
        """Norm of a gradient at q that counts as zero."""
        return OPTIMALITY * (1.0 + self.distance(q))


class FromTargets:
    """Half the squared norm of the targets' errors, metres and radians alike.

    Args:
        task: Targets; the rows of its constraints take no part.
        q: Configuration (nq) whose Jacobian gives the unit of curvature.
    """

    def __init__(self, task: Task, q: Array) -> None:
        self._task = task
        J = task.jacobian(q)[: task.wishes]
        self.curvature = float(np.sum(J * J, axis=0).max(initial=0.0)) or 1.0

    def value(self, q: Array) -> float:
        """Half the square of the error."""
        error = self._task.error(q)[: self._task.wishes]
        return 0.5 * float(error @ error)

    def pull(self, q: Array) -> Array:
        """J^T e (nv), as the gradient of half a rotation vector's square is the vector itself."""
        rows = self._task.wishes
        return np.asarray(self._task.jacobian(q)[:rows].T @ self._task.error(q)[:rows])

    def flat(self, q: Array) -> float:
        """A share of the gradient of targets that are missed by this much the straight way."""
        return OPTIMALITY * float(np.sqrt(2.0 * self.curvature * self.value(q)))


class NearestPosture:
    """Descent of an objective among the solutions of a task.

    Args:
        task: What is kept: targets and constraints, or constraints alone.
        objective: What is to be least.
        free: Speeds that may be used.
        restore: Least squares onto the task.
    """

    def __init__(self, task: Task, objective: Objective, free: Indices, restore: Restore) -> None:
        self.task, self.model, self.objective, self.free = task, task.model, objective, free
        self.restore = restore
        self.limits = [limit for limit in coordinate_limits(task.model) if limit[1] in set(free.tolist())]

    def descend(self, q: Array, iterations: int) -> tuple[Array, int]:
        """Descend from a solution to one where the objective is least nearby.

        Args:
            q: Solution of the task (nq), within its limits.
            iterations: Most steps.

        Returns:
            The configuration and the number of steps.
        """
        count = 0
        while count < iterations:
            steepest, blocked = self.projected_pull(q)
            small = float(np.linalg.norm(steepest)) <= self.objective.flat(q)
            moved = None
            for step, held in self._directions(q, steepest, blocked, small):
                moved, steps = self._line_search(q, step, steepest, held, iterations - count)
                count += steps
                if moved is not None:
                    break
            if moved is None:
                break
            q = moved
        return q, count

    def projected_pull(self, q: Array) -> tuple[Array, Indices]:
        """Steepest descent (nv) along motions that task and limits allow, and the speeds that limits block.

        It is zero where the conditions of Karush, Kuhn and Tucker hold: gradient = J^T lam + mu, mu pushing inwards.
        """
        Z = self._null_space(q, np.array([], dtype=np.intp))
        wish = Z.T @ self.objective.pull(q)
        active, inwards = self._active(q)
        # By Moreau, a vector is the sum of its projections on the cone of allowed motions and on the normal cone.
        mu = _nonnegative(-Z[active].T * inwards, wish)
        reduced = wish + (Z[active].T * inwards) @ mu
        return Z @ reduced, active[mu > 0.0]

    def _active(self, q: Array) -> tuple[Indices, Array]:
        """Speeds whose coordinates are at a limit, and the sign of motions that leave it."""
        at = [(k, 1.0) for i, k, low, _ in self.limits if q[i] <= low + _AT_LIMIT]
        at += [(k, -1.0) for i, k, _, high in self.limits if q[i] >= high - _AT_LIMIT]
        return np.array([k for k, _ in at], dtype=np.intp), np.array([sign for _, sign in at])

    def _null_space(self, q: Array, blocked: Indices) -> Array:
        """Orthonormal motions (nv, n) of the free speeds without the blocked that leave the task as it is."""
        kept = np.setdiff1d(self.free, blocked)
        J = self.task.jacobian(q)[:, kept]
        Z = np.zeros((self.model.nv, 0))
        if kept.size:
            motions = null_space(J, self.task.measures.of_speeds(kept))
            Z = np.zeros((self.model.nv, motions.shape[1]))
            Z[kept] = motions
        return Z

    def _directions(self, q: Array, steepest: Array, blocked: Indices, small: bool) -> list[tuple[Array, Indices]]:
        """Steps to try, best first, and the speeds that each leaves out: Newton's, down a saddle, the steepest."""
        fallback = [] if small else [(steepest, blocked[:0])]
        for _ in range(len(self.limits) + 1):
            Z = self._null_space(q, blocked)
            if not Z.shape[1]:
                return fallback
            curvature, V = np.linalg.eigh(self._curvature(q, Z))
            slope = V.T @ (Z.T @ self.objective.pull(q))
            newton = Z @ (V @ (slope / np.maximum(np.abs(curvature), _MIN_CURVATURE * self.objective.curvature)))
            pushed = self._pushed(q, newton)
            if not pushed.size:
                break
            blocked = np.union1d(blocked, pushed)
        else:
            return fallback
        if not small:
            return [(newton, blocked), *fallback]
        # A saddle or a maximum: either way along the negative curvature leads down.
        downhill = LARGEST_STEP * (Z @ V[:, 0])
        both = [(x, blocked) for x in (downhill, -downhill) if not self._pushed(q, x).size]
        return both if curvature[0] < _NEGATIVE * self.objective.curvature else []

    def _pushed(self, q: Array, step: Array) -> Indices:
        """Speeds at a limit that the step would push through it."""
        active, inwards = self._active(q)
        return active[step[active] * inwards < -1e-14 * float(np.abs(step).max(initial=0.0))]

    def _curvature(self, q: Array, Z: Array) -> Array:
        """Second derivative of f - lam e along the null space (n, n), by central differences of its gradient."""
        J = self.task.jacobian(q)
        inverse = pseudo_inverse(J[:, self.free], self.task.measures.of_speeds(self.free))
        lam = -inverse.T @ self.objective.pull(q)[self.free]

        def gradient(at: Array) -> Array:
            return -self.objective.pull(at) - self.task.jacobian(at).T @ lam

        columns = [
            gradient(self.model.integrate(q, _DIFFERENCE * z)) - gradient(self.model.integrate(q, -_DIFFERENCE * z))
            for z in Z.T
        ]
        H = Z.T @ np.array(columns).T / (2.0 * _DIFFERENCE)
        return np.asarray(0.5 * (H + H.T))

    def _line_search(
        self, q: Array, step: Array, steepest: Array, held: Indices, most: int
    ) -> tuple[Array | None, int]:
        """A solution along the step where the objective is less, or None; and the steps of least squares it took."""
        before, slope = self.objective.value(q), float(steepest @ step)
        step = step * min(1.0, LARGEST_STEP / max(float(np.abs(step).max()), 1e-300))
        count, movable = 0, np.setdiff1d(self.free, held)
        for _ in range(_HALVINGS):
            if count >= most:
                break
            tried, met, steps = self.restore(self._stopped(q, step), movable, most - count)
            count += 1 + steps
            gain = before - self.objective.value(tried)
            if met:
                if gain > max(_DECREASE * slope, _ROUNDING * before):
                    return tried, count
                # Where the gain drowns in rounding, the gradient still tells.
                if abs(gain) <= _ROUNDING * before and np.linalg.norm(self.projected_pull(tried)[0]) < 0.5 * float(
                    np.linalg.norm(steepest)
                ):
                    return tried, count
            step, slope = 0.5 * step, 0.5 * slope
        return None, count

    def _stopped(self, q: Array, step: Array) -> Array:
        """The configuration after a step, shortened to the first limit that it meets."""
        share = 1.0
        for i, k, low, high in self.limits:
            margin = (high if step[k] > 0.0 else low) - q[i]
            if abs(step[k]) * share > abs(margin):
                share = abs(margin) / abs(step[k])
        moved = self.model.integrate(q, share * step)
        for i, _, low, high in self.limits:
            moved[i] = min(max(moved[i], low), high)
        return moved


def _nonnegative(A: Array, b: Array) -> Array:
    """The x >= 0 of least |A x - b| (Lawson and Hanson 1974, algorithm NNLS)."""
    x = np.zeros(A.shape[1])
    passive = np.zeros(A.shape[1], dtype=bool)
    floor = 1e-14 * float(np.linalg.norm(b)) * max(float(np.abs(A).max(initial=0.0)), 1e-300)
    for _ in range(3 * A.shape[1]):
        slope = np.where(passive, -np.inf, A.T @ (b - A @ x))
        if slope.max(initial=-np.inf) <= floor:
            break
        passive[int(np.argmax(slope))] = True
        while True:
            s = np.zeros_like(x)
            s[passive] = np.linalg.lstsq(A[:, passive], b, rcond=None)[0]
            if s[passive].min(initial=np.inf) > 0.0:
                x = s
                break
            negative = passive & (s <= 0.0)
            share = float(np.min(x[negative] / np.maximum(x[negative] - s[negative], 1e-300)))
            x = x + share * (s - x)
            passive &= x > 1e-300
            x[~passive] = 0.0
            if not passive.any():
                break
    return x
