"""Jourdain's principle by recursion: accelerations from base to tip, virtual power from tip to base.

The sum over bodies of (partial velocity) . (inertia force) is formed link by link: the wrench of everything beyond a
joint is accumulated once and projected on the joint's partial velocities (docs/theory/rigid.md, section 3).
"""

from __future__ import annotations

from collections.abc import Sequence

from symofros.expr.edges import ZERO, Edge
from symofros.expr.vector import Vec3
from symofros.mechanics.dynamics.acceleration import LinkMotion, Wrench, base_to_tip, inertia_wrench
from symofros.mechanics.dynamics.beams import beam_forces
from symofros.mechanics.dynamics.inertia import LinkInertia
from symofros.mechanics.dynamics.rotors import MovingRotor
from symofros.mechanics.kinematics.links import Motion
from symofros.mechanics.topology.tree import BASE


def inertia_forces(
    motion: Motion,
    inertias: list[LinkInertia],
    rotors: list[MovingRotor],
    v_rate: Sequence[Edge],
    gravity: Vec3,
) -> list[Edge]:
    """M v' + h: what the inertia and the weight of all links ask of each speed (eqs. 6-11).

    Args:
        motion: The tree.
        inertias: Of its links.
        rotors: That spin in its links.
        v_rate: v' (nv); zeros give the bias h alone.
        gravity: Acceleration of gravity in the world.

    Returns:
        One edge a speed.
    """
    wrenches, own = link_wrenches(motion, inertias, rotors, base_to_tip(motion, v_rate, gravity), v_rate)
    return [motion.g.add(a, b) for a, b in zip(virtual_power(motion, wrenches), own, strict=True)]


def link_wrenches(
    motion: Motion,
    inertias: list[LinkInertia],
    rotors: list[MovingRotor],
    moving: Sequence[LinkMotion],
    v_rate: Sequence[Edge],
) -> tuple[list[Wrench], list[Edge]]:
    """What inertia asks of each link by itself, and of each speed besides.

    Args:
        motion: The tree.
        inertias: Of its links.
        rotors: That spin in its links.
        moving: Velocity and acceleration of the links.
        v_rate: v' (nv), of elastic coordinates and rotors.

    Returns:
        A wrench a link; and what its elastic coordinates and the spin of rotors ask of the speeds themselves (nv).
    """
    g = motion.g
    wrenches = [inertia_wrench(body, state) for body, state in zip(inertias, moving, strict=True)]
    total: list[Edge] = [ZERO] * motion.nv
    for beam in motion.beams:
        if beam.tip is not None:
            tip = motion.links[beam.tip]
            own, modal = beam_forces(motion, beam, moving[beam.root], tip.speeds, tip.rates_given(v_rate))
            wrenches[beam.root] = wrenches[beam.root] + own
            total[tip.v : tip.v + len(modal)] = modal
    for rotor in rotors:
        rate = rotor.rate(motion, v_rate)
        spin_rate = g.mul(rotor.ratio, rate)
        if rotor.carrier != BASE:
            state = moving[rotor.carrier]
            n = rotor.axis.scaled(g.mul(rotor.inertia, spin_rate))
            n = n + state.w.cross(rotor.axis).scaled(g.mul(rotor.inertia, rotor.spin(motion)))
            wrenches[rotor.carrier] = wrenches[rotor.carrier] + Wrench(Vec3(g), n)
            spin_rate = g.add(spin_rate, state.alpha.dot(rotor.axis))
        if rotor.k is not None:
            reaction = g.mul(g.mul(rotor.ratio, rotor.inertia), spin_rate)
            total[rotor.k] = g.add(total[rotor.k], reaction)
    return wrenches, total


def virtual_power(motion: Motion, wrenches: Sequence[Wrench]) -> list[Edge]:
    """The virtual power of one wrench a link on every speed: accumulated tip to base, projected once (eqs. 5, 11).

    Args:
        motion: The tree.
        wrenches: On its links.

    Returns:
        One edge a speed.
    """
    g = motion.g
    beyond = list(wrenches)
    total: list[Edge] = [ZERO] * motion.nv
    for i, link in reversed(list(enumerate(motion.links))):
        f, n = beyond[i].f.named(f"f_Lo_L[{link.name}]"), beyond[i].n.named(f"n_Lo_L[{link.name}]")
        for k, column in enumerate(link.free_columns):
            total[link.v + k] = g.add(column.w.dot(n), column.v.dot(f))
        if link.parent != BASE:
            f_A = link.R_AL.apply(f)
            carried = Wrench(f_A, link.R_AL.apply(n) + link.p_AL.cross(f_A))
            beyond[link.parent] = beyond[link.parent] + carried
    return total
