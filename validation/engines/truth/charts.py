"""What a joint's coordinates and speeds mean: the placement that coordinates give, the rates that speeds make of them.

Nothing else of a joint is stated: partial velocities and their rates follow by differences in many digits (`truth`).
A new chart is a row of CHARTS; its formulas take coordinates that are slightly off the manifold, too (quaternions of
any length).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal
from typing import Any

import numpy as np

from ..interface import Array, Joint
from .arithmetic import (
    Exact,
    cos_sin,
    exact,
    eye,
    quaternion_rotation,
    root,
    rotation,
    skew,
    solve,
    unit,
    zeros,
)

Pose = tuple[Exact, Exact]
Draw = np.random.Generator


@dataclass(frozen=True)
class Chart:
    """Coordinates and speeds of one joint.

    Attributes:
        text: What they are, for people.
        nq: Number of coordinates.
        nv: Number of speeds.
        pose: Joint, coordinates (nq) -> rotation R (3, 3) and position p (3) of the frame after the joint, in the
            frame before.
        rates: Joint, coordinates (nq) -> N (nq, nv) with q' = N v.
        sample: Joint, generator -> random coordinates (nq).
    """

    text: str
    nq: int
    nv: int
    pose: Callable[[Joint, Exact], Pose]
    rates: Callable[[Joint, Exact], Exact]
    sample: Callable[[Joint, Draw], Array]

    @property
    def position(self) -> tuple[int, ...]:
        """Places of a free joint's position among its coordinates; () for other joints."""
        if self.nv < 6:
            return ()
        return (0, 1, 2) if self.text.startswith("position") else tuple(range(self.nq - 3, self.nq))

    @property
    def is_flat(self) -> bool:
        """Whether speeds are the rates of the coordinates."""
        return self.rates is _same


def _turn(axis: Exact, q: Any) -> Exact:
    return rotation(axis, *cos_sin(q))


def _same(joint: Joint, q: Exact) -> Exact:
    return eye(len(q))


def _revolute(joint: Joint, q: Exact) -> Pose:
    return _turn(unit(joint.axis), q[0]), zeros(3)


def _cos_sin(joint: Joint, q: Exact) -> Pose:
    norm = root(q @ q)
    return rotation(unit(joint.axis), q[0] / norm, q[1] / norm), zeros(3)


def _prismatic(joint: Joint, q: Exact) -> Pose:
    return eye(3), q[0] * unit(joint.axis)


def _helical(joint: Joint, q: Exact) -> Pose:
    axis = unit(joint.axis)
    return _turn(axis, q[0]), exact(joint.pitch) * q[0] * axis


def _universal(joint: Joint, q: Exact) -> Pose:
    return _turn(unit(joint.axis), q[0]) @ _turn(unit(joint.second), q[1]), zeros(3)


def _euler(joint: Joint, q: Exact) -> Pose:
    R = eye(3)
    for letter, angle in zip(joint.sequence, q, strict=True):
        R = R @ _turn(exact(np.eye(3)["XYZ".index(letter)]), angle)
    return R, zeros(3)


def _translation(joint: Joint, q: Exact) -> Pose:
    return eye(3), q


def _wxyz(joint: Joint, q: Exact) -> Pose:
    return quaternion_rotation(*q), zeros(3)


def _wxyz_rates(joint: Joint, q: Exact) -> Exact:
    """Q' = q (0, w) / 2 with w along the axes of the frame after the joint."""
    w, x, y, z = q
    return np.array([[-x, -y, -z], [w, -z, y], [z, w, -x], [-y, x, w]], dtype=object) / 2


def _wxyz_rates_before(joint: Joint, q: Exact) -> Exact:
    """Q' = (0, w) q / 2 with w along the axes of the frame before the joint."""
    w, x, y, z = q
    return np.array([[-x, -y, -z], [w, z, -y], [-z, w, x], [y, -x, w]], dtype=object) / 2


def _last(q: Exact) -> Exact:
    """Scalar last -> scalar first."""
    return np.roll(q, 1)


def _xyzw(joint: Joint, q: Exact) -> Pose:
    return _wxyz(joint, _last(q))


def _xyzw_rates(joint: Joint, q: Exact) -> Exact:
    return np.roll(_wxyz_rates(joint, _last(q)), -1, axis=0)


def _blocks(linear: Exact, angular: Exact) -> Exact:
    """N (7, 6) of position and quaternion."""
    N = zeros(3 + len(angular), 6)
    N[:3, :3], N[3:, 3:] = linear, angular
    return N


def _free_xyzw(joint: Joint, q: Exact) -> Pose:
    return _xyzw(joint, q[3:])[0], q[:3]


def _free_wxyz(joint: Joint, q: Exact) -> Pose:
    return _wxyz(joint, q[3:])[0], q[:3]


def _free_body_rates(joint: Joint, q: Exact) -> Exact:
    return _blocks(_xyzw(joint, q[3:])[0], _xyzw_rates(joint, q[3:]))


def _free_mixed_rates(joint: Joint, q: Exact) -> Exact:
    return _blocks(eye(3), _wxyz_rates(joint, q[3:]))


def _xyzw_rates_before(joint: Joint, q: Exact) -> Exact:
    return np.roll(_wxyz_rates_before(joint, _last(q)), -1, axis=0)


def _free_world_rates(joint: Joint, q: Exact) -> Exact:
    return _blocks(eye(3), _xyzw_rates_before(joint, q[3:]))


def _free_world_rates_angular_first(joint: Joint, q: Exact) -> Exact:
    return np.roll(_free_world_rates(joint, q), 3, axis=1)


def _planar_pose(joint: Joint, q: Exact) -> Pose:
    R, _ = _cos_sin(Joint("revolute"), q[2:])
    return R, np.array([q[0], q[1], Decimal(0)], dtype=object)


def _cos_sin_rates(joint: Joint, q: Exact) -> Exact:
    return np.array([[-q[1]], [q[0]]], dtype=object)


def _planar_rates(joint: Joint, q: Exact) -> Exact:
    c, s = q[2], q[3]
    zero = Decimal(0)
    return np.array([[c, -s, zero], [s, c, zero], [zero, zero, -s], [zero, zero, c]], dtype=object)


def _ellipsoid(joint: Joint, q: Exact) -> Pose:
    """A point that runs on an ellipsoid, with R = Rx(q0) Ry(q1) Rz(q2)."""
    R, _ = _euler(Joint("euler", sequence="XYZ"), q)
    return R, exact(joint.radii) * R[:, 2]


def _rotation_vector(joint: Joint, q: Exact) -> Pose:
    angle = root(q @ q)
    return (_turn(q / angle, angle), zeros(3)) if angle else (eye(3), zeros(3))


def _rotation_vector_rates(before: int) -> Callable[[Joint, Exact], Exact]:
    """Columns of 1 + [q]/2 + (1/|q|^2 - (1 + cos)/(2 |q| sin)) [q]^2 for axes after; with -[q]/2, for those before."""

    def rates(joint: Joint, q: Exact) -> Exact:
        angle, turned = root(q @ q), skew(q)
        if not angle:
            return eye(3)
        c, s = cos_sin(angle)
        return eye(3) - before * turned / 2 + (1 / angle**2 - (1 + c) / (2 * angle * s)) * (turned @ turned)

    return rates


def _roll_pitch_yaw(joint: Joint, q: Exact) -> Pose:
    return _euler(Joint("euler", sequence="ZYX"), q[::-1])


def _roll_pitch_yaw_rates(joint: Joint, q: Exact) -> Exact:
    """The inverse of the map from rates of roll, pitch, yaw to the angular velocity in the axes before."""
    z = eye(3)[2]
    yaw = _turn(z, q[2])
    return solve(np.stack([yaw @ _turn(eye(3)[1], q[1])[:, 0], yaw[:, 1], z], axis=1), eye(3))


def _free_vector(joint: Joint, q: Exact) -> Pose:
    return _rotation_vector(joint, q[:3])[0], q[3:]


def _free_roll_pitch_yaw(joint: Joint, q: Exact) -> Pose:
    return _roll_pitch_yaw(joint, q[:3])[0], q[3:]


def _free_quaternion_first(joint: Joint, q: Exact) -> Pose:
    return _wxyz(joint, q[:4])[0], q[4:]


def _turning_first(rates: Callable[[Joint, Exact], Exact], size: int) -> Callable[[Joint, Exact], Exact]:
    """Rates of a free joint whose first coordinates are a rotation's; linear velocity along the axes before."""

    def together(joint: Joint, q: Exact) -> Exact:
        N = zeros(size + 3, 6)
        N[:size, :3], N[size:, 3:] = rates(joint, q[:size]), eye(3)
        return N

    return together


def _along_parent(rates: Callable[[Joint, Exact], Exact]) -> Callable[[Joint, Exact], Exact]:
    """Rates of a free joint whose speeds are along the axes of the link before, not of the joint's frame in it."""

    def turned(joint: Joint, q: Exact) -> Exact:
        N, R = rates(joint, q), exact(joint.R)
        return np.concatenate([N[:, :3] @ R.T, N[:, 3:] @ R.T], axis=1)

    return turned


def _planar_angle(joint: Joint, q: Exact) -> Pose:
    return _turn(eye(3)[2], q[2]), np.array([q[0], q[1], Decimal(0)], dtype=object)


def _quaternion_first_sample(joint: Joint, draw: Draw) -> Array:
    return np.concatenate([_direction(draw, 4), draw.uniform(-1, 1, 3)])


def _line(nq: int, size: float) -> Callable[[Joint, Draw], Array]:
    return lambda joint, draw: draw.uniform(-size, size, nq)


def _direction(draw: Draw, n: int) -> Array:
    q = draw.normal(size=n)
    return np.asarray(q / math.hypot(*q))  # The sums of BLAS depend on the processor.


def _circle(joint: Joint, draw: Draw) -> Array:
    angle = draw.uniform(-math.pi, math.pi)
    return np.array([math.cos(angle), math.sin(angle)])


def _sphere(joint: Joint, draw: Draw) -> Array:
    return _direction(draw, 4)


def _free_sample(joint: Joint, draw: Draw) -> Array:
    return np.concatenate([draw.uniform(-1, 1, 3), _direction(draw, 4)])


def _planar_sample(joint: Joint, draw: Draw) -> Array:
    return np.concatenate([draw.uniform(-1, 1, 2), _circle(joint, draw)])


CHARTS: dict[str, Chart] = {
    "angle": Chart("angle; its rate", 1, 1, _revolute, _same, _line(1, 2.5)),
    "cos sin": Chart("cosine and sine of the angle; rate of the angle", 2, 1, _cos_sin, _cos_sin_rates, _circle),
    "length": Chart("displacement; its rate", 1, 1, _prismatic, _same, _line(1, 1.0)),
    "screw angle": Chart("angle; its rate", 1, 1, _helical, _same, _line(1, 2.5)),
    "two angles": Chart("angles; their rates", 2, 2, _universal, _same, _line(2, 1.2)),
    "three angles": Chart("angles of successive rotations; their rates", 3, 3, _euler, _same, _line(3, 1.2)),
    "three lengths": Chart("displacements; their rates", 3, 3, _translation, _same, _line(3, 1.0)),
    "quaternion wxyz, body speeds": Chart(
        "quaternion, scalar first; angular velocity in the axes after the joint", 4, 3, _wxyz, _wxyz_rates, _sphere
    ),
    "quaternion wxyz, parent speeds": Chart(
        "quaternion, scalar first; angular velocity in the axes before the joint", 4, 3, _wxyz, _wxyz_rates_before,
        _sphere
    ),
    "quaternion xyzw, body speeds": Chart(
        "quaternion, scalar last; angular velocity in the axes after the joint", 4, 3, _xyzw, _xyzw_rates, _sphere
    ),
    "quaternion xyzw, parent speeds": Chart(
        "quaternion, scalar last; angular velocity in the axes before the joint",
        4, 3, _xyzw, _xyzw_rates_before, _sphere,
    ),
    "free xyzw, body speeds": Chart(
        "position, quaternion with scalar last; linear and angular velocity in the axes after the joint",
        7, 6, _free_xyzw, _free_body_rates, _free_sample,
    ),
    "free wxyz, linear before and angular after": Chart(
        "position, quaternion with scalar first; linear velocity in the axes before, angular in those after the joint",
        7, 6, _free_wxyz, _free_mixed_rates, _free_sample,
    ),
    "free xyzw, linear and angular before": Chart(
        "position, quaternion with scalar last; linear and angular velocity in the axes before the joint",
        7, 6, _free_xyzw, _free_world_rates, _free_sample,
    ),
    "free xyzw, angular and linear before": Chart(
        "position, quaternion with scalar last; angular and linear velocity in the axes before the joint",
        7, 6, _free_xyzw, _free_world_rates_angular_first, _free_sample,
    ),
    "planar cos sin, body speeds": Chart(
        "x, y, cosine and sine; velocity in the axes after the joint", 4, 3, _planar_pose, _planar_rates, _planar_sample
    ),
    "planar angle": Chart("x, y, angle; their rates", 3, 3, _planar_angle, _same, _line(3, 1.2)),
    "rotation vector, body speeds": Chart(
        "rotation vector; angular velocity in the axes after the joint",
        3, 3, _rotation_vector, _rotation_vector_rates(-1), _line(3, 1.2),
    ),
    "roll pitch yaw, parent speeds": Chart(
        "R = Rz(yaw) Ry(pitch) Rx(roll); angular velocity in the axes before the joint",
        3, 3, _roll_pitch_yaw, _roll_pitch_yaw_rates, _line(3, 1.2),
    ),
    "free rotation vector, angular and linear along the parent's axes": Chart(
        "rotation vector, position; angular and linear velocity in the axes of the link before",
        6, 6, _free_vector, _along_parent(_turning_first(_rotation_vector_rates(1), 3)), _line(6, 1.2),
    ),
    "free roll pitch yaw, angular and linear before": Chart(
        "roll, pitch, yaw, position; angular and linear velocity in the axes before the joint",
        6, 6, _free_roll_pitch_yaw, _turning_first(_roll_pitch_yaw_rates, 3), _line(6, 1.2),
    ),
    "free quaternion first, angular and linear before": Chart(
        "quaternion with scalar first, position; angular and linear velocity in the axes before the joint",
        7, 6, _free_quaternion_first, _turning_first(_wxyz_rates_before, 4), _quaternion_first_sample,
    ),
    "ellipsoid angles": Chart(
        "angles about x, y, z in succession; their rates", 3, 3, _ellipsoid, _same, _line(3, 1.2)
    ),
}  # fmt: off

# Kinds of elementary joints -> the chart that states their geometry most plainly.
GEOMETRIES: dict[str, str] = {
    "revolute": "angle",
    "prismatic": "length",
    "helical": "screw angle",
    "universal": "two angles",
    "euler": "three angles",
    "translation": "three lengths",
    "ball": "quaternion wxyz, body speeds",
    "free": "free wxyz, linear before and angular after",
    "planar": "planar cos sin, body speeds",
    "ellipsoid": "ellipsoid angles",
}
