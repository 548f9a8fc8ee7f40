"""Axes of contact, two along the surface and its normal, and how they turn (docs/theory/constraints.md, section 15)."""

from __future__ import annotations

from typing import NamedTuple

from symofros.expr.edges import ONE, Edge
from symofros.expr.graph import Graph
from symofros.expr.vector import Mat3, Vec3
from symofros.mechanics.kinematics.lowering import Lowering
from symofros.mechanics.topology.rigid_contacts import RigidBall

# What is divided by is at least this, a number of single precision too: the squares of two centres' distance, and of
# a normal's distance from the point opposite to its pole.
TINY = 1e-30


class ContactAxes(NamedTuple):
    """Axes of contact of a rigid ball, in world axes.

    Attributes:
        R_WC: Tangents t_x and t_y, then the normal n, from the surface to the ball: the axes of contact C.
        normal_rate: Rate of n [1/s].
        w_WC_W: Their angular velocity [rad/s].
    """

    R_WC: Mat3
    normal_rate: Vec3
    w_WC_W: Vec3


def fixed_axes(R_WS: Mat3, w_WS_W: Vec3) -> ContactAxes:
    """Those of a plane: the axes of its frame S, which turns by w_WS_W."""
    return ContactAxes(R_WS, w_WS_W.cross(R_WS.column(2)), w_WS_W)


def sphere_normal(g: Graph, d: Vec3, inside: bool) -> tuple[Edge, Vec3]:
    """Distance of the centres, and the normal: along d from the sphere's to the ball's or, inside, against it."""
    size = norm(g, d)
    normal = d.scaled(g.div(ONE, size))
    return size, -normal if inside else normal


def sphere_axes(lowering: Lowering, ball: RigidBall, R_WS: Mat3, w_WS_W: Vec3, d: Vec3, d_rate: Vec3) -> ContactAxes:
    """Those of a sphere: the axes of its frame S, turned the shortest way from its pole to the normal: (38c), (38d).

    Args:
        lowering: Edges of the ball's pole.
        ball: The ball.
        R_WS: Axes of S.
        w_WS_W: Its angular velocity [rad/s].
        d: From the centre of the sphere to that of the ball [m].
        d_rate: Its rate [m/s].
    """
    g, inside = lowering.g, ball.contact.inside
    size, n = sphere_normal(g, d, inside)
    R = tangents(lowering, ball, R_WS, n)
    per_size = g.div(-ONE if inside else ONE, size)
    n_rate = (d_rate - n.scaled(n.dot(d_rate))).scaled(per_size)
    turning = n.cross(n_rate - w_WS_W.cross(n))
    Z, share = _pole(lowering, ball, R_WS, n)
    return ContactAxes(R, n_rate, w_WS_W + turning - n.scaled(g.mul(turning.dot(Z), share)))


def tangents(lowering: Lowering, ball: RigidBall, R_WS: Mat3, n: Vec3) -> Mat3:
    """Axes x and y of S turned the shortest way from the pole of the ball to n, and n: (38c)."""
    g = lowering.g
    Z, share = _pole(lowering, ball, R_WS, n)
    lean = (n + Z).scaled(share)
    return Mat3.from_columns(g, [*(e - lean.scaled(n.dot(e)) for e in (R_WS.column(0), R_WS.column(1))), n])


def _pole(lowering: Lowering, ball: RigidBall, R_WS: Mat3, n: Vec3) -> tuple[Vec3, Edge]:
    """The pole Z, one end of the z axis of S, and 1/(1 + n . Z)."""
    g = lowering.g
    Z = R_WS.column(2).scaled(lowering.symbol(ball.pole))
    return Z, g.div(ONE, g.call("max", g.add(ONE, n.dot(Z)), g.constant(TINY)))


def norm(g: Graph, x: Vec3) -> Edge:
    """Length of a vector, whose derivative exists at zero, too."""
    return g.sqrt(g.call("max", x.dot(x), g.constant(TINY)))
