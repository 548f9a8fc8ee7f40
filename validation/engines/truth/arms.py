"""Truth of an arm: a chain of six joints of one coordinate, and a tool that is fixed to it, its end."""

from __future__ import annotations

from decimal import Decimal

import numpy as np

from .arithmetic import Exact, cross, exact, solve, stack, volume
from .dynamics import Point, Truth
from .geometry.poses import angles_of
from .geometry.turns import of_angles
from .points import POINT

# A point that the last link with a joint carries: mass [kg] and place [m].
BURDEN, AT = 2.0, (0.25, -0.5, 0.125)
# Place of the last link with a joint: the one after it is the tool.
_LAST = -2


def _end(truth: Truth, q: Exact) -> tuple[Exact, Exact, Exact]:
    R, p = truth.kinematics.poses(q)[-1]
    return R, p, truth.kinematics.jacobians(q)[-1]


def pose(truth: Truth, s: Point) -> Exact:
    """Position and rows of the rotation of the end (12)."""
    R, p, _ = _end(truth, s.q)
    return np.concatenate([p, R.reshape(9)])


def jacobian(truth: Truth, s: Point) -> Exact:
    """J (6, nv) along the world's axes."""
    return _end(truth, s.q)[2]


def jacobian_local(truth: Truth, s: Point) -> Exact:
    """J along the end's axes."""
    R, _, J = _end(truth, s.q)
    return np.concatenate([R.T @ J[:3], R.T @ J[3:]])


def jacobian_rate(truth: Truth, s: Point) -> Exact:
    """dJ/dt (6, nv)."""
    return truth.kinematics.along(lambda q: _end(truth, q)[2], s.q, s.v)


def jacobian_dq(truth: Truth, s: Point) -> Exact:
    """Derivatives of J (6, nv, nv), the last index that of the derivative."""
    return truth.kinematics.tangent(lambda q: _end(truth, q)[2], s.q)


def of_rpy(truth: Truth, s: Point) -> Exact:
    """J with rates of roll, pitch, yaw (6, nv)."""
    R, _, J = _end(truth, s.q)
    return np.concatenate([J[:3], of_angles(angles_of(R)) @ J[3:]])


def _manipulability(J: Exact) -> Exact:
    # Of six joints, J is square: the root of det(J J^T) is |det J|.
    return volume(J)


def goal_pose(truth: Truth, s: Point) -> Exact:
    """Pose of the end at q2 (12)."""
    return pose(truth, s._replace(q=s.q2))


def goal_pose_far(truth: Truth, s: Point) -> Exact:
    """Pose of the end at 8 q2 (12): beyond a turn, and as far along slides."""
    return pose(truth, s._replace(q=8 * s.q2))


def goal_place(truth: Truth, s: Point) -> Exact:
    """Position of the end at q2 (3)."""
    return goal_pose(truth, s)[:3]


def goal_turn(truth: Truth, s: Point) -> Exact:
    """Rows of the rotation of the end at q2 (9)."""
    return goal_pose(truth, s)[3:]


def goal_point(truth: Truth, s: Point) -> Exact:
    """Place of a point of the end at q2 (3)."""
    R, p, _ = _end(truth, s.q2)
    return p + R @ exact(POINT)


def manipulability(truth: Truth, s: Point) -> Exact:
    """Root of det(J J^T) (1)."""
    return np.array([_manipulability(jacobian(truth, s))])


def manipulability_dq(truth: Truth, s: Point) -> Exact:
    """Derivatives of `manipulability` by q (nv)."""
    values = truth.kinematics.tangent(lambda q: np.array([_manipulability(_end(truth, q)[2])]), s.q)
    return values[0]


def mass_matrix(truth: Truth, s: Point) -> Exact:
    """K^-T M K^-1 (6, 6), K = of_rpy."""
    J = of_rpy(truth, s)
    return solve(J.T, solve(J.T, truth.M(s.q)).T)


def gravity(truth: Truth, s: Point) -> Exact:
    """K^-T g (6)."""
    return solve(of_rpy(truth, s).T, truth.g(s.q))


def loads_local(truth: Truth, s: Point) -> Exact:
    """J^T w (nv) of the last link with a joint, at its frame, w = tau along its axes."""
    R, J = truth.kinematics.poses(s.q)[_LAST][0], truth.kinematics.jacobians(s.q)[_LAST]
    return J.T @ np.concatenate([R @ s.tau[:3], R @ s.tau[3:]])


def burdened(truth: Truth, s: Point) -> Exact:
    """Gravity forces with the burden (nv)."""
    R, _ = truth.kinematics.poses(s.q)[_LAST]
    J, arm, weight = truth.kinematics.jacobians(s.q)[_LAST], R @ exact(AT), Decimal(BURDEN) * truth.gravity_vector
    linear = stack([J[:3, k] + cross(J[3:, k], arm) for k in range(truth.nv)])
    return truth.g(s.q) - linear.T @ weight
