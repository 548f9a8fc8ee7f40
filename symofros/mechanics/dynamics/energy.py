"""Kinetic and potential energy (docs/theory/rigid.md, section 6)."""

from __future__ import annotations

from symofros.expr.edges import ZERO, Edge
from symofros.expr.vector import Vec3
from symofros.mechanics.dynamics.bodies.rotors import MovingRotor
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
