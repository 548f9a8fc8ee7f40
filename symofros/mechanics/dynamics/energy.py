"""Kinetic and potential energy (docs/theory/rigid.md, section 6)."""

from __future__ import annotations

from symofros.expr.edges import ZERO, Edge
from symofros.expr.vector import Vec3
from symofros.mechanics.dynamics.beams import kinetic_energy_twice
from symofros.mechanics.dynamics.inertia import LinkInertia, first_moment_change
from symofros.mechanics.dynamics.rotors import MovingRotor
from symofros.mechanics.kinematics.links import Motion
from symofros.mechanics.topology.tree import BASE


def kinetic_energy(motion: Motion, inertias: list[LinkInertia], rotors: list[MovingRotor]) -> Edge:
    """1/2 sum (m v.v + 2 v.(w x S) + w.J w), each link about its own origin, and the rotors' (eqs. 24, 35)."""
    g = motion.g
    speeds: list[tuple[Vec3, Vec3]] = []
    twice = ZERO
    for link, body in zip(motion.links, inertias, strict=True):
        w_A, v_A = (Vec3(g), Vec3(g)) if link.parent == BASE else speeds[link.parent]
        w, v = link.R_AL.apply_inverse(w_A), link.R_AL.apply_inverse(v_A + w_A.cross(link.p_AL))
        for column, speed in zip(link.columns, link.speeds, strict=True):
            w, v = w + column.w.scaled(speed), v + column.v.scaled(speed)
        speeds.append((w, v))
        momentum = v.scaled(body.m) + w.cross(body.S) + w.cross(body.S)
        twice = g.add(twice, g.add(v.dot(momentum), w.dot(body.J.times(w))))
    for beam in motion.beams:
        if beam.tip is not None:
            w, v = speeds[beam.root]
            twice = g.add(twice, kinetic_energy_twice(motion, beam, w, v, motion.links[beam.tip].speeds))
    for rotor in rotors:
        spin = rotor.spin(motion)
        turning = ZERO if rotor.carrier == BASE else speeds[rotor.carrier][0].dot(rotor.axis)
        twice = g.add(twice, g.mul(g.mul(rotor.inertia, spin), g.add(spin, g.add(turning, turning))))
    return g.mul(g.constant(0.5), twice)


def potential_energy(motion: Motion, inertias: list[LinkInertia], base: LinkInertia, gravity: Vec3) -> Edge:
    """Minus the weight's work, zero for mass at the world origin (eq. 25).

    First moments are carried to the base: those of everything beyond a joint, about the joint's origin.
    """
    g = motion.g
    mass = [body.m for body in inertias]
    moment = [body.S for body in inertias]
    for beam in motion.beams:
        moment[beam.root] = moment[beam.root] + first_moment_change(motion, beam)
    total = base.S
    for i, link in reversed(list(enumerate(motion.links))):
        carried = link.R_AL.apply(moment[i]) + link.p_AL.scaled(mass[i])
        if link.parent == BASE:
            total = total + carried
        else:
            mass[link.parent] = g.add(mass[link.parent], mass[i])
            moment[link.parent] = moment[link.parent] + carried
    return -gravity.dot(total)
