"""The mass matrix by composite accumulation (docs/theory/rigid.md, section 5)."""

from __future__ import annotations

from dataclasses import dataclass

from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.pack import EMPTY, WIDTH, Signed
from symofros.expr.packs import combined
from symofros.expr.vector import Vec3
from symofros.mechanics.dynamics.beams import added_momentum, modal_mass
from symofros.mechanics.dynamics.inertia import LinkInertia, carried_to_parent, deformed
from symofros.mechanics.dynamics.rotors import MovingRotor
from symofros.mechanics.kinematics.joint import Column
from symofros.mechanics.kinematics.links import Motion, MovingLink, speeds_by_path
from symofros.mechanics.topology.tree import BASE

Matrix = list[list[Edge]]


@dataclass(frozen=True)
class _Momentum:
    """What a unit rate of one speed gives to everything beyond its joint.

    Attributes:
        link: Beyond the joint.
        k: Index of the speed.
        f, n: Linear momentum, and angular momentum about Lo, in L.
        added: What the beam that ends in the link adds at its root, likewise.
    """

    link: int
    k: int
    f: Vec3
    n: Vec3
    added: tuple[Vec3, Vec3] | None


def mass_matrix(motion: Motion, inertias: list[LinkInertia], rotors: list[MovingRotor]) -> Matrix:
    """M, from the inertia of everything beyond each joint.

    Column by column: a unit rate of speed k gives the composite body beyond its joint a momentum; M[j][k] is that
    momentum's virtual power on every speed j on the way to the base (eq. 20). Entries between branches are zero.

    Args:
        motion: The tree.
        inertias: Of its links; not changed.
        rotors: That spin in its links.

    Returns:
        nv rows of nv edges, symmetric.
    """
    M: Matrix = [[ZERO] * motion.nv for _ in range(motion.nv)]
    momenta = _own_blocks(motion, M, inertias)
    for path in speeds_by_path(motion):
        # Those of the base's own joints have no way to go.
        going = [momenta[k] for k in path if motion.links[momenta[k].link].parent != BASE]
        for at in range(0, len(going), WIDTH):
            _carry_to_base(motion, M, going[at : at + WIDTH])
    for rotor in rotors:
        if rotor.k is not None:
            _add_rotor(motion, M, rotor, rotor.k)
    return M


def _own_blocks(motion: Motion, M: Matrix, inertias: list[LinkInertia]) -> dict[int, _Momentum]:
    """The entries between speeds of one joint; the momentum of each speed."""
    composite = list(inertias)
    momenta: dict[int, _Momentum] = {}
    bent = {beam.tip: beam for beam in motion.beams if beam.tip is not None}
    for beam in bent.values():
        composite[beam.root] = composite[beam.root] + deformed(motion, beam)
    for i, link in reversed(list(enumerate(motion.links))):
        whole = composite[i]
        whole.S.named(f"mp_LKcm[{link.name}]")
        whole.J.named(f"I_KLo_L[{link.name}]")
        for k, column in enumerate(link.free_columns):
            f, n = _momentum(whole, column)
            for j in range(k + 1):
                own = modal_mass(bent[i], j, k) if i in bent else ZERO
                _set(M, link.v + j, link.v + k, motion.g.add(_virtual_power(link.columns[j], f, n), own))
            added = added_momentum(motion, bent[i], k) if i in bent else None
            momenta[link.v + k] = _Momentum(i, link.v + k, f, n, added)
        if link.parent != BASE:
            composite[link.parent] = composite[link.parent] + carried_to_parent(link, whole)
    return momenta


def _carry_to_base(motion: Motion, M: Matrix, momenta: list[_Momentum]) -> None:
    """Carry momenta to the base, side by side, and book their virtual power on every joint on the way.

    Args:
        motion: The tree.
        M: Where the power is booked.
        momenta: On one path to the base, the outermost first.
    """
    lane = {momentum.k: WIDTH - 1 - at for at, momentum in enumerate(momenta)}  # Ascending, as in a row of M.
    wrench: list[Signed] = [(ONE, EMPTY)] * 6
    i, waiting = momenta[0].link, list(momenta)
    while motion.links[i].parent != BASE:
        late: list[tuple[int, Vec3, Vec3]] = []
        while waiting and waiting[0].link == i:
            momentum = waiting.pop(0)
            if momentum.added is None:
                wrench = _joined(wrench, lane[momentum.k], momentum.f, momentum.n)
            else:
                late.append((momentum.k, *_across_beam(motion.links[i], momentum, momentum.added)))
        wrench = _carried(motion, motion.links[i], wrench)
        for k, f, n in late:
            wrench = _joined(wrench, lane[k], f, n)
        i = motion.links[i].parent
        link = motion.links[i]
        for j, column in enumerate(link.free_columns):
            sign, power = combined(motion.g, list(zip((*column.v, *column.w), wrench, strict=True)))
            for k, at in lane.items():
                if power.lanes[at] != ZERO:
                    _set(M, link.v + j, k, motion.g.mul(sign, power.lanes[at]))


def _joined(wrench: list[Signed], lane: int, f: Vec3, n: Vec3) -> list[Signed]:
    return [
        (sign, pack.with_lane(lane, edge if sign == ONE else -edge))
        for (sign, pack), edge in zip(wrench, (*f, *n), strict=True)
    ]


def _carried(motion: Motion, link: MovingLink, wrench: list[Signed]) -> list[Signed]:
    """Momenta about Lo in L -> about Ao in A: f_A = R f, n_A = R n + p x f_A."""
    g = motion.g
    f, n = wrench[:3], wrench[3:]
    for factor in reversed(link.R_AL.factors):
        rows = [factor.matrix(g).row(i) for i in range(3)]
        f = [combined(g, list(zip(row, f, strict=True))) for row in rows]
        n = [combined(g, list(zip(row, n, strict=True))) for row in rows]
    p = link.p_AL
    return f + [
        combined(g, [(ONE, n[0]), (p.y, f[2]), (-p.z, f[1])]),
        combined(g, [(ONE, n[1]), (p.z, f[0]), (-p.x, f[2])]),
        combined(g, [(ONE, n[2]), (p.x, f[1]), (-p.y, f[0])]),
    ]


def _across_beam(link: MovingLink, momentum: _Momentum, added: tuple[Vec3, Vec3]) -> tuple[Vec3, Vec3]:
    """A momentum at a beam's tip -> at its root, with the beam's own."""
    f, n = link.R_AL.apply(momentum.f), link.R_AL.apply(momentum.n)
    n = n + link.p_AL.cross(f)
    return f + added[0], n + added[1]


def _add_rotor(motion: Motion, M: Matrix, rotor: MovingRotor, k: int) -> None:
    """What a rotor's spin adds: inertia on its speed, coupling to every speed that turns its carrier (eq. 36)."""
    g = motion.g
    per_spin = g.mul(rotor.inertia, rotor.ratio)
    M[k][k] = g.add(M[k][k], g.mul(per_spin, rotor.ratio))
    n, i = rotor.axis.scaled(per_spin), rotor.carrier
    while i != BASE:
        link = motion.links[i]
        for j, column in enumerate(link.free_columns):
            row, power = link.v + j, column.w.dot(n)
            if row == k:  # The driven speed turns its own carrier: both halves of the product fall on one entry.
                power = g.add(power, power)
            _set(M, row, k, g.add(M[row][k], power))
        n, i = link.R_AL.apply(n), link.parent


def _momentum(body: LinkInertia, column: Column) -> tuple[Vec3, Vec3]:
    """Linear momentum, and angular momentum about Lo, of a body that moves by one column."""
    f = column.v.scaled(body.m) + column.w.cross(body.S)
    n = body.J.times(column.w) + body.S.cross(column.v)
    return f, n


def _virtual_power(column: Column, f: Vec3, n: Vec3) -> Edge:
    return column.w.g.add(column.w.dot(n), column.v.dot(f))


def _set(M: Matrix, i: int, j: int, edge: Edge) -> None:
    M[i][j] = M[j][i] = edge
