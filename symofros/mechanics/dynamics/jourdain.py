"""Jourdain's principle by recursion: accelerations from base to tip, virtual power from tip to base.

The sum over bodies of (partial velocity) . (inertia force) is formed link by link: the wrench of everything beyond a
joint is accumulated once and projected on the joint's partial velocities (docs/theory/rigid.md, section 3).
"""

from __future__ import annotations

from collections.abc import Sequence

from symofros.expr.edges import ZERO, Edge
from symofros.expr.vector import Vec3
from symofros.mechanics.dynamics.acceleration import LinkMotion, Wrench, base_to_tip, inertia_wrench
from symofros.mechanics.dynamics.bodies.beams import beam_forces
from symofros.mechanics.dynamics.bodies.inertia import LinkInertia
from symofros.mechanics.dynamics.bodies.rotors import MovingRotor
from symofros.mechanics.kinematics.links import TreeKinematics
from symofros.mechanics.topology.tree import BASE


def inertia_forces(
    kinematics: TreeKinematics,
    inertias: list[LinkInertia],
    rotors: list[MovingRotor],
    v_rate: Sequence[Edge],
    gravity: Vec3,
) -> list[Edge]:
    """Generalized inertia force M v' + h, with the weight of all links (eqs. 6-11).

    Args:
        kinematics: Kinematics of the tree.
        inertias: Inertia of each link.
        rotors: Rotors that spin in links.
        v_rate: v' (nv); zeros give the bias h alone.
        gravity: Acceleration of gravity in the world.

    Returns:
        One edge a speed.
    """
    wrenches, direct = link_wrenches(kinematics, inertias, rotors, base_to_tip(kinematics, v_rate, gravity), v_rate)
    return [kinematics.g.add(a, b) for a, b in zip(virtual_power(kinematics, wrenches), direct, strict=True)]


def link_wrenches(
    kinematics: TreeKinematics,
    inertias: list[LinkInertia],
    rotors: list[MovingRotor],
    motions: Sequence[LinkMotion],
    v_rate: Sequence[Edge],
) -> tuple[list[Wrench], list[Edge]]:
    """Wrench of inertia on each link by itself, and the inertia forces that act on speeds directly.

    Args:
        kinematics: Kinematics of the tree.
        inertias: Inertia of each link.
        rotors: Rotors that spin in links.
        motions: Velocity and acceleration of the links.
        v_rate: v' (nv), of elastic coordinates and rotors.

    Returns:
        A wrench a link; and the inertia forces of elastic coordinates and of the spin of rotors (nv).
    """
    g = kinematics.g
    wrenches = [inertia_wrench(body, state) for body, state in zip(inertias, motions, strict=True)]
    total: list[Edge] = [ZERO] * kinematics.nv
    for beam in kinematics.beams:
        if beam.tip is not None:
            tip = kinematics.links[beam.tip]
            deformation, modal = beam_forces(kinematics, beam, motions[beam.root], tip.speeds, tip.speed_rates(v_rate))
            wrenches[beam.root] = wrenches[beam.root] + deformation
            total[tip.first_speed : tip.first_speed + len(modal)] = modal
    for rotor in rotors:
        rate = rotor.rate(kinematics, v_rate)
        spin_rate = g.mul(rotor.ratio, rate)
        if rotor.carrier != BASE:
            state = motions[rotor.carrier]
            n = rotor.axis.scaled(g.mul(rotor.inertia, spin_rate))
            n = n + state.w_WL_L.cross(rotor.axis).scaled(g.mul(rotor.inertia, rotor.spin(kinematics)))
            wrenches[rotor.carrier] = wrenches[rotor.carrier] + Wrench(Vec3(g), n)
            spin_rate = g.add(spin_rate, state.alpha_WL_L.dot(rotor.axis))
        if rotor.k is not None:
            reaction = g.mul(g.mul(rotor.ratio, rotor.inertia), spin_rate)
            total[rotor.k] = g.add(total[rotor.k], reaction)
    return wrenches, total


def virtual_power(kinematics: TreeKinematics, wrenches: Sequence[Wrench]) -> list[Edge]:
    """The virtual power of one wrench a link on every speed: accumulated tip to base, projected once (eqs. 5, 11).

    Args:
        kinematics: Kinematics of the tree.
        wrenches: One wrench a link, about its origin, in its frame.

    Returns:
        One edge a speed.
    """
    g = kinematics.g
    subtree_wrench = list(wrenches)
    total: list[Edge] = [ZERO] * kinematics.nv
    for i, link in reversed(list(enumerate(kinematics.links))):
        f_Lo_L = subtree_wrench[i].f.named(f"f_Lo_L[{link.name}]")
        n_Lo_L = subtree_wrench[i].n.named(f"n_Lo_L[{link.name}]")
        for k, partial in enumerate(link.free_partial_velocities):
            total[link.first_speed + k] = g.add(partial.w.dot(n_Lo_L), partial.v.dot(f_Lo_L))
        if link.parent != BASE:
            f_Lo_A = link.R_AL.apply(f_Lo_L)
            about_Ao = Wrench(f_Lo_A, link.R_AL.apply(n_Lo_L) + link.p_AL.cross(f_Lo_A))
            subtree_wrench[link.parent] = subtree_wrench[link.parent] + about_Ao
    return total
