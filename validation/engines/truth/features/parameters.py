"""What small mechanisms owe to numbers that were set late, or to one model of several, in many digits.

A hinge about z carries a body of unit moments, driven by a rotor of the inertia x[0] behind a gear of the ratio x[1],
with the sizes x = |v| + 1/2. Of two models, "one" is a slide along x that carries a slide along y, "two" a slide along
z; their masses are MASSES, and v, a, tau are their coordinates, speeds and forces in the order x, y, z.
"""

from __future__ import annotations

from decimal import Decimal

import numpy as np

from ...interface import STEP
from ..arithmetic import Exact, exact, solve, zeros
from ..dynamics import Point, Truth
from ..geometry.bodies import sizes
from ..geometry.turns import turn

# Of the slides along x, y, z.
MASSES = (2.0, 3.0, 5.0)
# Where a spring has no force, its stiffness, a damper; ratio and offset of a coupler.
REST, STIFFNESS, DAMPING = 0.25, 40.0, 1.5
COUPLED = (-1.5, 0.25)
# Gravity of the mechanisms' plants along x, y, z.
GRAVITY = (1.0, -2.0, -9.0)
_STEP = Decimal(STEP)


def geared(t: Truth, s: Point) -> Exact:
    """The mass matrix (1): 1 + rotor inertia times the square of the ratio."""
    x = sizes(s)
    return np.array([1 + x[0] * x[1] ** 2])


def geared_acceleration(t: Truth, s: Point) -> Exact:
    """Acceleration (1) under the force tau[0]."""
    return s.tau[:1] / geared(t, s)


def reflected(t: Truth, s: Point) -> Exact:
    """Rotor inertia, ratio, and the former times the square of the latter (3)."""
    x = sizes(s)
    return np.array([x[0], x[1], x[0] * x[1] ** 2])


def parts(t: Truth, s: Point) -> Exact:
    """Coordinates v[:2] of the model "one", v[2] of "two", speeds likewise (6)."""
    return np.concatenate([s.v[:2], s.a[:2], s.v[2:], s.a[2:]])


def _masses() -> Exact:
    return exact(MASSES)


def sums(t: Truth, s: Point) -> Exact:
    """Mass of all and of each model, mass centres of these, of "one" its velocity (13)."""
    x, y, z = _masses()
    one = np.array([s.v[0], s.v[1] * y / (x + y), Decimal(0)])
    two = np.array([Decimal(0), Decimal(0), s.v[2]])
    moving = np.array([s.a[0], s.a[1] * y / (x + y), Decimal(0)])
    whole = (one * (x + y) + two * z) / (x + y + z)
    return np.concatenate([[x + y + z, x + y, z], whole, one, two, moving])


def momenta(t: Truth, s: Point) -> Exact:
    """Linear momentum of "one", its angular one about the point tau (6)."""
    x, y, _ = _masses()
    momentum = np.array([(x + y) * s.a[0], y * s.a[1], Decimal(0)])
    at = ((x, np.array([s.v[0], Decimal(0), Decimal(0)])), (y, np.array([s.v[0], s.v[1], Decimal(0)])))
    speeds = (np.array([s.a[0], Decimal(0), Decimal(0)]), np.array([s.a[0], s.a[1], Decimal(0)]))
    turning = sum(m * np.cross(p - s.tau, u) for (m, p), u in zip(at, speeds, strict=True))
    return np.concatenate([momentum, turning])


def _matrix() -> Exact:
    x, y, z = _masses()
    return np.array([x + y, y, z], dtype=object)


def accelerations(t: Truth, s: Point) -> Exact:
    """Accelerations (3) under the forces tau and gravity, along x, y, z."""
    return s.tau / _matrix() + exact(GRAVITY)


def after_impulse(t: Truth, s: Point) -> Exact:
    """Speeds (3) after the impulses tau."""
    return s.a + s.tau / _matrix()


def set_masses(t: Truth, s: Point) -> Exact:
    """The mass matrix (3, 3) where the masses are x = |v| + 1/2."""
    x = sizes(s)
    return np.diag(np.array([x[0] + x[1], x[1], x[2]], dtype=object)) + zeros(3, 3)


def limits(t: Truth, s: Point) -> Exact:
    """Bounds of slides: coordinates -x and 2 x, speeds -3 x and 4 x, accelerations -5 x and 6 x (6, 3)."""
    return np.outer(exact((-1.0, 2.0, -3.0, 4.0, -5.0, 6.0)), sizes(s))


def damped(t: Truth, s: Point) -> Exact:
    """Forces of dampers of x = |v| + 1/2 at the speeds a (3)."""
    return -sizes(s) * s.a


def lost_power(t: Truth, s: Point) -> Exact:
    """Their power (1)."""
    return np.array([damped(t, s) @ s.a])


def sprung(t: Truth, s: Point) -> Exact:
    """Force and energy of a spring of the stiffness x[0] and the rest x[1], at v[2] (2)."""
    x = sizes(s)
    stretch = s.v[2] - x[1]
    return np.array([-x[0] * stretch, x[0] * stretch**2 / 2])


def anchored(t: Truth, s: Point) -> Exact:
    """Position (3) of a body at v against an anchor at a."""
    return s.v - s.a


def turned_velocity(t: Truth, s: Point) -> Exact:
    """Velocity v and angular velocity a (6), once all is turned by R."""
    R = turn(t, s.q)
    return np.concatenate([R @ s.v, R @ s.a])


def areas(t: Truth, s: Point) -> Exact:
    """Areas (2) of two triangles at right angles, with legs x[0], x[1], and 2 x[0], 3 x[1]."""
    x = sizes(s)
    return x[0] * x[1] * exact((0.5, 3.0))


def _stepped(q: Exact, speed: Exact) -> Exact:
    return np.concatenate([q + _STEP * speed, speed])


def locked(t: Truth, s: Point) -> Exact:
    """After a step: the slide along x carries the other along, which is locked; a third one is free (6)."""
    x, y, z = _masses()
    speed = np.array([s.a[0] + _STEP * s.tau[0] / (x + y), Decimal(0), s.a[2] + _STEP * s.tau[2] / z])
    return _stepped(s.v, speed)


def unlocked(t: Truth, s: Point) -> Exact:
    """After a step of all of them (6)."""
    return _stepped(s.v, s.a + _STEP * s.tau / _matrix())


def goal_of_locked(t: Truth, s: Point) -> Exact:
    """Coordinates of two slides, of which the second is locked at v[1] and the first has its goal (2)."""
    return np.array([s.a[0] / (1 + abs(s.a[0])), s.v[1]])


def _apart(s: Point) -> Exact:
    """Places of two slides along x: |v[0]| + 1 apart (2)."""
    return np.array([s.v[2], s.v[2] + abs(s.v[0]) + 1])


def _ends() -> Exact:
    return np.array([_masses()[0], _masses()[2]])


def held_distance(t: Truth, s: Point) -> Exact:
    """After a step: two slides along x that a spring of STIFFNESS and DAMPING holds at the distance REST (4).

    M (u+ - u) = h (tau + n (k (x - rest + h x'+) + d x'+)) with the distance x, its rate x' = -n u, n = (1, -1).
    """
    stiffness, damping = Decimal(STIFFNESS), Decimal(DAMPING)
    places, n = _apart(s), exact((1.0, -1.0))
    mass = np.diag(_ends()) + _STEP * (damping + _STEP * stiffness) * np.outer(n, n)
    push = n * stiffness * (places[1] - places[0] - Decimal(REST))
    return _stepped(places, solve(mass, _ends() * s.a[[0, 2]] + _STEP * (s.tau[[0, 2]] + push)))


def free_distance(t: Truth, s: Point) -> Exact:
    """The same where nothing holds them (4)."""
    return _stepped(_apart(s), s.a[[0, 2]] + _STEP * s.tau[[0, 2]] / _ends())


def coupled(t: Truth, s: Point) -> Exact:
    """Speeds after a step of slides along x and z, the first of which follows the second by a ratio (2)."""
    ratio, (x, _, z) = Decimal(COUPLED[0]), _masses()
    speed = s.a[2] + _STEP * (ratio * s.tau[0] + s.tau[2]) / (ratio**2 * x + z)
    return np.array([ratio * speed, speed])
