"""The mass matrix by composite accumulation (docs/theory/rigid.md, section 5)."""

from __future__ import annotations

from symofros.dynamics.beams import added_momentum, modal_mass
from symofros.dynamics.inertia import LinkInertia, carried_to_parent, deformed
from symofros.dynamics.rotors import MovingRotor
from symofros.expr.graph import ZERO, Edge
from symofros.expr.vector import Vec3
from symofros.kinematics.joint import Column
from symofros.kinematics.links import Motion
from symofros.topology.tree import BASE

Matrix = list[list[Edge]]


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
    composite = list(inertias)
    bent = {beam.tip: beam for beam in motion.beams if beam.tip is not None}
    for beam in bent.values():
        composite[beam.root] = composite[beam.root] + deformed(motion, beam)
    for i, link in reversed(list(enumerate(motion.links))):
        whole = composite[i]
        whole.S.named(f"composite_mp_LC[{link.name}]")
        whole.J.named(f"composite_I_LLo[{link.name}]")
        for k, column in enumerate(link.free_columns):
            f, n = _momentum(whole, column)
            for j in range(k + 1):
                own = modal_mass(bent[i], j, k) if i in bent else ZERO
                _set(M, link.v + j, link.v + k, motion.g.add(_virtual_power(link.columns[j], f, n), own))
            added = added_momentum(motion, bent[i], k) if i in bent else None
            _project_down(motion, M, i, link.v + k, f, n, added)
        if link.parent != BASE:
            composite[link.parent] = composite[link.parent] + carried_to_parent(link, whole)
    for rotor in rotors:
        if rotor.k is not None:
            _add_rotor(motion, M, rotor, rotor.k)
    return M


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


def _project_down(
    motion: Motion, M: Matrix, i: int, k: int, f: Vec3, n: Vec3, added: tuple[Vec3, Vec3] | None = None
) -> None:
    """Carry a momentum from link i to the base, and book its virtual power on every joint on the way.

    A beam's tip carries what is beyond it; the beam's own momentum is added at its root.
    """
    link = motion.links[i]
    while link.parent != BASE:
        f, n = link.R_AL.apply(f), link.R_AL.apply(n)
        n = n + link.p_AL.cross(f)
        if added is not None:
            f, n, added = f + added[0], n + added[1], None
        link = motion.links[link.parent]
        for j, column in enumerate(link.free_columns):
            _set(M, link.v + j, k, _virtual_power(column, f, n))


def _set(M: Matrix, i: int, j: int, edge: Edge) -> None:
    M[i][j] = M[j][i] = edge
