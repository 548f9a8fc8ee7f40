"""Jourdain's principle by recursion: accelerations from base to tip, virtual power from tip to base.

The sum over bodies of (partial velocity) . (inertia force) is formed link by link: the wrench of everything beyond a
joint is accumulated once and projected on the joint's partial velocities (docs/theory/rigid.md, section 3).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from symofros.dynamics.inertia import LinkInertia
from symofros.expr.graph import ZERO, Edge, Graph
from symofros.expr.vector import Mat3, Sym3, Vec3
from symofros.kinematics.links import Motion, MovingLink
from symofros.topology.tree import BASE


@dataclass(frozen=True)
class LinkMotion:
    """Velocity and acceleration of one link.

    Attributes:
        w: w_WL_L.
        a: a_WLo_L, with gravity as an acceleration of the base.
        U: [alpha] + [w][w], the matrix that takes a point's position to its relative acceleration.
        ww: The products wx wx, wy wy, wz wz.
    """

    w: Vec3
    a: Vec3
    U: Mat3
    ww: tuple[Edge, Edge, Edge]


def inertia_forces(motion: Motion, inertias: list[LinkInertia], v_rate: Sequence[Edge], gravity: Vec3) -> list[Edge]:
    """M v' + h: what the inertia and the weight of all links ask of each speed (eqs. 6-11).

    Args:
        motion: The tree.
        inertias: Of its links.
        v_rate: v' (nv); zeros give the bias h alone.
        gravity: Acceleration of gravity in the world.

    Returns:
        One edge a speed.
    """
    moving = _base_to_tip(motion, v_rate, gravity)
    force = [Vec3(motion.g)] * len(motion.links)
    moment = [Vec3(motion.g)] * len(motion.links)
    total: list[Edge] = [ZERO] * motion.nv
    for i, link in reversed(list(enumerate(motion.links))):
        f_own, n_own = _wrench(inertias[i], moving[i])
        f, n = (force[i] + f_own).named(f"f[{link.name}]"), (moment[i] + n_own).named(f"n[{link.name}]")
        for k, column in enumerate(link.columns):
            total[link.v + k] = motion.g.add(column.w.dot(n), column.v.dot(f))
        if link.parent != BASE:
            f_A = link.R_AL.apply(f)
            force[link.parent] = force[link.parent] + f_A
            moment[link.parent] = moment[link.parent] + (link.R_AL.apply(n) + link.p_AL.cross(f_A))
    return total


def _base_to_tip(motion: Motion, v_rate: Sequence[Edge], gravity: Vec3) -> list[LinkMotion]:
    g = motion.g
    still = Vec3(g)
    base = LinkMotion(still, -gravity, Mat3(g, (ZERO,) * 9), (ZERO,) * 3)
    moving: list[LinkMotion] = []
    alphas: list[Vec3] = []
    for link in motion.links:
        parent, alpha_A = (base, still) if link.parent == BASE else (moving[link.parent], alphas[link.parent])
        state, alpha = _across(g, link, parent, alpha_A, v_rate)
        moving.append(state)
        alphas.append(alpha)
    return moving


def _across(
    g: Graph, link: MovingLink, parent: LinkMotion, alpha_A: Vec3, v_rate: Sequence[Edge]
) -> tuple[LinkMotion, Vec3]:
    """From the parent's motion to the link's (eqs. 6-8)."""
    w_AL, v_AL, w_rate, v_rel_rate = Vec3(g), Vec3(g), Vec3(g), Vec3(g)
    for k, column in enumerate(link.columns):
        speed, rate = g.input("v", link.v + k), v_rate[link.v + k]
        w_AL, v_AL = w_AL + column.w.scaled(speed), v_AL + column.v.scaled(speed)
        w_rate = w_rate + (column.w.scaled(rate) + column.w_rate.scaled(speed))
        v_rel_rate = v_rel_rate + (column.v.scaled(rate) + column.v_rate.scaled(speed))
    w_WA = link.R_AL.apply_inverse(parent.w)
    w = (w_WA + w_AL).named(f"w_WL_L[{link.name}]")
    alpha = link.R_AL.apply_inverse(alpha_A) + (w_rate + w_WA.cross(w_AL))
    alpha.named(f"alpha_WL_L[{link.name}]")
    a = link.R_AL.apply_inverse(parent.a + parent.U.times(link.p_AL)) + (v_rel_rate + (w_WA + w).cross(v_AL))
    a.named(f"a_WLo_L[{link.name}]")
    U, ww = _relative_acceleration(w, alpha)
    return LinkMotion(w, a, U, ww), alpha


def _relative_acceleration(w: Vec3, alpha: Vec3) -> tuple[Mat3, tuple[Edge, Edge, Edge]]:
    """[alpha] + [w][w]."""
    g = w.g
    xx, yy, zz = g.mul(w.x, w.x), g.mul(w.y, w.y), g.mul(w.z, w.z)
    xy, xz, yz = g.mul(w.x, w.y), g.mul(w.x, w.z), g.mul(w.y, w.z)
    U = Mat3(g, (
        -g.add(yy, zz), g.sub(xy, alpha.z), g.add(xz, alpha.y),
        g.add(xy, alpha.z), -g.add(xx, zz), g.sub(yz, alpha.x),
        g.sub(xz, alpha.y), g.add(yz, alpha.x), -g.add(xx, yy),
    ))  # fmt: skip
    return U, (xx, yy, zz)


def _wrench(body: LinkInertia, moving: LinkMotion) -> tuple[Vec3, Vec3]:
    """Force and moment about Lo that the link's acceleration takes (eqs. 9, 10)."""
    f = moving.a.scaled(body.m) + moving.U.times(body.S)
    n = _moment(body.second_moment(), moving) + body.S.cross(moving.a)
    return f, n


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
