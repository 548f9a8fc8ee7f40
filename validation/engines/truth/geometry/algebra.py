"""Spatial algebra in many digits: twists with wrenches, parameters of inertias, derivatives on groups of placements.

The second moments of a body, int (r; 1) (r; 1)^T dm, are its pseudo inertia (4, 4): with the inertia I about the
frame's origin, mass m and first moments h,

    P = [[tr(I) / 2 - I, h], [h^T, m]]                                                                            (11)

By logarithmic Cholesky parameters x = (alpha, d1, d2, d3, s12, s23, s13, t1, t2, t3) (Rucker, Wensing, "Smooth
parameterization of rigid-body inertia", 2022) P = U U^T,

    U = e^alpha [[e^d1, s12, s13, t1], [0, e^d2, s23, t2], [0, 0, e^d3, t3], [0, 0, 0, 1]]                          (12)
"""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal

import numpy as np

from ..arithmetic import Exact, cos_sin, cross, exact, eye, normalised, rate, rotation, skew, solve, stack, zeros
from ..derived import TruthOf, unit_inertias
from ..dynamics import Point, Truth
from ..kinematics import Inertia
from . import poses, turns
from .turns import rotation_vector, turn, turned_by

Pose = tuple[Exact, Exact]


def wrench_cross(t: Truth, s: Point) -> Exact:
    """The matrix of the product of the twist (v; v2) with wrenches (6, 6)."""
    return -poses.twist_cross(t, s).T


def wrench_transform_back(t: Truth, s: Point) -> Exact:
    """Wrenches of the frame that X is in, in X (6, 6)."""
    return turns.adjoint(t, s).T


def power(t: Truth, s: Point) -> Exact:
    """Power of the wrench (a; tau) at the twist (v; v2) (1)."""
    return np.array([s.v @ s.a + s.v2 @ s.tau])


def body_energy(t: Truth, s: Point) -> Exact:
    """Kinetic energy of the body at the twist (v; v2) (1)."""
    return np.array([poses.twist(s) @ poses.momentum(t, s) / 2])


def inertia_inverse(t: Truth, s: Point) -> Exact:
    """Twists of the body for its momentum (6, 6)."""
    return solve(poses.inertia_matrix(t, s), eye(6))


def _parameters(body: Inertia) -> Exact:
    """Mass, first moments, Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the frame's origin (10)."""
    second = [body.second[place] for place in ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))]
    return np.array([body.mass, *body.first, *second])


def _pseudo(body: Inertia) -> Exact:
    """Pseudo inertia (4, 4), eq. (11)."""
    sigma = np.trace(body.second) / 2 * eye(3) - body.second
    return np.block([[sigma, body.first[:, None]], [body.first[None], np.array([[body.mass]])]])


def inertia_parameters(t: Truth, s: Point) -> Exact:
    """The body's parameters (10)."""
    return _parameters(poses.inertia())


def pseudo_inertia(t: Truth, s: Point) -> Exact:
    """The body's pseudo inertia (4, 4)."""
    return _pseudo(poses.inertia())


def _logarithmic(s: Point) -> Exact:
    """Parameters (10) x / (1 + x^2) of x = (v, a, tau, v2[0])."""
    x = np.concatenate([s.v, s.a, s.tau, s.v2[:1]])
    return x / (1 + x * x)


def _of_logarithmic(x: Exact) -> Inertia:
    """The inertia of logarithmic Cholesky parameters, eqs. (11), (12)."""
    scale, d1, d2, d3 = (one.exp() for one in x[:4])
    zero, one = Decimal(0), Decimal(1)
    rows = [[d1, x[4], x[6], x[7]], [zero, d2, x[5], x[8]], [zero, zero, d3, x[9]], [zero, zero, zero, one]]
    U = scale * np.array(rows)
    P = U @ U.T
    sigma = P[:3, :3]
    return Inertia(P[3, 3], P[:3, 3], np.trace(sigma) * eye(3) - sigma)


def logarithmic_parameters(t: Truth, s: Point) -> Exact:
    """Parameters (10) of the inertia of these logarithmic ones."""
    return _parameters(_of_logarithmic(_logarithmic(s)))


def logarithmic_matrix(t: Truth, s: Point) -> Exact:
    """Matrix of momentum (6, 6) of the same."""
    return _of_logarithmic(_logarithmic(s)).matrix()


def logarithmic_derivatives(t: Truth, s: Point) -> Exact:
    """Derivative of the parameters by the logarithmic ones (10, 10)."""
    return _columns(lambda x: _parameters(_of_logarithmic(x)), _logarithmic(s))


def _columns(function: Callable[[Exact], Exact], point: Exact) -> Exact:
    """Derivatives of a function, along a new last axis."""
    return stack([rate(function, point, unit) for unit in eye(len(point))])


def _moments() -> Exact:
    return exact(poses.MOMENTS)


def moments_product(t: Truth, s: Point) -> Exact:
    """S v of the body's moments S about its mass centre (3)."""
    return _moments() @ s.v


def moments_along(t: Truth, s: Point) -> Exact:
    """v^T S v (1)."""
    return np.array([s.v @ _moments() @ s.v])


def moments_turned(t: Truth, s: Point) -> Exact:
    """R S R^T (3, 3)."""
    R = turn(t, s.q)
    return R @ _moments() @ R.T


def cross_matrix(t: Truth, s: Point) -> Exact:
    """The matrix of v x (3, 3)."""
    return skew(s.v)


def cross_matrices(t: Truth, s: Point) -> Exact:
    """The matrix of v x (a x) (3, 3)."""
    return skew(s.v) @ skew(s.a)


def turned_vector(t: Truth, s: Point) -> Exact:
    """R v (3)."""
    return turn(t, s.q) @ s.v


def turned_back(t: Truth, s: Point) -> Exact:
    """Rows of R^T (9)."""
    return turn(t, s.q).T.reshape(9)


def vector_rates_along(t: Truth, s: Point) -> Exact:
    """Rate of A^-1 at the rotation vector of R, as that turns with v along the turned axes (3, 3)."""
    R = turn(t, s.q)

    def rates(angle: Exact) -> Exact:
        return solve(turns.speeds(rotation_vector(R @ turned_by(angle))), eye(3))

    return rate(rates, zeros(3), s.v)


def rpy_rates_turned(t: Truth, s: Point) -> Exact:
    """Rates of roll, pitch, yaw at angles v for an angular velocity along the turned axes (3, 3)."""
    return turns.rpy_rates(t, s) @ poses.matrix_of(s.v)


def rpy_rates_turned_rate(t: Truth, s: Point) -> Exact:
    """Time derivative of the same as the angles change by a (3, 3)."""
    return rate(lambda v: rpy_rates_turned(t, s._replace(v=v)), s.v, s.a)


def momentum_cross_dv(t: Truth, s: Point) -> Exact:
    """Derivative of v* I v by the twist v = (v; v2) (6, 6)."""
    return _columns(lambda x: poses.momentum_cross(t, s._replace(v=x[:3], v2=x[3:])), poses.twist(s))


def momentum_regressor(t: Truth, s: Point) -> Exact:
    """Y (6, 10): I v = Y parameters at the twist v = (v; v2)."""
    return stack([body.matrix() @ poses.twist(s) for body in unit_inertias()])


def momentum_rate_regressor(t: Truth, s: Point) -> Exact:
    """Y (6, 10): I a + v* I v = Y parameters at the rate a = (a; tau) of the twist."""
    product, rates = wrench_cross(t, s), np.concatenate([s.a, s.tau])
    matrices = [body.matrix() for body in unit_inertias()]
    return stack([one @ rates + product @ one @ poses.twist(s) for one in matrices])


def _screws(s: Point) -> tuple[Pose, Pose]:
    """Turn and displacement about x, by (l, alpha), and about z, by (d, theta), of v and a[0]."""
    length, alpha, d = s.v
    x, z = eye(3)[0], eye(3)[2]
    return (rotation(x, *cos_sin(alpha)), length * x), (rotation(z, *cos_sin(s.a[0])), d * z)


def by_denavit(t: Truth, s: Point) -> Exact:
    """Placement by Denavit and Hartenberg's parameters (12)."""
    x, z = _screws(s)
    return poses.flat(*_then(z, x))


def by_modified_denavit(t: Truth, s: Point) -> Exact:
    """Placement by the modified ones (12)."""
    x, z = _screws(s)
    return poses.flat(*_then(x, z))


def turn_about_line(t: Truth, s: Point) -> Exact:
    """Turn by tau[0] about the line through a along v + AWAY (12)."""
    R = rotation(normalised(s.v + exact(poses.AWAY)), *cos_sin(s.tau[0]))
    return poses.flat(R, s.a - R @ s.a)


def twist_about_line(t: Truth, s: Point) -> Exact:
    """Twist of unit angular part about that line (6)."""
    u = normalised(s.v + exact(poses.AWAY))
    return np.concatenate([cross(s.a, u), u])


def _then(first: Pose, second: Pose) -> Pose:
    return first[0] @ second[0], first[1] + first[0] @ second[1]


def _twist_between(first: Pose, second: Pose) -> Exact:
    R, p = first
    return poses.leads(R.T @ second[0], R.T @ (second[1] - p))


def integrated(t: Truth, s: Point) -> Exact:
    """Where the twist (v; v2) leads from X (12)."""
    return poses.flat(*_then(poses.first(t, s), poses.leading(poses.twist(s))))


def integrated_dq(t: Truth, s: Point) -> Exact:
    """The twist of that, in its own frame, for the twist of X in its own (6, 6)."""
    return poses.of_twists(*poses.leading(poses.twist(s)))


def difference_dq(end: int) -> TruthOf:
    """Derivative of the twist from X to Y along twists of X (`end` 0), of Y (1), in its own frame (6, 6)."""

    def function(t: Truth, s: Point) -> Exact:
        ends = [poses.first(t, s), poses.second(t, s)]

        def apart(step: Exact) -> Exact:
            moved = [_then(one, poses.leading(step)) if k == end else one for k, one in enumerate(ends)]
            return _twist_between(*moved)

        return _columns(apart, zeros(6))

    return function


def squared(difference: TruthOf) -> TruthOf:
    """Square of the length of a vector (1)."""

    def function(t: Truth, s: Point) -> Exact:
        x = difference(t, s)
        return np.array([x @ x])

    return function


def turn_difference(t: Truth, s: Point) -> Exact:
    """Rotation vector of R^T Q (3)."""
    return rotation_vector(turn(t, s.q).T @ turn(t, s.q2))


def turn_integrated(t: Truth, s: Point) -> Exact:
    """Rows of R times the rotation by v (9)."""
    return (turn(t, s.q) @ turned_by(s.v)).reshape(9)


def turn_integrated_dq(t: Truth, s: Point) -> Exact:
    """Derivative of `turn_integrated`: angular velocity along the turned axes for that of R (3, 3)."""
    return turned_by(s.v).T


def turn_difference_dq(end: int) -> TruthOf:
    """Derivative of the rotation vector of R^T Q along angular velocities of R (`end` 0), of Q (1) (3, 3)."""

    def function(t: Truth, s: Point) -> Exact:
        R, Q = turn(t, s.q), turn(t, s.q2)

        def apart(step: Exact) -> Exact:
            T = turned_by(step)
            return rotation_vector((R @ T).T @ Q if end == 0 else R.T @ (Q @ T))

        return _columns(apart, zeros(3))

    return function
