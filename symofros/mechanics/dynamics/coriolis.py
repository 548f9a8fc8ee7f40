"""Coriolis matrix C with C v = h at no gravity and M' = C + C^T (docs/theory/rigid.md, section 13)."""

from __future__ import annotations

from symofros.expr.edges import ZERO
from symofros.expr.substitute import substitute
from symofros.expr.vector import Vec3
from symofros.mechanics.dynamics.bodies.rotors import MovingRotor, is_on_turning_axes
from symofros.mechanics.dynamics.derivatives.differentiation import by_inputs
from symofros.mechanics.dynamics.jourdain import inertia_forces
from symofros.mechanics.dynamics.mass_matrix import Matrix, mass_matrix
from symofros.mechanics.dynamics.momentum import coadjoint
from symofros.mechanics.kinematics.links import TreeKinematics
from symofros.mechanics.spatial.inertia import LinkInertia


def coriolis_matrix(
    kinematics: TreeKinematics, inertias: list[LinkInertia], rotors: list[MovingRotor], M: Matrix
) -> Matrix:
    """C(q, v) (nv x nv) of the speeds v, prescribed motions at rest (55).

    Args:
        kinematics: Kinematics of the tree.
        inertias: Inertia of each link.
        rotors: Rotors that spin in links.
        M: Mass matrix.
    """
    g, nv = kinematics.g, kinematics.nv
    h = inertia_forces(kinematics, inertias, rotors, [ZERO] * nv, Vec3(g))
    prescribed = [link for link in kinematics.links if link.rates is not None]
    at_rest = {edge: ZERO for link in prescribed for edge in (*link.speeds, *(link.rates or ()))}
    others = [rotor for rotor in rotors if not is_on_turning_axes(kinematics, rotor)]
    if len(others) < len(rotors):  # What h does not turn has no part in the bracket.
        M = mass_matrix(kinematics, inertias, others).entries
    slopes = by_inputs(kinematics, substitute(g, h, at_rest), "v", nv)
    half = g.constant(0.5)
    return [
        [g.mul(half, g.add(slope, turning)) for slope, turning in zip(row, coadjoint(kinematics, mass), strict=True)]
        for row, mass in zip(slopes, M, strict=True)
    ]
