"""Derivatives of M a + h by q and v of rigid trees, by recursion (docs/theory/linear.md, section 7).

A unit change of one coordinate or speed moves everything beyond its joint by one field of accelerations (14). Its
wrench on the composite body, carried to the base, gives a column at every joint on the way; its virtual power on the
momenta of the speeds beyond, which the mass matrix carries to the base, gives a row.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from symofros.base.routes import Choice, choose
from symofros.expr.edges import ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.packs.combine import linear_combination
from symofros.expr.packs.pack import SignedPack
from symofros.expr.vector import Mat3, Vec3
from symofros.mechanics.dynamics.acceleration import base_motion, base_to_tip
from symofros.mechanics.dynamics.applied.forces import rates_per_speed
from symofros.mechanics.dynamics.bodies.rotors import MovingRotor
from symofros.mechanics.dynamics.derivatives.flows import Flow, composite_flows, origin_velocities
from symofros.mechanics.dynamics.derivatives.variations import JointVariations, Variation
from symofros.mechanics.dynamics.jourdain import link_wrenches, power, subtree_wrenches
from symofros.mechanics.dynamics.mass_matrix import CarriedMomenta, MassMatrix, Matrix
from symofros.mechanics.dynamics.wrenches.wrench_packs import (
    NO_WRENCHES,
    virtual_powers,
    with_wrench,
    wrenches_in_parent,
)
from symofros.mechanics.kinematics.links import TreeKinematics
from symofros.mechanics.spatial.inertia import LinkInertia
from symofros.mechanics.spatial.wrench import Wrench
from symofros.mechanics.topology.tree import BASE


def route(kinematics: TreeKinematics, rotors: Sequence[MovingRotor]) -> Choice:
    """Choice of the route of derivatives: recursion if no beam deforms and no rotor's spin acts on a moving link."""
    return choose("derivatives of inertia forces", figures_of(kinematics, rotors))


def figures_of(kinematics: TreeKinematics, rotors: Sequence[MovingRotor]) -> dict[str, float]:
    """Figures by which recursions over links apply."""
    return {
        "elastic_beams": sum(beam.tip is not None for beam in kinematics.beams),
        "moving_rotors": sum(rotor.carrier != BASE for rotor in rotors),
    }


@dataclass(frozen=True)
class _Response:
    """Response of the composite body beyond a joint to a unit of one coordinate (by q) and of its speed (by v).

    Attributes:
        variations: Change of motion by q, by v.
        wrenches: Change of the wrench on the composite body as the parent sees it, by q, by v.
        couple: Vector p with virtual power p . w of the accelerations 2 w x V on the speed (eq. 21).
    """

    variations: tuple[Variation, Variation]
    wrenches: tuple[Wrench, Wrench]
    couple: Vec3


def inertia_force_derivatives(
    kinematics: TreeKinematics, mass: MassMatrix, inertias: list[LinkInertia], v_rate: Sequence[Edge], gravity: Vec3
) -> tuple[Matrix, Matrix]:
    """Derivatives of M v' + h by q, along the motion of each speed, and by v.

    Args:
        kinematics: Kinematics of a tree whose `route` is the recursion.
        mass: Mass matrix, whose momenta on their way to the base are used.
        inertias: Inertia of each link.
        v_rate: v' (nv), which stays as it is.
        gravity: Acceleration of gravity in the world.

    Returns:
        Two matrices (nv x nv).
    """
    g, nv = kinematics.g, kinematics.nv
    by_q: Matrix = [[ZERO] * nv for _ in range(nv)]
    by_v: Matrix = [[ZERO] * nv for _ in range(nv)]
    base, motions = base_motion(gravity), base_to_tip(kinematics, v_rate, gravity)
    wrenches = dict(subtree_wrenches(kinematics, link_wrenches(kinematics, inertias, [], motions, v_rate)[0]))
    velocities, directions = origin_velocities(kinematics, motions), rates_per_speed(kinematics)
    flows = composite_flows(kinematics, inertias, motions, velocities)
    responses: list[_Response] = []
    for i, link in enumerate(kinematics.links):
        parent = base if link.parent == BASE else motions[link.parent]
        joint = JointVariations(link, directions, parent, motions[i], velocities[i], v_rate)
        N, total = flows[i].about_axes(), wrenches[i]
        for k, partial in enumerate(link.free_partial_velocities):
            variations = joint.by_coordinate(k), joint.by_speed(k)
            moved, driven = (_wrench(mass.composites[i], flows[i], N, variation) for variation in variations)
            column = link.first_speed + k
            for j, other in enumerate(link.free_partial_velocities):
                by_q[link.first_speed + j][column] = g.add(power(other, moved), joint.power_change(j, k, total))
                by_v[link.first_speed + j][column] = power(other, driven)
            turning = Wrench(partial.w.cross(total.f), partial.w.cross(total.n) + partial.v.cross(total.f))
            couple = flows[i].P.cross(partial.v) + N.T.times(partial.w)
            responses.append(_Response(variations, (moved + turning, driven), couple))
    for carried in mass.carried:
        _enter_pairs(kinematics, carried, responses, (by_q, by_v))
    return by_q, by_v


def _enter_pairs(
    kinematics: TreeKinematics, carried: CarriedMomenta, responses: Sequence[_Response], slopes: tuple[Matrix, Matrix]
) -> None:
    """The entries between each speed of a path and those of the joints on its way to the base (eqs. 20, 21)."""
    g = kinematics.g
    wrenches, couples = [NO_WRENCHES, NO_WRENCHES], NO_WRENCHES
    i, waiting, beyond = carried.momenta[0].link, list(carried.momenta), list[int]()
    for ancestor, momenta in carried.at_links:
        while waiting and waiting[0].link == i:
            k = waiting.pop(0).k
            beyond.append(k)
            lane, response = carried.lanes[k], responses[k]
            wrenches = [with_wrench(x, lane, y.f, y.n) for x, y in zip(wrenches, response.wrenches, strict=True)]
            couples = with_wrench(couples, lane, Vec3(g), response.couple)
        wrenches = [wrenches_in_parent(kinematics.links[i], x) for x in wrenches]
        couples = wrenches_in_parent(kinematics.links[i], couples)
        i, link = ancestor, kinematics.links[ancestor]
        for j, partial in enumerate(link.free_partial_velocities, link.first_speed):
            for matrix, of_j, carried_wrenches in zip(slopes, responses[j].variations, wrenches, strict=True):
                row, column = virtual_powers(partial, carried_wrenches), _powers(of_j, momenta, couples)
                for k in beyond:
                    matrix[j][k], matrix[k][j] = (_lane(g, pack, carried.lanes[k]) for pack in (row, column))


def _lane(g: Graph, signed: SignedPack, lane: int) -> Edge:
    sign, pack = signed
    return g.mul(sign, pack.lanes[lane])


def _powers(variation: Variation, momenta: Sequence[SignedPack], couples: Sequence[SignedPack]) -> SignedPack:
    """Virtual power of a variation's inertia forces on each speed beyond (eq. 21)."""
    factors = (*variation.a, *variation.alpha, *variation.w)
    return linear_combination(variation.w.g, list(zip(factors, [*momenta, *couples[3:]], strict=True)))


def _wrench(body: LinkInertia, flow: Flow, N: Mat3, variation: Variation) -> Wrench:
    """Wrench about Lo that a variation takes (eq. 19)."""
    S = body.mp_LLcm
    f = variation.a.scaled(body.m) + variation.alpha.cross(S) + variation.w.cross(flow.P)
    n = body.I_LLo_L.times(variation.alpha) + S.cross(variation.a) + N.times(variation.w)
    return Wrench(f, n)
