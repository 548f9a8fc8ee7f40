"""Jourdain's principle by recursion: accelerations from base to tip, virtual power from tip to base.

The sum over bodies of (partial velocity) . (inertia force) is formed link by link: the wrench of everything beyond a
joint is accumulated once and projected on the joint's partial velocities (docs/theory/rigid.md, section 3).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from symofros.expr.edges import ZERO, Edge
from symofros.expr.vector import Vec3
from symofros.mechanics.dynamics.acceleration import base_to_tip
from symofros.mechanics.dynamics.bodies.rotors import MovingRotor
from symofros.mechanics.kinematics.links import MovingLink, TreeKinematics
from symofros.mechanics.spatial.across import PartialVelocity
from symofros.mechanics.spatial.inertia import LinkInertia
from symofros.mechanics.spatial.wrench import LinkMotion, Wrench, inertia_wrench
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
    for k in kinematics.states:
        total[k] = v_rate[k]
    for beam in kinematics.beams:
        if beam.tip is not None:
            tip = kinematics.links[beam.tip]
            rates = tip.speed_rates(v_rate)
            deformation, modal = beam.equations.inertia_forces(motions[beam.root], tip.speeds, rates)
            wrenches[beam.root] = wrenches[beam.root] + deformation
            total[tip.first_speed : tip.first_speed + len(modal)] = modal
    for rotor in rotors:
        spin_rate = g.mul(rotor.ratio, rotor.rate(kinematics, v_rate))
        if rotor.carrier != BASE:
            state = motions[rotor.carrier]
            n = rotor.axis.scaled(g.mul(rotor.inertia, spin_rate))
            n = n + state.w_WL_L.cross(rotor.axis).scaled(g.mul(rotor.inertia, rotor.spin(kinematics)))
            wrenches[rotor.carrier] = wrenches[rotor.carrier] + Wrench(Vec3(g), n)
        if rotor.k is not None:
            total[rotor.k] = g.add(total[rotor.k], spin_effort(kinematics, rotor, motions, v_rate))
    return wrenches, total


def spin_effort(
    kinematics: TreeKinematics, rotor: MovingRotor, motions: Sequence[LinkMotion], v_rate: Sequence[Edge]
) -> Edge:
    """Inertia force of a rotor's spin on the speed that drives it (eq. 37)."""
    g = kinematics.g
    rate = g.mul(rotor.ratio, rotor.rate(kinematics, v_rate))
    if rotor.carrier != BASE:
        rate = g.add(rate, motions[rotor.carrier].alpha_WL_L.dot(rotor.axis))
    return g.mul(g.mul(rotor.ratio, rotor.inertia), rate)


def virtual_power(kinematics: TreeKinematics, wrenches: Sequence[Wrench]) -> list[Edge]:
    """The virtual power of one wrench a link on every speed: accumulated tip to base, projected once (eqs. 5, 11).

    Args:
        kinematics: Kinematics of the tree.
        wrenches: One wrench a link, about its origin, in its frame.

    Returns:
        One edge a speed.
    """
    total: list[Edge] = [ZERO] * kinematics.nv
    for i, wrench in subtree_wrenches(kinematics, wrenches):
        link = kinematics.links[i]
        for k, partial in enumerate(link.free_partial_velocities):
            at = link.first_speed + k
            total[at] = kinematics.g.add(total[at], power(partial, wrench))
    return total


def power(partial: PartialVelocity, wrench: Wrench) -> Edge:
    """Virtual power of a wrench on a link per unit of one speed of its joint (eq. 5)."""
    return partial.w.g.add(partial.w.dot(wrench.n), partial.v.dot(wrench.f))


def subtree_wrenches(kinematics: TreeKinematics, wrenches: Sequence[Wrench]) -> Iterator[tuple[int, Wrench]]:
    """Each link's index with the wrench on it and all beyond it, about its origin, tip to base (eq. 11).

    Args:
        kinematics: Kinematics of the tree.
        wrenches: One wrench a link, about its origin, in its frame.
    """
    subtree_wrench = list(wrenches)
    for i, link in reversed(list(enumerate(kinematics.links))):
        f_Lo_L = subtree_wrench[i].f.named(f"f_Lo_L[{link.name}]")
        n_Lo_L = subtree_wrench[i].n.named(f"n_Lo_L[{link.name}]")
        yield i, Wrench(f_Lo_L, n_Lo_L)
        if link.parent != BASE:
            about_Ao = wrench_in_parent(link, Wrench(f_Lo_L, n_Lo_L))
            subtree_wrench[link.parent] = subtree_wrench[link.parent] + about_Ao


def wrench_in_parent(link: MovingLink, wrench: Wrench) -> Wrench:
    """A wrench about a link's origin, in its frame, about its parent's origin, in the parent's frame."""
    f_Lo_A = link.R_AL.apply(wrench.f)
    return Wrench(f_Lo_A, link.R_AL.apply(wrench.n) + link.p_AL.cross(f_Lo_A))
