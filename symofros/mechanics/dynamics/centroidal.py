"""Momentum of the whole system about its mass centre, and its rate (docs/theory/rigid.md, section 12)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from symofros.errors import DescriptionError
from symofros.expr.edges import ZERO, Edge
from symofros.expr.substitute import substitute
from symofros.expr.vector import Vec3
from symofros.mechanics.dynamics.acceleration import base_to_tip
from symofros.mechanics.dynamics.bodies.inertia import stated_inertias
from symofros.mechanics.dynamics.bodies.rotors import MovingRotor
from symofros.mechanics.dynamics.jourdain import link_wrenches, subtree_wrenches, wrench_in_parent
from symofros.mechanics.kinematics.links import TreeKinematics
from symofros.mechanics.spatial.wrench import no_wrench
from symofros.mechanics.topology.tree import BASE


@dataclass(frozen=True)
class CentralMass:
    """Mass of all that joints carry.

    Attributes:
        m: Mass [kg].
        p_WScm: Position of the mass centre [m].
    """

    m: Edge
    p_WScm: Vec3


def central_mass(kinematics: TreeKinematics) -> CentralMass:
    """Mass and mass centre of the links and of what is fixed to them; what is fixed to the world does not count.

    Raises:
        DescriptionError: No link has a mass.
    """
    g = kinematics.g
    stated = stated_inertias(kinematics)
    mass, moment = [body.m for body in stated], [body.mp_LLcm for body in stated]
    for beam in kinematics.beams:
        if beam.tip is not None:
            moment[beam.root] = moment[beam.root] + beam.equations.first_moment_change()
    total, total_moment = ZERO, Vec3(g)
    for i, link in reversed(list(enumerate(kinematics.links))):
        in_parent = link.R_AL.apply(moment[i]) + link.p_AL.scaled(mass[i])
        if link.parent == BASE:
            total, total_moment = g.add(total, mass[i]), total_moment + in_parent
        else:
            mass[link.parent] = g.add(mass[link.parent], mass[i])
            moment[link.parent] = moment[link.parent] + in_parent
    if total == ZERO:
        raise DescriptionError(
            f"system '{kinematics.tree.system.name}': no mass centre",
            "no body that a joint carries has a mass",
            "the mass centre divides by the mass of all that joints carry",
            "state masses beside the moments of inertia",
        )
    return CentralMass(total, Vec3(g, *(g.div(x, total) for x in total_moment)))


def centroidal_rate(kinematics: TreeKinematics, rotors: list[MovingRotor], v_rate: Sequence[Edge]) -> list[Edge]:
    """Rate of the momentum about the mass centre, linear then angular, in the world (6), (51).

    Args:
        kinematics: Kinematics of the tree.
        rotors: Rotors that spin in links.
        v_rate: Rates v' of the speeds (nv).
    """
    g = kinematics.g
    motions = base_to_tip(kinematics, v_rate, Vec3(g))
    wrenches, _ = link_wrenches(kinematics, stated_inertias(kinematics), rotors, motions, v_rate)
    total = no_wrench(g)
    for i, wrench in subtree_wrenches(kinematics, wrenches):
        link = kinematics.links[i]
        if link.parent == BASE:
            total = total + wrench_in_parent(link, wrench)
    about_G = total.n - central_mass(kinematics).p_WScm.cross(total.f)
    return [*total.f, *about_G]


def centroidal_momentum(kinematics: TreeKinematics, rotors: list[MovingRotor]) -> list[Edge]:
    """Momentum about the mass centre, linear then angular, in the world (6), (52): a rate from rest, at v' = v."""
    g, nv = kinematics.g, kinematics.nv
    speeds = [g.input("v", k) for k in range(nv)]
    rates = [g.input("a", k) for k in range(nv)]
    at_rest = dict.fromkeys(speeds, ZERO) | dict(zip(rates, speeds, strict=True))
    for link in kinematics.links:
        if link.rates is not None:
            at_rest |= dict.fromkeys(link.speeds, ZERO) | dict(zip(link.rates, link.speeds, strict=True))
    return substitute(g, centroidal_rate(kinematics, rotors, rates), at_rest)
