"""Rotations in many digits: R and Q that the coordinates q and q2 make of a tree's only link, and vectors of rotation.

With S the matrix of the cross product of r, of length p, and w along the turned axes,

    w = A r',  A = 1 - (1 - cos p) / p^2 S + (p - sin p) / p^3 S^2                                                (5)

and along the axes before, w = A^T r'. The angles roll, pitch, yaw make R = Rz Ry Rx.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import product

import numpy as np

from ..arithmetic import Exact, arc, cos_sin, exact, eye, rate, root, rotation, skew, solve, stack
from ..derived import TruthOf
from ..dynamics import Point, Truth

_UNIT = exact(np.eye(3))


def turn(t: Truth, q: Exact) -> Exact:
    """The rotation (3, 3) that coordinates q make."""
    ((R, _),) = t.kinematics.poses(q)
    return R


def matrix(t: Truth, s: Point) -> Exact:
    """Rows of R (9)."""
    return turn(t, s.q).reshape(9)


def composed(t: Truth, s: Point) -> Exact:
    """Rows of R Q (9)."""
    return (turn(t, s.q) @ turn(t, s.q2)).reshape(9)


def angle(t: Truth, s: Point) -> Exact:
    """Angle of R^T Q (1)."""
    vector = rotation_vector(turn(t, s.q).T @ turn(t, s.q2))
    return np.array([root(vector @ vector)])


def cost(t: Truth, s: Point) -> Exact:
    """1 + 2 (1 - cos) of that angle (1): the trace of the rotation is 1 + 2 cos."""
    return np.array([4 - np.trace(turn(t, s.q).T @ turn(t, s.q2))])


def logarithm(t: Truth, s: Point) -> Exact:
    """Rotation vector of R (3)."""
    return rotation_vector(turn(t, s.q))


def rotation_vector(R: Exact) -> Exact:
    """Rotation vector (3), shorter than pi."""
    spin = np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / 2
    sine = root(spin @ spin)
    return spin * (arc((np.trace(R) - 1) / 2, sine) / sine) if sine else 0 * spin


def exponential(t: Truth, s: Point) -> Exact:
    """Rows of the rotation by the vector v (9)."""
    return turned_by(s.v).reshape(9)


def exponential_of_turns(t: Truth, s: Point) -> Exact:
    """Rows of the rotation by 16 v, which mostly is more than a turn (9)."""
    return turned_by(16 * s.v).reshape(9)


def half_turn(t: Truth, s: Point) -> Exact:
    """Rows of the half turn about u = v + (4, -8, 8): 2 u u^T / u^2 - 1 (9)."""
    u = s.v + exact([4.0, -8.0, 8.0])
    return (2 * np.outer(u, u) / (u @ u) - eye(3)).reshape(9)


# Axes of half turns: among them those along, between and near the coordinates' axes.
AXES = tuple(axis for axis in product(range(-2, 3), repeat=3) if axis > (0, 0, 0))


def half_turns(t: Truth, s: Point) -> Exact:
    """Rows of the half turns about AXES (n, 9)."""
    axes = (exact(np.array(axis, dtype=float)) for axis in AXES)
    return np.array([(2 * np.outer(u, u) / (u @ u) - eye(3)).reshape(9) for u in axes])


def turned_by(r: Exact) -> Exact:
    """The rotation (3, 3) by a vector."""
    length = root(r @ r)
    return rotation(r / length, *cos_sin(length)) if length else eye(3)


def speeds(r: Exact) -> Exact:
    """A (3, 3), eq. (5)."""
    length, S = root(r @ r), skew(r)
    if not length:
        return eye(3)
    cosine, sine = cos_sin(length)
    return eye(3) - (1 - cosine) / length**2 * S + (length - sine) / length**3 * (S @ S)


def vector_speeds(t: Truth, s: Point) -> Exact:
    """A at r = tau, eq. (5)."""
    return speeds(s.tau)


def vector_rates(t: Truth, s: Point) -> Exact:
    """The inverse of A at r = tau."""
    return solve(speeds(s.tau), eye(3))


def vector_rates_fixed(t: Truth, s: Point) -> Exact:
    """The inverse of A^T at r = v."""
    return solve(speeds(s.v).T, eye(3))


def vector_rates_rate(t: Truth, s: Point) -> Exact:
    """The time derivative of the inverse of A^T at r = tau, r' = a."""
    return rate(lambda r: solve(speeds(r).T, eye(3)), s.tau, s.a)


def of_angles(angles: Exact) -> Exact:
    """B with (roll, pitch, yaw)' = B w, w along the axes before."""
    _, pitch, yaw = (cos_sin(one) for one in angles)
    z, y = rotation(_UNIT[2], *yaw), rotation(_UNIT[1], *pitch)
    about = np.stack([(z @ y)[:, 0], z[:, 1], _UNIT[2]], axis=1)
    return solve(about, eye(3))


def rpy_rates(t: Truth, s: Point) -> Exact:
    """B at the angles v (3, 3)."""
    return of_angles(s.v)


def rpy_rates_rate(t: Truth, s: Point) -> Exact:
    """The time derivative of B at angles v and rates a (3, 3)."""
    return rate(of_angles, s.v, s.a)


def rpy_second_rates(t: Truth, s: Point) -> Exact:
    """(B w)' at angles v, rates a and the angular acceleration tau along the axes before (3)."""
    return of_angles(s.v) @ s.tau + rate(of_angles, s.v, s.a) @ solve(of_angles(s.v), s.a)


def between(t: Truth, s: Point) -> Exact:
    """Rows of the rotation a quarter of the way from R to Q (9)."""
    R = turn(t, s.q)
    return (R @ turned_by(rotation_vector(R.T @ turn(t, s.q2)) / 4)).reshape(9)


def along_speeds(of: Callable[[Exact], Exact]) -> TruthOf:
    """The derivative of a function of R along the angular velocity in the turned axes (n, 3)."""
    return lambda t, s: t.kinematics.tangent(lambda q: of(turn(t, q)), s.q)


def by_vector(of: Callable[[Exact], Exact]) -> TruthOf:
    """The derivative of a function of the vector u = v + (4, -8, 8) by it (n, 3)."""

    def function(t: Truth, s: Point) -> Exact:
        return stack([rate(of, s.v + exact([4.0, -8.0, 8.0]), axis) for axis in eye(3)])

    return function


def adjoint(t: Truth, s: Point) -> Exact:
    """Twists of a frame at (R, a), in the frame that it is in (6, 6)."""
    R = turn(t, s.q)
    return np.block([[R, skew(s.a) @ R], [exact(np.zeros((3, 3))), R]])
