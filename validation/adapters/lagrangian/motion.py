"""Frames in motion for the Lagrangian engine, and states left by a small displacement.

Where speeds are not rates of coordinates (ball and free joints), a state is left by a displacement e along the speeds,

    turn by the quaternion (e/2, sqrt(1 - e.e/4)),   shift by x + e x x / 2   (x: the linear part)            (1)

which follows the motion at constant speeds to second order. Lagrange's equations take no more than second derivatives,
so at e = 0 those in e are those in our speeds: e' = v, e'' = v'. Away from e = 0, v = T(e) e' with T' u = -1/2 v x u,
the cross product of motions, which the rates of Jacobians need.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

import casadi as ca

from .beam import SX

Manifold = Literal["flat", "ball", "free"]


class Pose(NamedTuple):
    """A frame in the world, and its rates."""

    p: SX
    R: SX
    dp: SX
    dR: SX

    def carried(self, p: SX, R: SX, dp: SX, dR: SX) -> Pose:
        """A frame placed in this one, which moves there with the rates dp, dR."""
        return Pose(self.p + self.R @ p, self.R @ R, self.dp + self.dR @ p + self.R @ dp, self.dR @ R + self.R @ dR)

    def place(self, p: SX, dp: SX) -> tuple[SX, SX]:
        """Places in this frame (3, n), in the world, and their velocities."""
        n = p.shape[1]
        return ca.repmat(self.p, 1, n) + self.R @ p, ca.repmat(self.dp, 1, n) + self.dR @ p + self.R @ dp

    def spin(self) -> SX:
        """Angular velocity along the frame's axes."""
        W = self.R.T @ self.dR
        return ca.vertcat(W[2, 1], W[0, 2], W[1, 0])


GROUND = Pose(ca.SX.zeros(3), ca.SX.eye(3), ca.SX.zeros(3), ca.SX.zeros(3, 3))


def displaced(manifold: Manifold, q: SX, e: SX) -> SX:
    """Coordinates after a displacement along the speeds (1)."""
    if manifold == "flat":
        return q + e
    if manifold == "ball":
        half = e / 2
        turn, scalar = half, ca.sqrt(1 - ca.sumsqr(half))
        vector = q[3] * turn + scalar * q[:3] + ca.cross(q[:3], turn)
        return ca.vertcat(vector, q[3] * scalar - ca.dot(q[:3], turn))
    shift = e[:3] + ca.cross(e[3:], e[:3]) / 2
    return ca.vertcat(q[:3] + quaternion_rotation(q[3:]) @ shift, displaced("ball", q[3:], e[3:]))


def quaternion_rotation(quaternion: SX) -> SX:
    """R of a unit quaternion (x, y, z, w)."""
    K = ca.skew(quaternion[:3])
    return ca.SX.eye(3) + 2 * quaternion[3] * K + 2 * (K @ K)
