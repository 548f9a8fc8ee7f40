"""Velocities integrated over the mass of composite bodies (docs/theory/linear.md, eqs. 17, 18)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from symofros.expr.edges import ZERO
from symofros.expr.vector import Mat3, Vec3
from symofros.mechanics.dynamics.acceleration import relative_motion
from symofros.mechanics.kinematics.links import TreeKinematics
from symofros.mechanics.spatial.inertia import LinkInertia
from symofros.mechanics.spatial.wrench import LinkMotion
from symofros.mechanics.topology.tree import BASE


@dataclass(frozen=True)
class Flow:
    """Integrals of the velocity V of a composite body over its mass, about Lo, in L (eq. 17).

    Attributes:
        P: Twice the linear momentum, int 2 V dm.
        K: int 2 V r^T dm.
    """

    P: Vec3
    K: Mat3

    def __add__(self, other: Flow) -> Flow:
        return Flow(self.P + other.P, self.K + other.K)

    def about_axes(self) -> Mat3:
        """tr(K) 1 - K."""
        g, K = self.P.g, self.K
        trace = g.add(g.add(K.at(0, 0), K.at(1, 1)), K.at(2, 2))
        return Mat3(g, tuple(g.sub(trace if n % 4 == 0 else ZERO, edge) for n, edge in enumerate(K.entries)))


def origin_velocities(kinematics: TreeKinematics, motions: Sequence[LinkMotion]) -> list[Vec3]:
    """Velocity of each Lo in L, less that of the origin of the first link on the way from the base.

    A velocity that all points have in common drops out of (14), and would only cost digits where it is large.
    """
    velocities: list[Vec3] = []
    for link in kinematics.links:
        if link.parent == BASE:
            velocities.append(Vec3(kinematics.g))
            continue
        carried = velocities[link.parent] + motions[link.parent].w_WL_L.cross(link.p_AL)
        relative = relative_motion(link, [ZERO] * len(link.speeds))
        velocities.append(link.R_AL.apply_inverse(carried) + relative.v)
    return velocities


def composite_flows(
    kinematics: TreeKinematics, inertias: Sequence[LinkInertia], motions: Sequence[LinkMotion], velocities: list[Vec3]
) -> list[Flow]:
    """Flow of the composite body of each link (eq. 18)."""
    flows = own_flows(inertias, motions, velocities)
    for i, link in reversed(list(enumerate(kinematics.links))):
        if link.parent != BASE:
            P = link.R_AL.apply(flows[i].P)
            K = link.R_AL.conjugate_any(flows[i].K) + _dyad(P, link.p_AL)
            flows[link.parent] = flows[link.parent] + Flow(P, K)
    return flows


def own_flows(inertias: Sequence[LinkInertia], motions: Sequence[LinkMotion], velocities: Sequence[Vec3]) -> list[Flow]:
    """Flow of each link by itself (eq. 17)."""
    return [_own_flow(*of_link) for of_link in zip(inertias, motions, velocities, strict=True)]


def _own_flow(inertia: LinkInertia, motion: LinkMotion, velocity: Vec3) -> Flow:
    """Flow of a link by itself; its constants carry the factor two."""
    g, w = velocity.g, motion.w_WL_L
    two = g.constant(2.0)
    m, S, E = g.mul(two, inertia.m), inertia.mp_LLcm.scaled(two), inertia.second_moment().matrix()
    turning = [w.cross(E.column(j).scaled(two)) for j in range(3)]
    return Flow(velocity.scaled(m) + w.cross(S), Mat3.from_columns(g, turning) + _dyad(velocity, S))


def _dyad(a: Vec3, b: Vec3) -> Mat3:
    """A b^T."""
    return Mat3(a.g, tuple(a.g.mul(x, y) for x in a for y in b))
