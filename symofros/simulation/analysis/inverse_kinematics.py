"""Inverse kinematics: configurations, speeds and accelerations that put frames where they are wanted."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from symofros.errors import AssemblyError, Problem
from symofros.runtime.calls.kernel import Array
from symofros.runtime.constrained import RANK
from symofros.runtime.model import ArrayLike, Model
from symofros.simulation.analysis.assembly import Indices, free_speeds

# Damping of the least squares, relative to the largest singular value: first value, and factors after a good step and
# a bad one (Levenberg-Marquardt).
_DAMPING, _RELAX, _TIGHTEN = 1e-3, 0.2, 8.0
_LARGEST_STEP = 0.5
_SMALLEST_GAIN = 1e-16


@dataclass(frozen=True)
class Target:
    """Where a frame is wanted.

    Attributes:
        position: p_WF (3,) [m]; None if it does not matter.
        rotation: R_WF (3, 3); None if it does not matter.
    """

    position: ArrayLike | None = None
    rotation: ArrayLike | None = None


@dataclass(frozen=True)
class Reached:
    """The configuration nearest to what was wanted.

    Attributes:
        q: Configuration (nq), within its limits.
        error: Largest remaining error of position [m], rotation [rad] and constraints.
        converged: Whether it is below the tolerance; otherwise the target is out of reach from here.
        iterations: Steps taken.
    """

    q: Array
    error: float
    converged: bool
    iterations: int


def inverse_kinematics(
    model: Model,
    targets: Mapping[str, Target],
    q: ArrayLike | None = None,
    *,
    rest: ArrayLike | None = None,
    held: Collection[str] = (),
    u: ArrayLike | None = None,
    par: ArrayLike | None = None,
    tolerance: float = 1e-10,
    iterations: int = 200,
) -> Reached:
    """Damped least squares on the targets and, for mechanisms with loops, on their constraints.

    Args:
        model: Model, whose joint limits are kept.
        targets: Frame -> where it is wanted.
        q: Guess (nq); the neutral configuration if not given.
        rest: Configuration to stay near with the freedom that is left (nq).
        held: Names of speeds whose coordinates stay.
        u: Inputs, for prescribed motions.
        par: Run-time parameters.
        tolerance: Bound of the largest error.
        iterations: Most steps.

    Raises:
        UnknownNameError: No such frame or speed.
    """
    model = model.with_precision("double")
    q = model.neutral() if q is None else np.array(q, dtype=np.float64)
    free = free_speeds(model, held)
    task = _Task(model, targets, u, par)
    error, damping, count = task.error(q), _DAMPING, 0
    while np.abs(error).max(initial=0.0) > tolerance and count < iterations:
        J = task.jacobian(q)
        movable = _movable(model, q, J.T @ error, free)
        step = np.zeros(model.nv)
        step[movable] = _damped(J[:, movable], error, damping)
        if rest is not None:
            step[movable] += _towards(model, q, np.asarray(rest, dtype=np.float64), J, movable, error)
        step *= min(1.0, _LARGEST_STEP / max(float(np.abs(step).max(initial=0.0)), 1e-300))
        tried = _within(model, model.integrate(q, step))
        error_tried = task.error(tried)
        count += 1
        gain = float(error @ error - error_tried @ error_tried)
        if gain > 0.0 or rest is not None:
            q, error, damping = tried, error_tried, damping * _RELAX
        else:
            damping *= _TIGHTEN
        if damping > 1e8 or (0.0 <= gain <= _SMALLEST_GAIN * float(error @ error) and rest is None):
            break
    left = float(np.abs(error).max(initial=0.0))
    return Reached(q, left, left <= tolerance, count)


def joint_motion(
    model: Model,
    frame: str,
    positions: ArrayLike,
    velocities: ArrayLike,
    accelerations: ArrayLike,
    rotations: ArrayLike | None = None,
    *,
    q: ArrayLike | None = None,
    par: ArrayLike | None = None,
    tolerance: float = 1e-9,
) -> tuple[Array, Array, Array]:
    """A frame's motion -> q, v and v' at each of its samples.

    Args:
        model: A tree.
        frame: Frame whose motion is given.
        positions: p_WF (n, 3) [m].
        velocities: Linear, then angular velocity in world axes (n, 6); (n, 3) if rotations do not matter.
        accelerations: Their rates, likewise.
        rotations: R_WF (n, 3, 3); none if they do not matter.
        q: Guess for the first sample (nq); each next one starts from the last.
        par: Run-time parameters.
        tolerance: Tolerance of the largest error.

    Returns:
        q (n, nq), v (n, nv), v' (n, nv): of least norm where there is freedom.

    Raises:
        AssemblyError: A sample is out of reach; says which.
    """
    model = model.with_precision("double")
    p, V, A = (np.asarray(x, dtype=np.float64) for x in (positions, velocities, accelerations))
    R = None if rotations is None else np.asarray(rotations, dtype=np.float64)
    rows = 3 if R is None else 6
    motion: list[tuple[Array, Array, Array]] = []
    for i in range(len(p)):
        at = inverse_kinematics(
            model, {frame: Target(p[i], None if R is None else R[i])}, q, par=par, tolerance=tolerance
        )
        if not at.converged:
            raise AssemblyError(
                Problem(
                    f"model '{model.record.name}': frame '{frame}' can't follow",
                    f"an error of {at.error:.3g} at sample {i}",
                    "every sample is within reach",
                    "move the path, or start from another configuration",
                )
            )
        q = at.q
        J = model.frame_jacobian(frame, q, par=par)[:rows]
        inverse = np.linalg.pinv(J, rcond=RANK)
        v = inverse @ V[i]
        rate = model.frame_jacobian_rate(frame, q, v, par=par)[:rows]
        motion.append((q, v, inverse @ (A[i] - rate @ v)))
    qs, vs, accs = zip(*motion, strict=True)
    return np.array(qs), np.array(vs), np.array(accs)


class _Task:
    """Errors of targets and constraints, and how speeds change them."""

    def __init__(self, model: Model, targets: Mapping[str, Target], u: ArrayLike | None, par: ArrayLike | None) -> None:
        self.model, self.targets = model, targets
        self.more: dict[str, Any] = {"u": u, "par": par}
        self.coordinates = [i for i, n in enumerate(model.names.constraints) if n not in model.record.speed_conditions]

    def error(self, q: Array) -> Array:
        parts: list[Array] = []
        for frame, target in self.targets.items():
            p, R = self.model.frame_pose(frame, q, **self.more)
            if target.position is not None:
                parts.append(np.asarray(target.position, dtype=np.float64) - p)
            if target.rotation is not None:
                parts.append(rotation_vector(np.asarray(target.rotation, dtype=np.float64) @ R.T))
        if self.coordinates:
            parts.append(-self.model.constraint(q, **self.more)[self.coordinates])
        return np.concatenate(parts)

    def jacobian(self, q: Array) -> Array:
        parts: list[Array] = []
        for frame, target in self.targets.items():
            J = self.model.frame_jacobian(frame, q, **self.more)
            parts += [J[:3]] if target.position is not None else []
            parts += [J[3:]] if target.rotation is not None else []
        if self.coordinates:
            parts.append(self.model.constraint_jacobian(q, **self.more)[self.coordinates])
        return np.concatenate(parts)


def rotation_vector(R: Array) -> Array:
    """Axis times angle (3,) of a rotation (3, 3), the angle in [0, pi]."""
    twice = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    sine, cosine = 0.5 * float(np.linalg.norm(twice)), 0.5 * (float(np.trace(R)) - 1.0)
    angle = np.arctan2(sine, cosine)
    if sine > 1e-7:
        return np.asarray(twice * (0.5 * angle / sine))
    if cosine > 0.0:
        return 0.5 * twice
    # Half a turn: the axis is a column of R + 1.
    column = (R + np.eye(3))[:, int(np.argmax(np.diag(R)))]
    return np.asarray(angle * column / np.linalg.norm(column))


def _damped(J: Array, error: Array, damping: float) -> Array:
    U, s, Vt = np.linalg.svd(J, full_matrices=False)
    floor = damping * s.max(initial=0.0)
    return np.asarray(Vt.T @ (s / (s**2 + floor**2 + 1e-300) * (U.T @ error)))


def _towards(model: Model, q: Array, rest: Array, J: Array, movable: Indices, error: Array) -> Array:
    """A step towards the posture of rest that does not move the task; small once the task is done."""
    pull = 0.2 * model.difference(q, rest)[movable]
    J = J[:, movable]
    kept = pull - np.linalg.pinv(J, rcond=RANK) @ (J @ pull)
    # Fades out with the error, or the task would never be met to its last digits.
    return np.asarray(kept * min(1.0, 10.0 * float(np.abs(error).max(initial=0.0))))


def _limited(model: Model) -> list[tuple[int, int, float, float]]:
    """(index in q, index in v, lower, upper) of coordinates whose rates are the speeds."""
    limits = []
    for segment in model.record.segments:
        if segment.kind == "linear":
            for k in range(segment.size):
                i = segment.q + k
                limits.append((i, segment.v + k, model.record.q_lower[i], model.record.q_upper[i]))
    return limits


def _movable(model: Model, q: Array, wish: Array, free: Indices) -> Indices:
    """The free speeds without those that would push a coordinate through its limit."""
    stuck = {
        k for i, k, low, high in _limited(model) if (q[i] <= low and wish[k] < 0.0) or (q[i] >= high and wish[k] > 0.0)
    }
    return np.array([k for k in free if k not in stuck], dtype=np.intp)


def _within(model: Model, q: Array) -> Array:
    for i, _, low, high in _limited(model):
        q[i] = min(max(q[i], low), high)
    return q
