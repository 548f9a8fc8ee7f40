"""Motion of a frame, and the wrench that an inertia takes by it, on the graph (docs/theory/rigid.md, section 3)."""

from __future__ import annotations

from dataclasses import dataclass

from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.expr.vector import Mat3, Sym3, Vec3
from symofros.mechanics.spatial.inertia import LinkInertia


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
class Wrench:
    """Force and moment on a link, the moment about its origin: f_Lo_L [N] and n_Lo_L [N m]."""

    f: Vec3
    n: Vec3

    def __add__(self, other: Wrench) -> Wrench:
        return Wrench(self.f + other.f, self.n + other.n)


def no_wrench(g: Graph) -> Wrench:
    """Zero wrench."""
    return Wrench(Vec3(g), Vec3(g))


def link_motion(w: Vec3, alpha: Vec3, a: Vec3) -> LinkMotion:
    """The motion with an angular velocity, an angular acceleration and an acceleration of Lo, all in L."""
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
