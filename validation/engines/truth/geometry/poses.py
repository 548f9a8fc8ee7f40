"""Placements and inertias in many digits: X = (R, a) of the coordinates q, Y = (Q, tau) of q2, twists (v; v2).

With r a rotation vector, S the matrix of its cross product and p its length, a twist (u; r) leads in unit time to

    exp (u; r) = (exp r, V u),  V = 1 + (1 - cos p) / p^2 S + (p - sin p) / p^3 S^2                              (6)
"""

from __future__ import annotations

from decimal import Decimal

import numpy as np

from ..arithmetic import (
    Exact,
    arc,
    cos_sin,
    cross,
    exact,
    eye,
    normalised,
    rate,
    root,
    rotation,
    skew,
    solve,
    stack,
    zeros,
)
from ..dynamics import Point, Truth
from ..kinematics import Inertia
from .turns import rotation_vector, speeds, turn, turned_by

# What directions have added, so that they never vanish and are never along each other.
AWAY, ASIDE, BESIDE = (4.0, -8.0, 8.0), (8.0, 4.0, 4.0), (8.0, -4.0, 4.0)
# A direction that is nearly -z.
BACK = (0.0625, 0.03125, -1.0)
# Points that are no plane's, and how much each counts where placements lead them to others.
POINTS = ((0.0, 0.5, 0.25), (1.0, -0.5, 0.0), (0.25, 2.0, -1.0), (-1.5, 0.0, 0.5), (0.5, 0.25, 3.0))
WEIGHTS = (1.0, 2.0, 0.5, 4.0, 3.0)
# Mass, mass centre, moments about it of a body that is no tree's.
MASS, CENTRE = 2.0, (0.25, -0.5, 0.125)
MOMENTS = ((0.5, 0.0625, -0.03125), (0.0625, 0.375, 0.125), (-0.03125, 0.125, 0.625))


def flat(R: Exact, p: Exact) -> Exact:
    """Position and rows of R (12)."""
    return np.concatenate([p, R.reshape(9)])


def first(t: Truth, s: Point) -> tuple[Exact, Exact]:
    """X."""
    return turn(t, s.q), s.a


def second(t: Truth, s: Point) -> tuple[Exact, Exact]:
    """Y."""
    return turn(t, s.q2), s.tau


def _apart(t: Truth, s: Point) -> tuple[Exact, Exact]:
    """X^-1 Y."""
    (R, p), (Q, r) = first(t, s), second(t, s)
    return R.T @ Q, R.T @ (r - p)


def composed(t: Truth, s: Point) -> Exact:
    """X Y (12)."""
    (R, p), (Q, r) = first(t, s), second(t, s)
    return flat(R @ Q, p + R @ r)


def aligned(t: Truth, s: Point) -> Exact:
    """X, which leads points to where they are under it (12)."""
    return flat(*first(t, s))


def drawn(t: Truth, s: Point) -> Exact:
    """The position of a random placement within bounds of no width about v (3)."""
    return s.v


def unset(t: Truth, s: Point) -> Exact:
    """A placement that nobody has set (12)."""
    return flat(eye(3), zeros(3))


def inverse(t: Truth, s: Point) -> Exact:
    """X^-1 (12)."""
    R, p = first(t, s)
    return flat(R.T, -R.T @ p)


def relative(t: Truth, s: Point) -> Exact:
    """X^-1 Y (12)."""
    return flat(*_apart(t, s))


def placed(t: Truth, s: Point) -> Exact:
    """The point v of X in the frame before (3)."""
    R, p = first(t, s)
    return p + R @ s.v


def leading(twist: Exact) -> tuple[Exact, Exact]:
    """Where a twist leads in unit time, eq. (6)."""
    return turned_by(twist[3:]), speeds(twist[3:]).T @ twist[:3]


def leads(R: Exact, p: Exact) -> Exact:
    """The twist that leads to a placement (6)."""
    r = rotation_vector(R)
    return np.concatenate([solve(speeds(r).T, p), r])


def twist(s: Point) -> Exact:
    """(v; v2) (6)."""
    return np.concatenate([s.v, s.v2])


def logarithm(t: Truth, s: Point) -> Exact:
    """The twist that leads to X (6)."""
    return leads(*first(t, s))


def difference(t: Truth, s: Point) -> Exact:
    """The twist that leads from X to Y, along the axes of X (6)."""
    return leads(*_apart(t, s))


def exponential(t: Truth, s: Point) -> Exact:
    """Where the twist (v; v2) leads (12), eq. (6)."""
    return flat(*leading(twist(s)))


def between(t: Truth, s: Point) -> Exact:
    """A quarter of the way from X to Y, along the screw (12)."""
    (R, p), (step, way) = first(t, s), leading(difference(t, s) / 4)
    return flat(R @ step, p + R @ way)


def between_apart(t: Truth, s: Point) -> Exact:
    """A quarter of the way from X to Y: of the positions along their line, of the rotations the shorter way (12)."""
    (R, p), (Q, r) = first(t, s), second(t, s)
    return flat(R @ turned_by(rotation_vector(R.T @ Q) / 4), p + (r - p) / 4)


def _body_rates(pose: tuple[Exact, Exact], rates: Exact) -> Exact:
    """Twist in the placed frame (6) of the rates (12) of a placement."""
    R = pose[0]
    turning = R.T @ rates[3:].reshape(3, 3)
    return np.concatenate([R.T @ rates[:3], np.array([turning[2, 1], turning[0, 2], turning[1, 0]])])


def exponential_speeds(t: Truth, s: Point) -> Exact:
    """J with the twist J x' of exp x in its own frame, at x = (v; v2) (6, 6)."""
    return _exponential_speeds(twist(s))


def _exponential_speeds(twist: Exact) -> Exact:
    pose, unit = leading(twist), eye(6)
    return stack([_body_rates(pose, rate(lambda x: flat(*leading(x)), twist, unit[k])) for k in range(6)])


def logarithm_rates(t: Truth, s: Point) -> Exact:
    """J with (log X)' = J times the twist of X in its own frame (6, 6)."""
    return solve(_exponential_speeds(logarithm(t, s)), eye(6))


def wrench_transform(t: Truth, s: Point) -> Exact:
    """Wrenches (force; moment) of the frame X in the frame it is in (6, 6)."""
    R, p = first(t, s)
    return np.block([[R, zeros(3, 3)], [skew(p) @ R, R]])


def twist_transform_back(t: Truth, s: Point) -> Exact:
    """Twists of the frame that X is in, in X (6, 6)."""
    return of_twists(*first(t, s))


def of_twists(R: Exact, p: Exact) -> Exact:
    """Twists of the frame that a placement (R, p) is in, in the placed one (6, 6)."""
    return np.block([[R.T, -R.T @ skew(p)], [zeros(3, 3), R.T]])


def twist_cross(t: Truth, s: Point) -> Exact:
    """The matrix of the product of the twist (v; v2) with twists (6, 6)."""
    return np.block([[skew(s.v2), skew(s.v)], [zeros(3, 3), skew(s.v2)]])


def quaternion_rates(t: Truth, s: Point) -> Exact:
    """Rates of the quaternion q (4) at the angular velocity v along the turned axes."""
    return t.kinematics.rates(s.q) @ s.v


def quaternion_rates_fixed(t: Truth, s: Point) -> Exact:
    """Rates of the quaternion q (4) at the angular velocity v along the axes before."""
    return t.kinematics.rates(s.q) @ turn(t, s.q).T @ s.v


def _about(axis: int, angle: Exact) -> Exact:
    return rotation(eye(3)[axis], *cos_sin(angle))


def of_rpy(t: Truth, s: Point) -> Exact:
    """Rows of Rz(v[2]) Ry(v[1]) Rx(v[0]) (9)."""
    return matrix_of(s.v).reshape(9)


def matrix_of(angles: Exact) -> Exact:
    """The rotation (3, 3) of roll, pitch, yaw."""
    roll, pitch, yaw = angles
    return _about(2, yaw) @ _about(1, pitch) @ _about(0, roll)


def rate_of_rpy(t: Truth, s: Point) -> Exact:
    """The rate of these rows as v changes by a (9)."""
    return rate(lambda v: of_rpy(t, s._replace(v=v)), s.v, s.a)


def to_rpy(t: Truth, s: Point) -> Exact:
    """Roll, pitch within a quarter turn, yaw of R = Rz Ry Rx (3)."""
    return angles_of(turn(t, s.q))


def angles_of(R: Exact) -> Exact:
    """Roll, pitch within a quarter turn, yaw of a rotation (3)."""
    level = root(R[0, 0] ** 2 + R[1, 0] ** 2)
    return np.array([arc(R[2, 2], R[2, 1]), arc(level, -R[2, 0]), arc(R[0, 0], R[1, 0])])


def of_zyz(t: Truth, s: Point) -> Exact:
    """Rows of Rz(v[0]) Ry(v[1]) Rz(v[2]) (9)."""
    return (_about(2, s.v[0]) @ _about(1, s.v[1]) @ _about(2, s.v[2])).reshape(9)


# Axes of three turns, each of which the ones before have turned.
SEQUENCES = tuple("xyz xzy yxz yzx zxy zyx xyx xzx yxy yzy zxz zyz".split())


def of_three_angles(t: Truth, s: Point) -> Exact:
    """Rows of the turns by v[0], v[1], v[2] about the axes of each of SEQUENCES (12, 9)."""
    turned = [[_about("xyz".index(axis), angle) for axis, angle in zip(axes, s.v, strict=True)] for axes in SEQUENCES]
    return np.array([(one @ two @ three).reshape(9) for one, two, three in turned])


def on_end(t: Truth, s: Point) -> Exact:
    """Rows of Rz(v[2]) Ry(p) Rx(v[0]) with the pitch p a quarter turn, up and down (2, 9)."""
    rows = []
    for sign in (Decimal(1), Decimal(-1)):
        pitch = rotation(eye(3)[1], Decimal(0), sign)
        rows.append((_about(2, s.v[2]) @ pitch @ _about(0, s.v[0])).reshape(9))
    return np.array(rows)


def _shortest(u: Exact) -> Exact:
    """Rows of the shortest turn of z into the direction of u, which is not -z (9)."""
    x = normalised(u)
    S = skew(cross(eye(3)[2], x))  # Of the sine of the angle; its cosine is x[2].
    return (eye(3) + S + S @ S / (1 + x[2])).reshape(9)


def of_z(t: Truth, s: Point) -> Exact:
    """Rows of the shortest turn of z along v + AWAY (9)."""
    return _shortest(s.v + exact(AWAY))


def of_z_back(t: Truth, s: Point) -> Exact:
    """Rows of the shortest turn of z along v / 64 + BACK (9)."""
    return _shortest(s.v / 64 + exact(BACK))


def zyz_speeds(t: Truth, s: Point) -> Exact:
    """B with w = B x' along the axes before, of R = Rz(x[0]) Ry(x[1]) Rz(x[2]) at x = v (3, 3)."""
    z, y = _about(2, s.v[0]), _about(1, s.v[1])
    return np.stack([eye(3)[2], z[:, 1], (z @ y)[:, 2]], axis=1)


def are_rotations(t: Truth, s: Point) -> Exact:
    """Whether R, R with its last column turned round, R times 1.25 are rotations: 1, 0, 0 (3)."""
    return np.array([Decimal(1), Decimal(0), Decimal(0)])


def of_two_axes(t: Truth, s: Point) -> Exact:
    """Rows of the rotation whose third axis is along u = v + AWAY, with v2 + ASIDE in its second half plane (9)."""
    z = normalised(s.v + exact(AWAY))
    x = normalised(cross(s.v2 + exact(ASIDE), z))
    return np.stack([x, cross(z, x), z], axis=1).reshape(9)


def inertia() -> Inertia:
    """The body of MASS, CENTRE, MOMENTS."""
    centre = skew(exact(CENTRE))
    mass = exact(MASS)[()]
    return Inertia(mass, mass * exact(CENTRE), exact(MOMENTS) - mass * (centre @ centre))


def inertia_matrix(t: Truth, s: Point) -> Exact:
    """Momentum (linear; angular, about the frame's origin) of the body of MASS, CENTRE, MOMENTS for a twist (6, 6)."""
    return inertia().matrix()


def inertia_placed(t: Truth, s: Point) -> Exact:
    """The same of that body, given in X, in the frame that X is in (6, 6)."""
    back = twist_transform_back(t, s)
    return back.T @ inertia().matrix() @ back


def inertia_sum(t: Truth, s: Point) -> Exact:
    """The same of that body and of one more, placed at X (6, 6)."""
    return inertia_matrix(t, s) + inertia_placed(t, s)


def momentum(t: Truth, s: Point) -> Exact:
    """Momentum of the body for the twist (v; v2) (6)."""
    return inertia().matrix() @ twist(s)


def momentum_cross(t: Truth, s: Point) -> Exact:
    """What the twist (v; v2) makes of its momentum: v* I v (6)."""
    return -twist_cross(t, s).T @ momentum(t, s)


def inertia_rate(t: Truth, s: Point) -> Exact:
    """Rate of the matrix of momentum as the body moves with the twist (v; v2) (6, 6)."""
    product, matrix = twist_cross(t, s), inertia().matrix()
    return -product.T @ matrix - matrix @ product
