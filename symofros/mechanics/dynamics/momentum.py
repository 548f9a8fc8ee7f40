"""Energies (docs/theory/rigid.md, 6), C(q, v) (13 there), momenta and forces that change them (simulation.md, 5)."""

from __future__ import annotations

from collections.abc import Sequence

from symofros.expr.derivative import directional
from symofros.expr.edges import ZERO, Edge
from symofros.expr.substitute import substitute
from symofros.expr.vector import Vec3
from symofros.mechanics.dynamics.applied.forces import coordinate_rates
from symofros.mechanics.dynamics.bodies.rotors import MovingRotor, is_on_turning_axes
from symofros.mechanics.dynamics.derivatives.differentiation import by_inputs
from symofros.mechanics.dynamics.jourdain import inertia_forces
from symofros.mechanics.dynamics.mass_matrix import Matrix, mass_matrix
from symofros.mechanics.kinematics.links import TreeKinematics
from symofros.mechanics.spatial.inertia import LinkInertia
from symofros.mechanics.topology.tree import BASE


def kinetic_energy(kinematics: TreeKinematics, inertias: list[LinkInertia], rotors: list[MovingRotor]) -> Edge:
    """Kinetic energy 1/2 sum (m v.v + 2 v.(w x S) + w.J w), each link about its origin, and rotors (eqs. 24, 35)."""
    g = kinematics.g
    speeds: list[tuple[Vec3, Vec3]] = []
    twice_T = ZERO
    for link, body in zip(kinematics.links, inertias, strict=True):
        w_WA_A, v_WAo_A = (Vec3(g), Vec3(g)) if link.parent == BASE else speeds[link.parent]
        w, v = link.R_AL.apply_inverse(w_WA_A), link.R_AL.apply_inverse(v_WAo_A + w_WA_A.cross(link.p_AL))
        for partial, speed in zip(link.partial_velocities, link.speeds, strict=True):
            w, v = w + partial.w.scaled(speed), v + partial.v.scaled(speed)
        speeds.append((w, v))
        momentum = v.scaled(body.m) + w.cross(body.mp_LLcm) + w.cross(body.mp_LLcm)
        twice_T = g.add(twice_T, g.add(v.dot(momentum), w.dot(body.I_LLo_L.times(w))))
    for beam in kinematics.beams:
        if beam.tip is not None:
            w, v = speeds[beam.root]
            twice_T = g.add(twice_T, beam.equations.kinetic_energy_twice(w, v, kinematics.links[beam.tip].speeds))
    for rotor in rotors:
        spin = rotor.spin(kinematics)
        carrier_spin = ZERO if rotor.carrier == BASE else speeds[rotor.carrier][0].dot(rotor.axis)
        twice_T = g.add(twice_T, g.mul(g.mul(rotor.inertia, spin), g.add(spin, g.add(carrier_spin, carrier_spin))))
    return g.mul(g.constant(0.5), twice_T)


def potential_energy(kinematics: TreeKinematics, inertias: list[LinkInertia], base: LinkInertia, gravity: Vec3) -> Edge:
    """Minus the weight's work, zero for mass at the world origin (eq. 25).

    First moments of everything beyond a joint, about the joint's origin, are shifted from joint to joint to the base.
    """
    g = kinematics.g
    mass = [body.m for body in inertias]
    moment = [body.mp_LLcm for body in inertias]
    for beam in kinematics.beams:
        moment[beam.root] = moment[beam.root] + beam.equations.first_moment_change()
    total = base.mp_LLcm
    for i, link in reversed(list(enumerate(kinematics.links))):
        about_Ao = link.R_AL.apply(moment[i]) + link.p_AL.scaled(mass[i])
        if link.parent == BASE:
            total = total + about_Ao
        else:
            mass[link.parent] = g.add(mass[link.parent], mass[i])
            moment[link.parent] = moment[link.parent] + about_Ao
    return -gravity.dot(total)


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


def coriolis_matrix(
    kinematics: TreeKinematics, inertias: list[LinkInertia], rotors: list[MovingRotor], M: Matrix
) -> Matrix:
    """C(q, v) (nv x nv) of the speeds v, prescribed motions at rest (55)."""
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
