"""Connectors and loads in many digits: what they do to two bodies, and what sensors of a body say.

The first body stands at (R, a) and moves at v, turning at tau along its axes; the second at (Q, tau + BEYOND), moving
at v2 and turning at v. Points of these are at FIRST and SECOND. A force F on the second point and a moment T on the
second body are, of powers of the bodies' velocities before and angular velocities along their axes,

    -F,  -FIRST x R^T F - R^T T,  F,  SECOND x Q^T F + Q^T T                                                       (9)
"""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal
from typing import NamedTuple

import numpy as np

from ..arithmetic import Exact, arc, cos_sin, cross, exact, root
from ..derived import TruthOf
from ..dynamics import Point, Truth
from ..geometry.shapes import BEYOND
from ..geometry.turns import turn

FIRST, SECOND = (0.25, -0.5, 0.125), (-0.375, 0.125, 0.5)
STIFFNESS, DAMPING, REST, FORCE = 3.0, 0.75, 0.625, 0.5
ALONG, LOSSES, OFFSET = (3.0, 1.5, 0.5), (0.75, 0.25, 0.125), (0.25, -0.5, 0.125)
MASSES, PULL = (3.0, 2.0), 1.5
# Friction: the least, what is more at rest, by speed, the speed of its decay, the speed up to which it is made regular.
FRICTION = (0.5, 0.25, 0.125, 0.375, 0.25)
PUSHED, TWISTED = (1.5, -0.5, 0.75), (0.25, 0.5, -0.125)


class _Body(NamedTuple):
    R: Exact
    p: Exact
    v: Exact
    w: Exact
    place: tuple[float, float, float]

    @property
    def point(self) -> Exact:
        return self.p + self.R @ exact(self.place)

    @property
    def rate(self) -> Exact:
        return self.v + self.R @ cross(self.w, exact(self.place))

    def of(self, F: Exact, T: Exact) -> Exact:
        return np.concatenate([F, cross(exact(self.place), self.R.T @ F) + self.R.T @ T])


def _bodies(t: Truth, s: Point) -> tuple[_Body, _Body]:
    first = _Body(turn(t, s.q), s.a, s.v, s.tau, FIRST)
    return first, _Body(turn(t, s.q2), s.tau + exact(BEYOND), s.v2, s.v, SECOND)


def _of(law: Callable[[_Body, _Body], tuple[Exact, Exact]]) -> TruthOf:
    """Forces (12) of eq. (9)."""

    def function(t: Truth, s: Point) -> Exact:
        one, other = _bodies(t, s)
        F, T = law(one, other)
        return np.concatenate([one.of(-F, -T), other.of(F, T)])

    return function


def _line(one: _Body, other: _Body) -> tuple[Exact, Exact, Exact]:
    """Length, unit vector, rate of the length from point to point."""
    apart = other.point - one.point
    length = root(apart @ apart)
    return length, apart / length, (other.rate - one.rate) @ apart / length


def _spring(one: _Body, other: _Body) -> tuple[Exact, Exact]:
    length, u, speed = _line(one, other)
    pull = Decimal(STIFFNESS) * (length - Decimal(REST)) + Decimal(DAMPING) * speed + Decimal(FORCE)
    return -pull * u, 0 * u


def _along_axes(one: _Body, other: _Body) -> tuple[Exact, Exact]:
    apart, speed = other.point - one.point, other.rate - one.rate
    return -exact(ALONG) * (apart - exact(OFFSET)) - exact(LOSSES) * speed, 0 * apart


def _gravity(one: _Body, other: _Body) -> tuple[Exact, Exact]:
    length, u, _ = _line(one, other)
    return -Decimal(PULL * MASSES[0] * MASSES[1]) / length**2 * u, 0 * u


def _pushed(follows: bool) -> TruthOf:
    """A force at the first body's point and a moment (6), along its own axes or axes before."""

    def function(t: Truth, s: Point) -> Exact:
        one, _ = _bodies(t, s)
        turned = (one.R if follows else np.eye(3, dtype=int)) @ np.stack([exact(PUSHED), exact(TWISTED)], axis=1)
        return one.of(turned[:, 0], turned[:, 1])

    return function


def _coordinates(t: Truth, s: Point) -> Exact:
    """Forces (2) of a spring between the coordinates a0, v20 of two masses that move at v0, v1."""
    stretched = s.v2[0] - s.a[0] - Decimal(REST)
    pull = Decimal(STIFFNESS) * stretched + Decimal(DAMPING) * (s.v[1] - s.v[0])
    return np.array([pull, -pull])


def _sensed(t: Truth, s: Point) -> Exact:
    """Position of the first point, its velocity before and along the body; R by rows, w before, w along (24)."""
    one, _ = _bodies(t, s)
    return np.concatenate([one.point, one.rate, one.R.T @ one.rate, one.R.reshape(9), one.R @ one.w, one.w])


def _point(t: Truth, s: Point) -> Exact:
    """Position and velocity of the first point (6)."""
    one, _ = _bodies(t, s)
    return np.concatenate([one.point, one.rate])


def _displaced(t: Truth, s: Point) -> Exact:
    """How far the first point is from where it is in the reference, and the body's angles about x, y, z in turn (6)."""
    one, _ = _bodies(t, s)
    R, level = one.R, root(one.R[0, 0] ** 2 + one.R[0, 1] ** 2)
    angles = np.array([arc(R[2, 2], -R[1, 2]), arc(level, R[0, 2]), arc(R[0, 0], -R[0, 1])])
    return np.concatenate([one.point - exact(FIRST), angles])


def _beams(t: Truth, s: Point) -> Exact:
    """What beams at 0, 30, 60, 90 degrees from x to y of R see of balls of radius 1, 3 away along x and y; else 10."""
    return exact([2.0, 10.0, 10.0, 2.0])


def _stribeck(t: Truth, s: Point) -> Exact:
    """Friction (3) at speeds v: a line within the last speed, beyond it what decays and what grows with speed."""
    least, more, viscous, decay, regular = (Decimal(x) for x in FRICTION)

    def of(x: Exact) -> Exact:
        beyond = abs(x) - regular
        if beyond <= 0:
            return (least + more) * x / regular
        return (least + more * (-beyond / decay).exp() + viscous * beyond).copy_sign(x)

    return np.array([of(x) for x in s.v])


def _regularized(t: Truth, s: Point) -> Exact:
    """Friction (3) at speeds v: cubics to the greatest at the last speed, to the least at twice that, then a line."""
    least, more, viscous, _, regular = (Decimal(x) for x in FRICTION)

    def step(x: Exact, low: Exact, high: Exact) -> Exact:
        return low + (high - low) * x * x * (3 - 2 * x)

    def of(x: Exact) -> Exact:
        size = abs(x)
        if size > 2 * regular:
            return (least + (size - 2 * regular) * viscous).copy_sign(x)
        if size >= regular:
            return step(size / regular - 1, least + more, least).copy_sign(x)
        return step((x + regular) / (2 * regular), -least - more, least + more)

    return np.array([of(x) for x in s.v])


def _von_mises(t: Truth, s: Point) -> Exact:
    """Root of 3/2 of the square of the deviator (1) of the stress with v on the diagonal and a beside it."""
    shear = 2 * (s.a @ s.a)
    mean = sum(s.v) / 3
    return np.array([root((((s.v - mean) @ (s.v - mean)) + shear) * 3 / 2)])


def _smooth(t: Truth, s: Point) -> Exact:
    """A step from -1/2 to 3/2 between -1/4 and 1/2 with half a turn of a cosine, at v; its slopes (6)."""
    values, slopes = [], []
    half = arc(Decimal(-1), Decimal(0))
    for x in s.v:
        part = min(max((x + Decimal("0.25")) / Decimal("0.75"), Decimal(0)), Decimal(1))
        cosine, sine = cos_sin(part * half)
        values.append(Decimal("0.5") - cosine)
        slopes.append(half / Decimal("0.75") * sine if 0 < part < 1 else Decimal(0))
    return np.array([*values, *slopes])


_TWO = "forces on two bodies (12) of"
CONNECTORS: dict[str, tuple[str, TruthOf]] = {
    "connector_spring": (f"{_TWO} a spring and damper from point to point", _of(_spring)),
    "connector_along_axes": (f"{_TWO} springs and dampers along axes before", _of(_along_axes)),
    "connector_gravity": (f"{_TWO} gravity between points", _of(_gravity)),
    "connector_of_coordinates": ("forces on two masses (2) of a spring of their coordinates", _coordinates),
    "load_before": ("forces (6) of a force at a point and a moment, along axes before", _pushed(False)),
    "load_following": ("forces (6) of these along the body's axes", _pushed(True)),
    "body_sensed": ("a point's position and velocity, the body's rotation and angular velocity (24)", _sensed),
    "body_displaced": ("a point's displacement, the body's angles about x, y, z in turn (6)", _displaced),
    "point_sensed": ("a point's position and velocity (6)", _point),
    "friction_stribeck": (f"friction at speeds v (3), of {FRICTION}", _stribeck),
    "friction_regularized": (f"the same with cubics in place of the exponential (3), of {FRICTION}", _regularized),
    "stress_von_mises": ("equivalent stress (1) of v along, a across", _von_mises),
    "smooth_step": ("a step by a cosine and its slope, at v (6)", _smooth),
    "lidar_beams": ("distances that four beams of a sensor turned by R see (4)", _beams),
}
