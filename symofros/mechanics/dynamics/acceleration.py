"""Motion of links, base to tip, and the wrench that a link's inertia takes (docs/theory/rigid.md, section 3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from symofros.expr.edges import ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.vector import Mat3, Sym3, Vec3
from symofros.mechanics.dynamics.inertia import LinkInertia
from symofros.mechanics.kinematics.links import Motion, MovingLink
from symofros.mechanics.topology.tree import BASE


@dataclass(frozen=True)
class LinkMotion:
    """Velocity and acceleration of one link.

    Attributes:
        w: w_WL_L.
        alpha: alpha_WL_L.
        a: a_WLo_L, with gravity as an acceleration of the base.
        U: [alpha] + [w][w], the matrix that takes a point's position to its relative acceleration.
        ww: The products wx wx, wy wy, wz wz.
    """

    w: Vec3
    alpha: Vec3
    a: Vec3
    U: Mat3
    ww: tuple[Edge, Edge, Edge]


@dataclass(frozen=True)
class Acceleration:
    """Of a link: alpha and a, or a part of them, in the link frame."""

    alpha: Vec3
    a: Vec3

    def __add__(self, other: Acceleration) -> Acceleration:
        return Acceleration(self.alpha + other.alpha, self.a + other.a)


@dataclass(frozen=True)
class Wrench:
    """Force and moment about a link's origin, in the link frame."""

    f: Vec3
    n: Vec3

    def __add__(self, other: Wrench) -> Wrench:
        return Wrench(self.f + other.f, self.n + other.n)


def no_wrench(g: Graph) -> Wrench:
    """The wrench of nothing."""
    return Wrench(Vec3(g), Vec3(g))


def base_to_tip(motion: Motion, v_rate: Sequence[Edge], gravity: Vec3) -> list[LinkMotion]:
    """Velocity and acceleration of every link (eqs. 6-8)."""
    g = motion.g
    base = _moving(Vec3(g), Vec3(g), -gravity)
    moving: list[LinkMotion] = []
    for link in motion.links:
        parent = base if link.parent == BASE else moving[link.parent]
        w, alpha, a = _across(g, link, parent, link.rates_given(v_rate))
        alpha.named(f"alpha_WL_L[{link.name}]")
        moving.append(_moving(w, alpha, a.named(f"a_WLo_L[{link.name}]")))
    return moving


def velocities(motion: Motion) -> tuple[list[LinkMotion], list[Acceleration]]:
    """What speeds alone make of the motion.

    Returns:
        Each link with its velocity, as if it did not accelerate; and what its joint adds to the acceleration of its
        parent (eqs. 7, 8) at v' = 0, or at the given rates of a prescribed motion.
    """
    g, still = motion.g, Vec3(motion.g)
    base = _moving(still, still, still)
    moving: list[LinkMotion] = []
    added: list[Acceleration] = []
    for link in motion.links:
        parent = base if link.parent == BASE else moving[link.parent]
        w, alpha, a = _across(g, link, parent, link.rates_given([ZERO] * motion.nv))
        moving.append(_moving(w, still, still))
        added.append(Acceleration(alpha, a))
    return moving, added


def _across(g: Graph, link: MovingLink, parent: LinkMotion, rates: Sequence[Edge]) -> tuple[Vec3, Vec3, Vec3]:
    """From the parent's motion to the link's w, alpha, a."""
    w_AL, v_AL, w_rate, v_rel_rate = Vec3(g), Vec3(g), Vec3(g), Vec3(g)
    for column, speed, rate in zip(link.columns, link.speeds, rates, strict=True):
        w_AL, v_AL = w_AL + column.w.scaled(speed), v_AL + column.v.scaled(speed)
        w_rate = w_rate + (column.w.scaled(rate) + column.w_rate.scaled(speed))
        v_rel_rate = v_rel_rate + (column.v.scaled(rate) + column.v_rate.scaled(speed))
    w_WA = link.R_AL.apply_inverse(parent.w)
    w = (w_WA + w_AL).named(f"w_WL_L[{link.name}]")
    alpha = link.R_AL.apply_inverse(parent.alpha) + (w_rate + w_WA.cross(w_AL))
    a = link.R_AL.apply_inverse(parent.a + parent.U.times(link.p_AL)) + (v_rel_rate + (w_WA + w).cross(v_AL))
    return w, alpha, a


def _moving(w: Vec3, alpha: Vec3, a: Vec3) -> LinkMotion:
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


def inertia_wrench(body: LinkInertia, moving: LinkMotion) -> Wrench:
    """Force and moment about Lo that the link's acceleration takes (eqs. 9, 10)."""
    f = moving.a.scaled(body.m) + moving.U.times(body.S)
    n = _moment(body.second_moment(), moving) + body.S.cross(moving.a)
    return Wrench(f, n)


def _moment(E: Sym3, moving: LinkMotion) -> Vec3:
    """The integral of r x U r dm, with E the integral of r r^T dm (eq. 10)."""
    g, U = E.g, moving.U
    xx, yy, zz = moving.ww
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
