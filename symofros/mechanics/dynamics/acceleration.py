"""Velocity and acceleration of links, base to tip; the wrench of a link's inertia (docs/theory/rigid.md, section 3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from symofros.expr.edges import ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.vector import Mat3, Sym3, Vec3
from symofros.mechanics.dynamics.bodies.inertia import LinkInertia
from symofros.mechanics.kinematics.links import MovingLink, TreeKinematics
from symofros.mechanics.topology.tree import BASE


@dataclass(frozen=True)
class LinkMotion:
    """Velocity and acceleration of one link.

    Attributes:
        w_WL_L: Angular velocity [rad/s].
        alpha_WL_L: Angular acceleration [rad/s^2].
        a_WLo_L: Acceleration of Lo, with gravity as an acceleration of the base [m/s^2].
        U: U [alpha] + [w][w], the matrix that takes a point's position in L to its acceleration relative to Lo [1/s^2].
        w_squares: The products wx wx, wy wy, wz wz.
    """

    w_WL_L: Vec3
    alpha_WL_L: Vec3
    a_WLo_L: Vec3
    U: Mat3
    w_squares: tuple[Edge, Edge, Edge]


@dataclass(frozen=True)
class Acceleration:
    """Acceleration of a link or a part of it: terms of alpha_WL_L [rad/s^2] and a_WLo_L [m/s^2]."""

    alpha: Vec3
    a: Vec3

    def __add__(self, other: Acceleration) -> Acceleration:
        return Acceleration(self.alpha + other.alpha, self.a + other.a)


@dataclass(frozen=True)
class Wrench:
    """Force and moment on a link, the moment about its origin: f_Lo_L [N] and n_Lo_L [N m]."""

    f: Vec3
    n: Vec3

    def __add__(self, other: Wrench) -> Wrench:
        return Wrench(self.f + other.f, self.n + other.n)


def no_wrench(g: Graph) -> Wrench:
    """Zero wrench."""
    return Wrench(Vec3(g), Vec3(g))


def base_to_tip(kinematics: TreeKinematics, v_rate: Sequence[Edge], gravity: Vec3) -> list[LinkMotion]:
    """Velocity and acceleration of every link (eqs. 6-8)."""
    base = base_motion(gravity)
    motions: list[LinkMotion] = []
    for link in kinematics.links:
        parent = base if link.parent == BASE else motions[link.parent]
        w, alpha, a = _across(link, parent, link.speed_rates(v_rate))
        alpha.named(f"alpha_WL_L[{link.name}]")
        motions.append(_link_motion(w, alpha, a.named(f"a_WLo_L[{link.name}]")))
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
        motions.append(_link_motion(w, zero, zero))
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
    """What the speeds of a joint and their rates make: sums of partial velocities."""
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
    """From the parent's motion to the link's w, alpha, a."""
    relative = relative_motion(link, rates)
    w_WA_L = link.R_AL.apply_inverse(parent.w_WL_L)
    w = (w_WA_L + relative.w).named(f"w_WL_L[{link.name}]")
    alpha = link.R_AL.apply_inverse(parent.alpha_WL_L) + (relative.w_rate + w_WA_L.cross(relative.w))
    a = parent_acceleration(link, parent) + (relative.v_rate + (w_WA_L + w).cross(relative.v))
    return w, alpha, a


def base_motion(gravity: Vec3) -> LinkMotion:
    """Rest, with gravity as an upward acceleration."""
    zero = Vec3(gravity.g)
    return _link_motion(zero, zero, -gravity)


def _link_motion(w: Vec3, alpha: Vec3, a: Vec3) -> LinkMotion:
    return LinkMotion(w, alpha, a, *_relative_acceleration(w, alpha))


def _relative_acceleration(w: Vec3, alpha: Vec3) -> tuple[Mat3, tuple[Edge, Edge, Edge]]:
    """[alpha] + [w][w]."""
    g = w.g
    xx, yy, zz = g.mul(w.x, w.x), g.mul(w.y, w.y), g.mul(w.z, w.z)
    xy, xz, yz = g.mul(w.x, w.y), g.mul(w.x, w.z), g.mul(w.y, w.z)
    U = Mat3(
        g,
        (
            -g.add(yy, zz),
            g.sub(xy, alpha.z),
            g.add(xz, alpha.y),
            g.add(xy, alpha.z),
            -g.add(xx, zz),
            g.sub(yz, alpha.x),
            g.sub(xz, alpha.y),
            g.add(yz, alpha.x),
            -g.add(xx, yy),
        ),
    )
    return U, (xx, yy, zz)


def inertia_wrench(inertia: LinkInertia, motion: LinkMotion) -> Wrench:
    """Force and moment about Lo that the link's acceleration takes (eqs. 9, 10)."""
    f = motion.a_WLo_L.scaled(inertia.m) + motion.U.times(inertia.mp_LLcm)
    n = _moment(inertia.second_moment(), motion) + inertia.mp_LLcm.cross(motion.a_WLo_L)
    return Wrench(f, n)


def _moment(E: Sym3, motion: LinkMotion) -> Vec3:
    """The integral of r x U r dm, with E the integral of r r^T dm (eq. 10)."""
    g, U = E.g, motion.U
    xx, yy, zz = motion.w_squares
    mul, sub = g.mul, g.sub

    def combine(*products: tuple[Edge, Edge]) -> Edge:
        return g.sum(mul(a, b) for a, b in products)

    # U_zz - U_yy is a difference of two squares of w: one subtraction instead of two sums.
    return Vec3(
        g,
        combine((U.at(2, 0), E.xy), (-U.at(1, 0), E.xz), (sub(zz, yy), E.yz), (U.at(2, 1), E.yy), (-U.at(1, 2), E.zz)),
        combine((U.at(0, 1), E.yz), (-U.at(2, 1), E.xy), (sub(xx, zz), E.xz), (U.at(0, 2), E.zz), (-U.at(2, 0), E.xx)),
        combine((U.at(1, 2), E.xz), (-U.at(0, 2), E.yz), (sub(yy, xx), E.xy), (U.at(1, 0), E.xx), (-U.at(0, 1), E.yy)),
    )
