"""Forces of single elements in many digits, as Drake's documentation states them: bushings, hinges, propellers, wings.

The body stands at X = (R, a) of the coordinates q, turns with v and moves with v2, all along the world's axes. Numbers
of the elements are constants here, which the engine's text has, too.
"""

from __future__ import annotations

from decimal import Decimal

import numpy as np

from ...frames import Vector
from ..arithmetic import Exact, cross, exact, root
from ..derived import TruthOf
from ..dynamics import Point, Truth
from ..geometry.poses import CENTRE, angles_of
from ..geometry.turns import of_angles, rotation_vector, turn, turned_by

# Constants of a bushing about roll, pitch, yaw and along x, y, z: stiffness, then damping of each.
TORQUES = ((2.0, 3.0, 5.0), (0.25, 0.5, 0.75))
FORCES = ((7.0, 11.0, 13.0), (1.5, 1.25, 1.75))
# Of a hinge of a door, by their names in its configuration.
HINGE = {
    "spring_zero_angle_rad": 0.25,
    "spring_constant": 1.5,
    "dynamic_friction_torque": 0.5,
    "static_friction_torque": 0.75,
    "viscous_friction": 0.375,
    "catch_width": 0.5,
    "catch_torque": 2.0,
    "motion_threshold": 0.25,
}
# Thrust and moment for a unit of command of propellers; their places in the body are CENTRE and its negative.
PROPELLERS = ((3.0, 0.5), (1.25, -0.25))
# Area of a wing, density of what it moves in.
WING = (0.75, 1.25)
# What bodies of one kilogram weigh.
GRAVITY = 9.81


def _moving_point(t: Truth, s: Point, place: Vector = CENTRE) -> tuple[Exact, Exact, Exact]:
    """R, and the place and the velocity of a point of the body along the world's axes."""
    R = turn(t, s.q)
    arm = R @ exact(place)
    return R, s.a + arm, s.v2 + cross(s.v, arm)


def bushing(t: Truth, s: Point) -> Exact:
    """Wrench (force; moment about the body's origin) of a bushing between the world and the body's CENTRE (6).

    Its frame B stands halfway between A and C, and turns half as fast as C. Along B the force is -(K r + D r'), of the
    place r of Co seen from A and its rate seen from B; the torque has the power of -(K x + D x') along the rates of
    roll, pitch, yaw x.
    """
    R, place, velocity = _moving_point(t, s)
    half = turned_by(rotation_vector(R) / 2)
    seen, moving = half.T @ place, half.T @ (velocity - cross(s.v / 2, place))
    force = -half @ (exact(FORCES[0]) * seen + exact(FORCES[1]) * moving)
    rates = of_angles(angles_of(R))
    gimbal = -(exact(TORQUES[0]) * angles_of(R) + exact(TORQUES[1]) * (rates @ s.v))
    return np.concatenate([force, rates.T @ gimbal + cross(place / 2 - s.a, force)])


def _tanh(x: Decimal) -> Decimal:
    half = (-2 * abs(x)).exp()
    return (1 - half) / (1 + half) * (1 if x > 0 else -1)


def _step(width: Decimal, x: Decimal) -> Decimal:
    return _tanh(x / width)


def _doublet(width: Decimal, x: Decimal) -> Decimal:
    return 2 * _step(width, x) * (1 - _step(width, x) ** 2)


def hinge(t: Truth, s: Point) -> Exact:
    """Torque of a door's hinge, and its parts of the angle v[0] and of the rate v[1] (3)."""
    k = {name: Decimal(value) for name, value in HINGE.items()}
    angle, speed = s.v[0], s.v[1]
    width, slow = k["catch_width"] / 2, k["motion_threshold"]
    placed = k["catch_torque"] * _doublet(width, angle - width)
    placed -= k["spring_constant"] * (angle - k["spring_zero_angle_rad"])
    moved = k["dynamic_friction_torque"] * _step(slow, speed) + k["static_friction_torque"] * _doublet(slow, speed)
    moved = -moved - k["viscous_friction"] * speed
    return np.array([placed + moved, placed, moved])


def propellers(t: Truth, s: Point) -> Exact:
    """Force and moment of propellers at CENTRE and -CENTRE, along z of Q in the body, at commands v[0], v[1] (12)."""
    axis = turn(t, s.q) @ turn(t, s.q2)[:, 2]
    return np.concatenate([axis * Decimal(one) * s.v[k] for k, ratios in enumerate(PROPELLERS) for one in ratios])


def wing(place: Vector) -> TruthOf:
    """Force of a flat plate along the axes of Q at a place of the body, in a wind tau, and where it acts (6).

    Lift 2 sin x cos x and drag 2 sin^2 x of the angle x of attack make a force across the plate: with u the velocity
    against the wind of the place, in its plane of x and z, density times area times |u| times its part against z.
    """

    def function(t: Truth, s: Point) -> Exact:
        R, at, velocity = _moving_point(t, s, place)
        axes = R @ turn(t, s.q2)
        speed = axes.T @ (velocity - s.tau)
        size = root(speed[0] ** 2 + speed[2] ** 2) * Decimal(WING[0]) * Decimal(WING[1])
        return np.concatenate([-axes[:, 2] * size * speed[2], at])

    return function


def weights(t: Truth, s: Point) -> Exact:
    """Forces of gravity on bodies of 1 and 2 kg that slide along z, the latter's model without gravity (2)."""
    return np.array([-Decimal(str(GRAVITY)), Decimal(0)])
