"""Truth of a point of each link that is not its origin: motions along the world's axes, and their derivatives."""

from __future__ import annotations

import numpy as np

from .arithmetic import Exact, exact, skew
from .dynamics import Point, Truth

POINT = (0.25, -0.5, 0.125)


def jacobians_at(truth: Truth, q: Exact) -> Exact:
    """Jacobians of the points (L, 3, nv)."""
    own, poses = truth.kinematics.jacobians(q), truth.kinematics.poses(q)
    return np.array([J[:3] - skew(R @ exact(POINT)) @ J[3:] for J, (R, _) in zip(own, poses, strict=True)])


def velocities_at(truth: Truth, q: Exact, v: Exact) -> Exact:
    """Velocities (L, 3)."""
    return jacobians_at(truth, q) @ v


def accelerations_at(truth: Truth, q: Exact, v: Exact, a: Exact) -> Exact:
    """Accelerations (L, 3)."""
    turning = truth.kinematics.along(lambda point: jacobians_at(truth, point), q, v)
    return jacobians_at(truth, q) @ a + turning @ v


def jacobians(truth: Truth, s: Point) -> Exact:
    """Jacobians of the points (L, 3, nv)."""
    return jacobians_at(truth, s.q)


def velocities(truth: Truth, s: Point) -> Exact:
    """Velocities (L, 3)."""
    return velocities_at(truth, s.q, s.v)


def accelerations(truth: Truth, s: Point) -> Exact:
    """Accelerations (L, 3)."""
    return accelerations_at(truth, s.q, s.v, s.a)


def products(truth: Truth, s: Point) -> Exact:
    """Accelerations at a = 0 (L, 3)."""
    return accelerations_at(truth, s.q, s.v, 0 * s.a)


def velocities_dq(truth: Truth, s: Point) -> Exact:
    """Derivatives of the velocities by q (L, 3, nv)."""
    return truth.kinematics.tangent(lambda q: velocities_at(truth, q, s.v), s.q)


def accelerations_dq(truth: Truth, s: Point) -> Exact:
    """Derivatives of the accelerations by q (L, 3, nv)."""
    return truth.kinematics.tangent(lambda q: accelerations_at(truth, q, s.v, s.a), s.q)


def accelerations_dv(truth: Truth, s: Point) -> Exact:
    """Derivatives of the accelerations by v (L, 3, nv)."""
    return truth.along_speeds(lambda v: accelerations_at(truth, s.q, v, s.a), s.v)
