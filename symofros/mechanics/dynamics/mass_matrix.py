"""The mass matrix by composite accumulation (docs/theory/rigid.md, section 5)."""

from __future__ import annotations

from dataclasses import dataclass

from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.packs.pack import WIDTH, SignedPack
from symofros.expr.vector import Vec3
from symofros.mechanics.dynamics.bodies.inertia import inertia_in_parent
from symofros.mechanics.dynamics.bodies.rotors import MovingRotor
from symofros.mechanics.dynamics.wrenches.wrench_packs import (
    NO_WRENCHES,
    virtual_powers,
    with_wrench,
    wrenches_in_parent,
)
from symofros.mechanics.kinematics.links import MovingLink, TreeKinematics, speeds_by_path
from symofros.mechanics.spatial.across import PartialVelocity
from symofros.mechanics.spatial.inertia import LinkInertia
from symofros.mechanics.topology.tree import BASE

Matrix = list[list[Edge]]


@dataclass(frozen=True)
class Momentum:
    """Momentum that a unit rate of one speed gives to everything beyond its joint.

    Attributes:
        link: Index of the link beyond the joint; of a beam's coordinate that at its tip.
        k: Index of the speed.
        f: Linear momentum, in L.
        n: Angular momentum about Lo, in L.
        added: Linear and angular momentum of the beam that ends in the link, and of what its other sections carry,
            about its root, in the root's link.
    """

    link: int
    k: int
    f: Vec3
    n: Vec3
    added: tuple[Vec3, Vec3] | None


@dataclass(frozen=True)
class CarriedMomenta:
    """Momenta of up to WIDTH speeds on one path to the base, in packs.

    Attributes:
        momenta: The momenta, that of the outermost speed first.
        lanes: Lane of each speed.
        at_links: Index of each link on the way, from the parent of the outermost on, with the six components of the
            momenta there: linear, then angular about its origin, in its frame.
    """

    momenta: list[Momentum]
    lanes: dict[int, int]
    at_links: list[tuple[int, list[SignedPack]]]


@dataclass(frozen=True)
class MassMatrix:
    """M and what it is made of.

    Attributes:
        entries: M (nv x nv), symmetric.
        composites: Inertia of the composite body of each link, about its origin.
        carried: Momenta on their way to the base.
    """

    entries: Matrix
    composites: list[LinkInertia]
    carried: list[CarriedMomenta]


def mass_matrix(kinematics: TreeKinematics, inertias: list[LinkInertia], rotors: list[MovingRotor]) -> MassMatrix:
    """M, from the inertia of everything beyond each joint.

    Column by column: a unit rate of speed k gives the composite body beyond its joint a momentum; M[j][k] is that
    momentum's virtual power on every speed j on the way to the base (eq. 20). Entries between branches are zero.

    Args:
        kinematics: Kinematics of the tree.
        inertias: Inertia of each link; not changed.
        rotors: Rotors that spin in links.
    """
    M: Matrix = [[ZERO] * kinematics.nv for _ in range(kinematics.nv)]
    composites, momenta = _own_blocks(kinematics, M, inertias)
    carried = []
    for path in speeds_by_path(kinematics):
        # Momenta of joints on the base have no joint left to cross.
        outer = [momenta[k] for k in path if kinematics.links[momenta[k].link].parent != BASE]
        for at in range(0, len(outer), WIDTH):
            carried.append(_carry_to_base(kinematics, M, outer[at : at + WIDTH]))
    for rotor in rotors:
        if rotor.k is not None:
            _add_rotor(kinematics, M, rotor, rotor.k)
    for k in kinematics.states:
        M[k][k] = ONE
    return MassMatrix(M, composites, carried)


def _own_blocks(
    kinematics: TreeKinematics, M: Matrix, inertias: list[LinkInertia]
) -> tuple[list[LinkInertia], dict[int, Momentum]]:
    """The entries between speeds of one joint; inertias of the composite bodies, and the momentum of each speed."""
    composite = list(inertias)
    g = kinematics.g
    momenta: dict[int, Momentum] = {}
    beam_at_tip = {beam.tip: beam for beam in kinematics.beams if beam.tip is not None}
    # Momenta of what a beam's sections before the tip carry, by speed; those links come after the tip.
    at_stations: dict[int, tuple[Vec3, Vec3]] = {}
    for beam in beam_at_tip.values():
        composite[beam.root] = composite[beam.root] + beam.equations.deformed()
    for i, link in reversed(list(enumerate(kinematics.links))):
        body = composite[i]
        body.mp_LLcm.named(f"mp_LKcm[{link.name}]")
        body.I_LLo_L.named(f"I_KLo_L[{link.name}]")
        for k, partial in enumerate(link.free_partial_velocities):
            f, n = _momentum(body, partial)
            row = link.first_speed + k
            for j, other in enumerate(link.partial_velocities[: k + 1], start=link.first_speed):
                modal = beam_at_tip[i].equations.modal_mass(j - link.first_speed, k) if i in beam_at_tip else ZERO
                _set(M, j, row, g.add(M[j][row], g.add(_virtual_power(other, f, n), modal)))
            if link.tip is not None:
                at_stations[row] = _across_beam(link, f, n, at_stations.get(row, (Vec3(g), Vec3(g))))
                continue
            added = beam_at_tip[i].equations.momentum(k) if i in beam_at_tip else None
            if added is not None and row in at_stations:
                added = added[0] + at_stations[row][0], added[1] + at_stations[row][1]
            momenta[row] = Momentum(i, row, f, n, added)
        if link.parent != BASE:
            composite[link.parent] = composite[link.parent] + inertia_in_parent(link, body)
    return composite, momenta


def _carry_to_base(kinematics: TreeKinematics, M: Matrix, momenta: list[Momentum]) -> CarriedMomenta:
    """Carry momenta to the base, all columns at once, and enter their virtual power at every joint on the way.

    Args:
        kinematics: Kinematics of the tree.
        M: Mass matrix, to be filled in.
        momenta: Momenta on one path to the base, the outermost first.
    """
    lane = {momentum.k: WIDTH - 1 - at for at, momentum in enumerate(momenta)}  # Ascending, as in a row of M.
    wrench = NO_WRENCHES
    i, waiting = momenta[0].link, list(momenta)
    at_links: list[tuple[int, list[SignedPack]]] = []
    while kinematics.links[i].parent != BASE:
        late: list[tuple[int, Vec3, Vec3]] = []
        while waiting and waiting[0].link == i:
            momentum = waiting.pop(0)
            if momentum.added is None:
                wrench = with_wrench(wrench, lane[momentum.k], momentum.f, momentum.n)
            else:
                late.append((momentum.k, *_across_beam(kinematics.links[i], momentum.f, momentum.n, momentum.added)))
        wrench = wrenches_in_parent(kinematics.links[i], wrench)
        for k, f, n in late:
            wrench = with_wrench(wrench, lane[k], f, n)
        i = kinematics.links[i].parent
        at_links.append((i, wrench))
        link = kinematics.links[i]
        for j, partial in enumerate(link.free_partial_velocities):
            sign, power = virtual_powers(partial, wrench)
            for k, at in lane.items():
                if power.lanes[at] != ZERO:
                    _set(M, link.first_speed + j, k, kinematics.g.mul(sign, power.lanes[at]))
    return CarriedMomenta(momenta, lane, at_links)


def _across_beam(link: MovingLink, f: Vec3, n: Vec3, added: tuple[Vec3, Vec3]) -> tuple[Vec3, Vec3]:
    """Momentum at a section of a beam -> momentum at its root, plus `added`."""
    f, n = link.R_AL.apply(f), link.R_AL.apply(n)
    n = n + link.p_AL.cross(f)
    return f + added[0], n + added[1]


def _add_rotor(kinematics: TreeKinematics, M: Matrix, rotor: MovingRotor, k: int) -> None:
    """Spin of a rotor: inertia on its speed, coupling to every speed that turns its carrier (eq. 36)."""
    g = kinematics.g
    per_spin = g.mul(rotor.inertia, rotor.ratio)
    M[k][k] = g.add(M[k][k], g.mul(per_spin, rotor.ratio))
    n, i = rotor.axis.scaled(per_spin), rotor.carrier
    while i != BASE:
        link = kinematics.links[i]
        for j, partial in enumerate(link.free_partial_velocities):
            row, power = link.first_speed + j, partial.w.dot(n)
            if row == k:  # The driven speed turns its own carrier: both halves of the product fall on one entry.
                power = g.add(power, power)
            _set(M, row, k, g.add(M[row][k], power))
        n, i = link.R_AL.apply(n), link.parent


def _momentum(body: LinkInertia, partial: PartialVelocity) -> tuple[Vec3, Vec3]:
    """Linear momentum, and angular momentum about Lo, of a body that moves by one partial velocity."""
    f = partial.v.scaled(body.m) + partial.w.cross(body.mp_LLcm)
    n = body.I_LLo_L.times(partial.w) + body.mp_LLcm.cross(partial.v)
    return f, n


def _virtual_power(partial: PartialVelocity, f: Vec3, n: Vec3) -> Edge:
    return partial.w.g.add(partial.w.dot(n), partial.v.dot(f))


def _set(M: Matrix, i: int, j: int, edge: Edge) -> None:
    M[i][j] = M[j][i] = edge
