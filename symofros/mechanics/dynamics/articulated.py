"""Forward dynamics by articulated bodies: from the tips to the base, and back (docs/theory/rigid.md, section 7).

Operations grow with the number of links. M is never formed: what a heavy load and light links exchange cancels link by
link, not among sums over all of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.vector import Vec3
from symofros.mechanics.dynamics.acceleration import Acceleration, Wrench, no_wrench, velocities
from symofros.mechanics.dynamics.articulated_inertia import (
    ArticulatedInertia,
    Rows,
    acceleration_carried,
    wrench_carried,
)
from symofros.mechanics.dynamics.beams import added_momentum, modal_mass
from symofros.mechanics.dynamics.forward import SingularMassMatrixError
from symofros.mechanics.dynamics.inertia import LinkInertia, deformed
from symofros.mechanics.dynamics.jourdain import link_wrenches
from symofros.mechanics.dynamics.rotors import MovingRotor
from symofros.mechanics.kinematics.joint import Column
from symofros.mechanics.kinematics.links import Motion, MovingLink
from symofros.mechanics.topology.tree import BASE


def is_local(motion: Motion, rotor: MovingRotor) -> bool:
    """Whether a rotor couples no third body with the joint that drives it: its carrier is the parent, or rests."""
    return rotor.k is None or rotor.carrier in (BASE, motion.links[rotor.link].parent)


def articulated_acceleration(
    motion: Motion, inertias: list[LinkInertia], rotors: list[MovingRotor], gravity: Vec3, Q: Sequence[Edge]
) -> list[Edge]:
    """The solution v' of M v' + h = Q (eqs. 39-46).

    Args:
        motion: The tree.
        inertias: Of its links, not regrouped: light links would bear the moments of a heavy load.
        rotors: That spin in its links; each `is_local`.
        gravity: Acceleration of gravity in the world.
        Q: Generalized forces (nv).

    Returns:
        One edge a speed.

    Raises:
        SingularMassMatrixError: A pivot is the number zero.
    """
    moving, added = velocities(motion)
    wrenches, own = link_wrenches(motion, inertias, rotors, moving, [ZERO] * motion.nv)
    surplus = [motion.g.sub(asked, given) for asked, given in zip(own, Q, strict=True)]
    joints = _tip_to_base(motion, [*map(_Taken, _inertias(motion, inertias), wrenches)], rotors, added, surplus)
    v_rate = [ZERO] * motion.nv
    base = Acceleration(Vec3(motion.g), -gravity)
    accelerations: list[Acceleration] = []
    for i, (link, joint) in enumerate(zip(motion.links, joints, strict=True)):
        parent = base if link.parent == BASE else accelerations[link.parent]
        x = acceleration_carried(link, parent) + added[i]
        rates = joint.rates(parent if joint.in_parent else x)
        v_rate[link.v : link.v + len(rates)] = rates
        for column, rate in zip(link.free_columns, rates, strict=True):
            x = x + Acceleration(column.w.scaled(rate), column.v.scaled(rate))
        accelerations.append(x)
    return v_rate


class _Taken(NamedTuple):
    """What a body takes: its inertia times its acceleration, and a wrench besides, about its origin, in its frame."""

    body: ArticulatedInertia
    wrench: Wrench

    def given(self, x: Acceleration) -> _Taken:
        """With a part of the acceleration known (eq. 43)."""
        return _Taken(self.body, self.wrench + self.body.times(x))

    def carried(self, link: MovingLink, onto: _Taken) -> _Taken:
        """Taken over by the link's parent, by which this moves, on top of what that takes already (eqs. 11, 44)."""
        return _Taken(self.body.carried(link, onto.body), onto.wrench + wrench_carried(link, self.wrench))


def _inertias(motion: Motion, inertias: list[LinkInertia]) -> list[ArticulatedInertia]:
    """Of the links by themselves, beams as they are bent."""
    found = [ArticulatedInertia.of(inertia) for inertia in inertias]
    for beam in motion.beams:
        if beam.tip is not None:
            found[beam.root] = found[beam.root] + ArticulatedInertia.of(deformed(motion, beam))
    return found


def _tip_to_base(
    motion: Motion,
    alone: list[_Taken],
    rotors: list[MovingRotor],
    added: Sequence[Acceleration],
    surplus: Sequence[Edge],
) -> list[_FreeJoint]:
    """Each joint, with everything beyond it articulated.

    Args:
        motion: The tree.
        alone: What the links take by themselves at rates zero.
        rotors: That spin in them.
        added: What each joint adds to the acceleration of its parent at rates zero.
        surplus: What the speeds take besides, less their generalized forces (nv).
    """
    g = motion.g
    beyond = dict(enumerate(alone)) | {BASE: _Taken(ArticulatedInertia.none(g), no_wrench(g))}
    joints: list[_FreeJoint] = []
    for i, link in reversed(list(enumerate(motion.links))):
        taken, parent, coupling = beyond[i], beyond[link.parent], _coupling(motion, rotors, i)
        per_rate = [taken.body.times(Acceleration(column.w, column.v)) for column in link.free_columns]
        D = [
            [g.add(_power(column, per), own) for per, own in zip(per_rate, row, strict=True)]
            for column, row in zip(link.free_columns, coupling.own, strict=True)
        ]
        if coupling.in_parent:
            taken = taken.given(added[i])
        lacking = [
            g.add(surplus[k], _power(column, taken.wrench)) for k, column in enumerate(link.free_columns, start=link.v)
        ]
        if coupling.in_parent:
            per_rate = [wrench_carried(link, a) + b for a, b in zip(per_rate, coupling.wrenches, strict=True)]
            joint = _FreeJoint(g, taken.carried(link, parent), per_rate, D, lacking, True, link.v)
            beyond[link.parent] = joint.taken
        else:
            joint = _FreeJoint(g, taken, per_rate, D, lacking, False, link.v)
            beyond[link.parent] = joint.taken.given(added[i]).carried(link, parent)
        joints.insert(0, joint)
    return joints


class _FreeJoint:
    """One joint's speeds, eliminated from what the bodies beyond it take (eqs. 41, 42).

    Args:
        g: The graph.
        taken: By the body whose acceleration it all refers to.
        per_rate: What that body takes per rate of each speed (n).
        D: What the speeds take per rate (n x n).
        lacking: What they take besides, less their generalized forces (n).
        in_parent: Whether that body is the parent; otherwise the link itself, as it moves at rates zero.
        v: Index of the first speed.

    Attributes:
        taken: By that body with the joint free.
        in_parent: As given.

    Raises:
        SingularMassMatrixError: A pivot is the number zero.
    """

    def __init__(
        self,
        g: Graph,
        taken: _Taken,
        per_rate: Sequence[Wrench],
        D: Rows,
        lacking: Sequence[Edge],
        in_parent: bool,
        v: int,
    ) -> None:
        self.in_parent = in_parent
        self._g = g
        self._ratios: list[list[Edge]] = []
        self._free: list[Edge] = []
        rows = taken.body.rows() + [[*per.f, *per.n, *D[k]] for k, per in enumerate(per_rate)]
        right = [*taken.wrench.f, *taken.wrench.n, *lacking]
        for k in reversed(range(6, len(rows))):
            row, pivot = rows[k], rows[k][k]
            if pivot == ZERO:
                raise SingularMassMatrixError(v + k - 6)
            inverse = g.div(ONE, pivot)
            ratios = [_quotient(g, edge, pivot, inverse) for edge in row[:k]]
            for i in range(k):
                for j in range(i + 1):
                    rows[i][j] = g.sub(rows[i][j], _product(g, (row[i], ratios[i]), (row[j], ratios[j])))
                right[i] = g.sub(right[i], g.mul(ratios[i], right[k]))
            self._ratios.insert(0, ratios)
            self._free.insert(0, -g.mul(right[k], inverse))
        wrench = Wrench(Vec3(g, *right[:3]), Vec3(g, *right[3:6]))
        self.taken = _Taken(ArticulatedInertia.of_rows(g, rows), wrench)

    def rates(self, x: Acceleration) -> list[Edge]:
        """Of the speeds, at an acceleration of the body (eq. 45)."""
        known = [*x.a, *x.alpha]
        for ratios, free in zip(self._ratios, self._free, strict=True):
            products = [-self._g.mul(a, b) for a, b in zip(ratios, known, strict=True)]
            known.append(_sum_in_pairs(self._g, [free, *products]))
        return known[6:]


def _quotient(g: Graph, edge: Edge, pivot: Edge, inverse: Edge) -> Edge:
    """Edge / pivot: exactly 1 for the pivot itself, so that entries which a free joint makes vanish fold to zero."""
    return g.div(edge, pivot) if abs(edge) == abs(pivot) else g.mul(edge, inverse)


def _product(g: Graph, x: tuple[Edge, Edge], y: tuple[Edge, Edge]) -> Edge:
    """X y / pivot of two entries, each with its quotient; the same node whichever comes first."""
    if abs(x[1]) == ONE or (abs(y[1]) != ONE and abs(x[0]) > abs(y[0])):
        return g.mul(x[1], y[0])
    return g.mul(x[0], y[1])


def _sum_in_pairs(g: Graph, terms: Sequence[Edge]) -> Edge:
    """A sum that waits for fewer additions in a row: along a chain all links wait for it."""
    while len(terms) > 1:
        terms = [g.sum(terms[i : i + 2]) for i in range(0, len(terms), 2)]
    return terms[0]


@dataclass(frozen=True)
class _Coupling:
    """What rates of a joint's speeds take apart from the acceleration of its link (eq. 46).

    Attributes:
        own: Of each speed, per rate of each (n x n).
        wrenches: Of the parent, per rate of each (n).
    """

    own: Rows
    wrenches: list[Wrench]

    @property
    def in_parent(self) -> bool:
        """Whether the parent takes anything."""
        return not all(wrench.f.is_zero and wrench.n.is_zero for wrench in self.wrenches)


def _coupling(motion: Motion, rotors: Sequence[MovingRotor], index: int) -> _Coupling:
    """By the beam that ends in a link, and by rotors that its joint drives."""
    g = motion.g
    n = range(len(motion.links[index].free_columns))
    own, wrenches = [[ZERO for _ in n] for _ in n], [no_wrench(g) for _ in n]
    for beam in motion.beams:
        if beam.tip == index:
            own = [[modal_mass(beam, i, j) for j in n] for i in n]
            wrenches = [Wrench(*added_momentum(motion, beam, i)) for i in n]
    for rotor in rotors:
        if rotor.link == index and rotor.k is not None:
            c, per_spin = rotor.coordinate, g.mul(rotor.inertia, rotor.ratio)
            own[c][c] = g.add(own[c][c], g.mul(per_spin, rotor.ratio))
            if rotor.carrier != BASE:
                wrenches[c] = wrenches[c] + Wrench(Vec3(g), rotor.axis.scaled(per_spin))
    return _Coupling(own, wrenches)


def _power(column: Column, wrench: Wrench) -> Edge:
    return wrench.f.g.add(column.w.dot(wrench.n), column.v.dot(wrench.f))
