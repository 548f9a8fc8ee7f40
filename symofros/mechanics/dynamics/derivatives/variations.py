"""Change of motion beyond a joint per unit of its coordinates and speeds (docs/theory/linear.md, section 7)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from symofros.expr.derivative import along, partials
from symofros.expr.edges import Edge
from symofros.expr.vector import Vec3
from symofros.mechanics.dynamics.acceleration import parent_acceleration, relative_motion
from symofros.mechanics.dynamics.mass_matrix import Matrix
from symofros.mechanics.kinematics.links import MovingLink
from symofros.mechanics.spatial.wrench import LinkMotion, Wrench


@dataclass(frozen=True)
class Variation:
    """Change of motion per unit of one coordinate or speed, in the link of its joint (eq. 14).

    A point of the link or beyond, at r from Lo and of velocity V, accelerates by a + alpha x r + 2 w x V.

    Attributes:
        w: Change of the angular velocity.
        alpha: Change of the angular acceleration, less what 2 w x V has of it.
        a: Change of the acceleration of Lo, less what 2 w x V has of it.
    """

    w: Vec3
    alpha: Vec3
    a: Vec3


class JointVariations:
    """Variations of the joint of one link (eqs. 15, 16).

    Args:
        link: The link.
        directions: Rates of coordinates per unit of each speed (nv).
        parent: Motion of the parent.
        motion: Motion of the link.
        velocity: Velocity of Lo in L.
        v_rate: v' (nv).
    """

    def __init__(
        self,
        link: MovingLink,
        directions: Sequence[Mapping[Edge, Edge]],
        parent: LinkMotion,
        motion: LinkMotion,
        velocity: Vec3,
        v_rate: Sequence[Edge],
    ) -> None:
        g = self._g = velocity.g
        self._link, self._motion, self._velocity = link, motion, velocity
        self._w_WA_L = link.R_AL.apply_inverse(parent.w_WL_L)
        self._alpha_WA_L = link.R_AL.apply_inverse(parent.alpha_WL_L)
        self._parent_acceleration = parent_acceleration(link, parent)
        r = self._relative = relative_motion(link, link.speed_rates(v_rate))
        count = len(link.free_partial_velocities)
        own = directions[link.first_speed : link.first_speed + count]
        vectors = [r.w, r.v, r.w_rate, r.v_rate]
        vectors += [x for partial in link.partial_velocities for x in (partial.w, partial.v)]
        self._by_q = along(g, [edge for x in vectors for edge in x], own)
        self._rates_by_v = partials(g, [*r.w_rate, *r.v_rate], link.speeds[:count])

    def by_coordinate(self, k: int) -> Variation:
        """Variation of the motion per unit displacement along speed k, at constant speeds (eq. 15)."""
        partial, r, w_WA_L = self._link.partial_velocities[k], self._relative, self._w_WA_L
        dw, dv, dw_rate, dv_rate = (self._column(self._by_q, at, k) for at in range(4))
        turned = w_WA_L.cross(partial.w)
        w = turned + dw
        alpha = self._relative_acceleration(partial.w) + (dw_rate + w_WA_L.cross(dw) + self._motion.w_WL_L.cross(dw))
        a = self._parent_acceleration.cross(partial.w) + self._relative_acceleration(partial.v)
        a = a + ((turned + w).cross(r.v) + dv_rate + (w_WA_L + self._motion.w_WL_L).cross(dv))
        return self._less_velocity(w, alpha, a)

    def by_speed(self, k: int) -> Variation:
        """Variation of the motion per unit of speed k, at constant rates of all speeds (eq. 16)."""
        partial, r, w_WA_L, w = self._link.partial_velocities[k], self._relative, self._w_WA_L, self._motion.w_WL_L
        dw_rate, dv_rate = (self._column(self._rates_by_v, at, k) for at in range(2))
        alpha = (w_WA_L + w).cross(partial.w) + dw_rate
        a = partial.w.cross(r.v) + dv_rate + (w_WA_L + w).cross(partial.v)
        return self._less_velocity(partial.w, alpha, a)

    def power_change(self, j: int, k: int, wrench: Wrench) -> Edge:
        """Virtual power of a wrench on the change of the partial velocity of speed j by the motion of speed k."""
        dw, dv = (self._column(self._by_q, 4 + 2 * j + at, k) for at in range(2))
        return self._g.add(dw.dot(wrench.n), dv.dot(wrench.f))

    def _less_velocity(self, w: Vec3, alpha: Vec3, a: Vec3) -> Variation:
        """The variation whose field has 2 w x V for 2 w x (V - V_Lo)."""
        return Variation(w, alpha, a - w.cross(self._velocity + self._velocity))

    def _relative_acceleration(self, x: Vec3) -> Vec3:
        """[alpha_A] x + w_A x (w_A x x); of a vector along the only axis that the joint turns about, U x."""
        r = self._relative
        if r.w.cross(x).is_zero and r.w_rate.cross(x).is_zero:
            return self._motion.U.times(x)
        return self._alpha_WA_L.cross(x) + self._w_WA_L.cross(self._w_WA_L.cross(x))

    def _column(self, rows: Matrix, at: int, k: int) -> Vec3:
        return Vec3(self._g, *(row[k] for row in rows[3 * at : 3 * at + 3]))
