"""Momenta and the forces that change them, for variational stepping (docs/theory/simulation.md, section 5)."""

from __future__ import annotations

from collections.abc import Sequence

from symofros.expr.derivative import directional
from symofros.expr.edges import ZERO, Edge
from symofros.expr.vector import Vec3
from symofros.mechanics.dynamics.applied.forces import coordinate_rates
from symofros.mechanics.kinematics.links import TreeKinematics


def momentum_rate(kinematics: TreeKinematics, momentum: Sequence[Edge]) -> list[Edge]:
    """The rate of p = M v while the speeds stay as they are: dM/dt v (nv)."""
    return directional(kinematics.g, momentum, coordinate_rates(kinematics))


def coadjoint(kinematics: TreeKinematics, momentum: Sequence[Edge]) -> list[Edge]:
    """Term ad_v^T p of p' (nv): change of the momenta of ball and free joints as their axes turn; zero elsewhere."""
    g = kinematics.g
    rate = [ZERO] * kinematics.nv
    for link in kinematics.tree.links:
        if link.joint.prescribed or not link.joint.traits.quasi_velocities:
            continue
        start, size = link.v
        w = _three(kinematics, [g.input("v", k) for k in range(start + size - 3, start + size)])
        n = _three(kinematics, momentum[start + size - 3 : start + size])
        rate_of_n = n.cross(w)
        if size == 6:
            f = _three(kinematics, momentum[start : start + 3])
            velocity = _three(kinematics, [g.input("v", k) for k in range(start, start + 3)])
            rate_of_n = rate_of_n + f.cross(velocity)
            rate[start : start + 3] = list(f.cross(w))
        rate[start + size - 3 : start + size] = list(rate_of_n)
    return rate


def _three(kinematics: TreeKinematics, edges: Sequence[Edge]) -> Vec3:
    return Vec3(kinematics.g, edges[0], edges[1], edges[2])
