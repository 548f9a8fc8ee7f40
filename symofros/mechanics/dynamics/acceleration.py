"""Velocity and acceleration of links, base to tip; the wrench of a link's inertia (docs/theory/rigid.md, section 3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from symofros.expr.edges import ZERO, Edge
from symofros.expr.vector import Vec3
from symofros.mechanics.kinematics.links import MovingLink, TreeKinematics
from symofros.mechanics.spatial.wrench import LinkMotion, link_motion
from symofros.mechanics.topology.tree import BASE


@dataclass(frozen=True)
class Acceleration:
    """Acceleration of a link or a part of it: terms of alpha_WL_L [rad/s^2] and a_WLo_L [m/s^2]."""

    alpha: Vec3
    a: Vec3

    def __add__(self, other: Acceleration) -> Acceleration:
        return Acceleration(self.alpha + other.alpha, self.a + other.a)


def base_to_tip(kinematics: TreeKinematics, v_rate: Sequence[Edge], gravity: Vec3) -> list[LinkMotion]:
    """Velocity and acceleration of every link (eqs. 6-8)."""
    base = base_motion(gravity)
    motions: list[LinkMotion] = []
    for link in kinematics.links:
        parent = base if link.parent == BASE else motions[link.parent]
        w, alpha, a = _across(link, parent, link.speed_rates(v_rate))
        alpha.named(f"alpha_WL_L[{link.name}]")
        motions.append(link_motion(w, alpha, a.named(f"a_WLo_L[{link.name}]")))
    return motions


def velocities(kinematics: TreeKinematics) -> tuple[list[LinkMotion], list[Acceleration]]:
    """The part of the motion that speeds alone determine.

    Returns:
        Each link with its velocity and no acceleration; and the bias acceleration of each joint: what it adds to the
        acceleration of its parent (eqs. 7, 8) at v' = 0, or at the stated rates of a prescribed motion.
    """
    zero = Vec3(kinematics.g)
    base = base_motion(zero)
    motions: list[LinkMotion] = []
    biases: list[Acceleration] = []
    for link in kinematics.links:
        parent = base if link.parent == BASE else motions[link.parent]
        w, alpha, a = _across(link, parent, link.speed_rates([ZERO] * kinematics.nv))
        motions.append(link_motion(w, zero, zero))
        biases.append(Acceleration(alpha, a))
    return motions, biases


@dataclass(frozen=True)
class RelativeMotion:
    """Velocity of a link in its parent A, in L: w_AL_L [rad/s], v_ALo_L [m/s], and the rates of their components."""

    w: Vec3
    v: Vec3
    w_rate: Vec3
    v_rate: Vec3


def relative_motion(link: MovingLink, rates: Sequence[Edge]) -> RelativeMotion:
    """Relative velocity and acceleration at a joint, from its speeds and their rates: sums of partial velocities."""
    g = link.p_AL.g
    w, v, w_rate, v_rate = Vec3(g), Vec3(g), Vec3(g), Vec3(g)
    for partial, speed, rate in zip(link.partial_velocities, link.speeds, rates, strict=True):
        w, v = w + partial.w.scaled(speed), v + partial.v.scaled(speed)
        w_rate = w_rate + (partial.w.scaled(rate) + partial.w_rate.scaled(speed))
        v_rate = v_rate + (partial.v.scaled(rate) + partial.v_rate.scaled(speed))
    return RelativeMotion(w, v, w_rate, v_rate)


def parent_acceleration(link: MovingLink, parent: LinkMotion) -> Vec3:
    """Acceleration of the point of A where Lo is, in L."""
    return link.R_AL.apply_inverse(parent.a_WLo_L + parent.U.times(link.p_AL))


def _across(link: MovingLink, parent: LinkMotion, rates: Sequence[Edge]) -> tuple[Vec3, Vec3, Vec3]:
    """The link's w, alpha and a, propagated across the joint from those of the parent."""
    relative = relative_motion(link, rates)
    w_WA_L = link.R_AL.apply_inverse(parent.w_WL_L)
    w = (w_WA_L + relative.w).named(f"w_WL_L[{link.name}]")
    alpha = link.R_AL.apply_inverse(parent.alpha_WL_L) + (relative.w_rate + w_WA_L.cross(relative.w))
    a = parent_acceleration(link, parent) + (relative.v_rate + (w_WA_L + w).cross(relative.v))
    return w, alpha, a


def base_motion(gravity: Vec3) -> LinkMotion:
    """Rest, with gravity as an upward acceleration."""
    zero = Vec3(gravity.g)
    return link_motion(zero, zero, -gravity)
