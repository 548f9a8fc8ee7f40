"""Guidance and control of attitude in many digits: frames to follow, errors, torques; fields of a planet.

The body B stands at R (of q) and turns at v along its axes; a reference stands at Q (of q2), turns at a, and its
angular velocity changes at tau, along axes before. Attitudes are rows of rotations, errors modified Rodrigues ones.
"""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal

import numpy as np

from ..arithmetic import Exact, arc, cos_sin, cross, exact, normalised, rate, root, vee
from ..derived import TruthOf
from ..dynamics import Point, Truth
from ..geometry.attitudes import of_euler, speeds_of
from ..geometry.poses import AWAY, MOMENTS
from ..geometry.turns import rotation_vector, turn
from .orbits import MU, follow, moving, place

# Gains, the inertia about the mass centre, and an outer torque.
K, P, LIMIT, CUBIC = 3.5, 1.25, 0.5, 0.75
OUTER = (0.25, -0.5, 0.125)
# Dipole and scale height of a planet of radius 1.
DIPOLE, DENSITY, HEIGHT = (0.5, -0.25, 1.0), 2.0, 0.75


def _quarter() -> Exact:
    """A quarter turn."""
    return arc(Decimal(0), Decimal(1))


def mrp_of(R: Exact) -> Exact:
    """Modified Rodrigues parameters (3) within the unit ball of a rotation."""
    r = rotation_vector(R)
    length = root(r @ r)
    if not length:
        return r
    cosine, sine = cos_sin(length / 4)
    return r * (sine / cosine / length)


def tracking(t: Truth, s: Point) -> Exact:
    """Parameters of B against the reference; its angular velocity, the reference's and its rate along B's axes (12)."""
    R, Q = turn(t, s.q), turn(t, s.q2)
    return np.concatenate([mrp_of(Q.T @ R), s.v - R.T @ s.a, R.T @ s.a, R.T @ s.tau])


def following(frame: Callable[[Exact, Exact], Exact]) -> TruthOf:
    """Rows of a frame that follows an orbit, its angular velocity and the rate of that along axes before (15)."""

    def function(t: Truth, s: Point) -> Exact:
        def pull(state: Exact) -> Exact:
            r = state[:3]
            return np.concatenate([state[3:], -Decimal(MU) * r / root(r @ r) ** 3])

        def turning(state: Exact) -> Exact:
            change = rate(lambda at: frame(at[:3], at[3:]), state, pull(state))
            return vee(change @ frame(state[:3], state[3:]).T)

        state = np.concatenate(moving(s, False))
        return np.concatenate(
            [frame(state[:3], state[3:]).reshape(9), turning(state), rate(turning, state, pull(state))]
        )

    return function


def _along_velocity(r: Exact, v: Exact) -> Exact:
    """Axes: across the velocity, along it, along the angular momentum (3, 3)."""
    ahead, up = normalised(v), normalised(cross(r, v))
    return np.stack([cross(ahead, up), ahead, up], axis=1)


def turning_on(t: Truth, s: Point) -> Exact:
    """The same (15) of what is turned against the reference by angles v2 / 4 about z, y, x, which change at v."""
    Q, of = turn(t, s.q2), of_euler("321")
    angles = s.v2 / 4

    def own(x: Exact) -> Exact:
        return of(x) @ speeds_of(of, x) @ s.v

    w = Q @ own(angles)
    change = s.tau + cross(s.a, w) + Q @ rate(own, angles, s.v)
    return np.concatenate([(Q @ of(angles)).reshape(9), s.a + w, change])


def pointing(t: Truth, s: Point) -> Exact:
    """Parameters of B against what has B's x along v2 + AWAY; angular velocities against it and of it (9)."""
    sight = normalised(turn(t, s.q).T @ (s.v2 + exact(AWAY)))
    axis = cross(exact((1.0, 0.0, 0.0)), sight)
    sine = root(axis @ axis)
    cosine, half = cos_sin(arc(sight[0], sine) / 4)
    return np.concatenate([-axis / sine * (half / cosine), 0 * s.v, s.v])


def _errors(t: Truth, s: Point) -> tuple[Exact, ...]:
    """Guidance errors as text states them: parameters v2, angular velocity v against a reference of a, tau."""
    return s.v2, s.v, s.a, s.tau


def feedback(by_reference: bool) -> TruthOf:
    """-K s - P d - L + J (r' - w x r) + x x J w, with w = d + r; x is r, or w (3)."""

    def function(t: Truth, s: Point) -> Exact:
        sigma, d, r, change = _errors(t, s)
        J, w = exact(MOMENTS), d + r
        turned = cross(r if by_reference else w, J @ w)
        return -Decimal(K) * sigma - Decimal(P) * d - exact(OUTER) + J @ (change - cross(w, r)) + turned

    return function


def steering(t: Truth, s: Point) -> Exact:
    """-f(s), f = LIMIT atan((K x + CUBIC x^3) / LIMIT pi / 2) 2 / pi of each, and its rate at d = that (6)."""
    quarter = _quarter()

    def wanted(x: Exact) -> Exact:
        grown = (Decimal(K) * x + Decimal(CUBIC) * x**3) * quarter / Decimal(LIMIT)
        return -Decimal(LIMIT) / quarter * np.array([arc(Decimal(1), one) for one in grown])

    square = s.v2 @ s.v2
    turning = wanted(s.v2)
    change = ((1 - square) * turning + 2 * cross(s.v2, turning) + 2 * s.v2 * (s.v2 @ turning)) / 4
    return np.concatenate([turning, rate(wanted, s.v2, change)])


def dipole(t: Truth, s: Point) -> Exact:
    """Field (3) of DIPOLE: the negative gradient of (m . r) / r^3."""
    r, m = place(s), exact(DIPOLE)
    distance = root(r @ r)
    return (3 * (m @ r) * r / distance**2 - m) / distance**3


def density(t: Truth, s: Point) -> Exact:
    """DENSITY exp(-(r - 1) / HEIGHT) (1)."""
    r = place(s)
    return np.array([Decimal(DENSITY) * ((1 - root(r @ r)) / Decimal(HEIGHT)).exp()])


GUIDANCE: dict[str, tuple[str, TruthOf]] = {
    "guidance_tracking": ("error of attitude and of rate against a reference, the reference's (12)", tracking),
    "guidance_orbit_frame": ("attitude, rate, its rate of the frame outwards, ahead, across (15)", following(follow)),
    "guidance_along_velocity": ("the same of the frame along the velocity (15)", following(_along_velocity)),
    "guidance_turning_on": ("the same of what turns on against a reference (15)", turning_on),
    "guidance_pointing": ("errors against the attitude that points at a place, its rate (9)", pointing),
    "control_feedback": ("torque by the error, the reference's rate in the gyroscopic part (3)", feedback(True)),
    "control_feedback_whole": ("the same with the body's rate there (3)", feedback(False)),
    "control_steering": ("rate that is asked for, and its rate (6)", steering),
    "field_of_a_dipole": ("magnetic field of a dipole (3)", dipole),
    "density_of_air": ("density of an exponential atmosphere (1)", density),
}
