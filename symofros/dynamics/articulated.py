"""Forward dynamics by articulated bodies: the wrench a link takes per acceleration, with the joints beyond it free.

One pass from the tips to the base and one back, so operations grow with the number of links (docs/theory/rigid.md,
section 7). M is never formed: what a heavy load and light links exchange cancels link by link, not among sums of all.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from symofros.dynamics.acceleration import Acceleration, LinkMotion, Wrench, velocities
from symofros.dynamics.beams import added_momentum, modal_mass
from symofros.dynamics.forward import SingularMassMatrixError
from symofros.dynamics.inertia import LinkInertia, deformed
from symofros.dynamics.jourdain import link_wrenches
from symofros.dynamics.mass_matrix import Matrix
from symofros.dynamics.rotors import MovingRotor
from symofros.expr.graph import ONE, ZERO, Edge, Graph
from symofros.expr.vector import Mat3, Sym3, Vec3
from symofros.kinematics.joint import Column
from symofros.kinematics.links import Motion, MovingLink
from symofros.topology.tree import BASE


def is_local(motion: Motion, rotor: MovingRotor) -> bool:
    """Whether a rotor couples the joint that drives it with no third body: its carrier is the parent, or rests."""
    return rotor.k is None or rotor.carrier in (BASE, motion.links[rotor.link].parent)


def articulated_acceleration(
    motion: Motion, inertias: list[LinkInertia], rotors: list[MovingRotor], gravity: Vec3, Q: Sequence[Edge]
) -> list[Edge]:
    """The solution v' (nv) of M v' + h = Q (eqs. 39-45).

    Args:
        motion: The tree.
        inertias: Of its links, not regrouped: that would have light links carry a heavy load's moments.
        rotors: That spin in its links; `is_local`.
        gravity: Acceleration of gravity in the world.
        Q: Generalized forces (nv).

    Raises:
        SingularMassMatrixError: A pivot is the number zero.
    """
    g = motion.g
    moving, added = velocities(motion)
    joints = _tip_to_base(motion, inertias, rotors, moving, added, Q)
    v_rate = [ZERO] * motion.nv
    base = Acceleration(Vec3(g), -gravity)
    accelerations: list[Acceleration] = []
    for i, link in enumerate(motion.links):
        parent = base if link.parent == BASE else accelerations[link.parent]
        carried = _acceleration_carried(link, parent) + added[i]
        rates = joints[i].rates(parent if joints[i].in_parent else carried)
        for k, (column, rate) in enumerate(zip(link.free_columns, rates, strict=True)):
            v_rate[link.v + k] = rate
            carried = carried + Acceleration(column.w.scaled(rate), column.v.scaled(rate))
        accelerations.append(carried)
    return v_rate


def _tip_to_base(
    motion: Motion,
    inertias: list[LinkInertia],
    rotors: list[MovingRotor],
    moving: Sequence[LinkMotion],
    added: Sequence[Acceleration],
    Q: Sequence[Edge],
) -> list[_Joint]:
    """Every joint, the links beyond it articulated."""
    g = motion.g
    wrenches, own = link_wrenches(motion, inertias, rotors, moving, [ZERO] * motion.nv)
    bodies = [ArticulatedInertia.of(inertia) for inertia in inertias]
    for beam in motion.beams:
        if beam.tip is not None:
            bodies[beam.root] = bodies[beam.root] + ArticulatedInertia.of(deformed(motion, beam))
    joints: list[_Joint] = []
    for i, link in reversed(list(enumerate(motion.links))):
        body, wrench = bodies[i], wrenches[i]
        columns, speeds = link.free_columns, range(link.v, link.v + len(link.free_columns))
        coupling = _coupling(motion, rotors, i)
        if coupling.in_parent:
            wrench = wrench + body.times(added[i])
        per_speed = [body.times(Acceleration(column.w, column.v)) for column in columns]
        D = [[g.add(_power(column, per), coupling.own[j][k]) for k, per in enumerate(per_speed)]
             for j, column in enumerate(columns)]  # fmt: skip
        lacking = [
            g.sub(g.add(own[k], _power(column, wrench)), Q[k]) for k, column in zip(speeds, columns, strict=True)
        ]
        if coupling.in_parent:
            body, wrench = body.carried(link), _wrench_carried(link, wrench)
            per_speed = [
                _wrench_carried(link, per) + more for per, more in zip(per_speed, coupling.wrenches, strict=True)
            ]
        joint = _Joint(g, body, wrench, per_speed, D, lacking, coupling.in_parent, link.v)
        joints.insert(0, joint)
        if link.parent == BASE:
            continue
        body, wrench = joint.body, joint.wrench
        if not coupling.in_parent:
            body, wrench = body.carried(link), _wrench_carried(link, wrench + body.times(added[i]))
        bodies[link.parent], wrenches[link.parent] = bodies[link.parent] + body, wrenches[link.parent] + wrench
    return joints


@dataclass(frozen=True)
class ArticulatedInertia:
    """The wrench f = A a + B alpha, n = B^T a + C alpha about Lo that an acceleration of L takes, in L (eq. 39)."""

    A: Sym3
    B: Mat3
    C: Sym3

    @staticmethod
    def of(body: LinkInertia) -> ArticulatedInertia:
        """Of a rigid body."""
        g, m, (x, y, z) = body.S.g, body.m, body.S
        return ArticulatedInertia(Sym3(g, m, m, m), Mat3(g, (ZERO, z, -y, -z, ZERO, x, y, -x, ZERO)), body.J)

    @staticmethod
    def of_rows(g: Graph, rows: Matrix) -> ArticulatedInertia:
        """Of its 6 x 6 matrix, f and a before n and alpha."""
        A, C = (
            Sym3(g, *(rows[at + i][at + j] for i, j in ((0, 0), (1, 1), (2, 2), (1, 0), (2, 0), (2, 1))))
            for at in (0, 3)
        )
        return ArticulatedInertia(A, Mat3(g, tuple(rows[3 + j][i] for i in range(3) for j in range(3))), C)

    def rows(self) -> Matrix:
        """The 6 x 6 matrix."""
        A, B, C = self.A.matrix(), self.B, self.C.matrix()
        return [[*A.row(i), *B.row(i)] for i in range(3)] + [[*B.column(i), *C.row(i)] for i in range(3)]

    def __add__(self, other: ArticulatedInertia) -> ArticulatedInertia:
        g = self.B.g
        B = tuple(g.add(a, b) for a, b in zip(self.B.entries, other.B.entries, strict=True))
        return ArticulatedInertia(self.A + other.A, Mat3(g, B), self.C + other.C)

    def times(self, x: Acceleration) -> Wrench:
        """The wrench of an acceleration."""
        return Wrench(self.A.times(x.a) + self.B.times(x.alpha), self.B.T.times(x.a) + self.C.times(x.alpha))

    def carried(self, link: MovingLink) -> ArticulatedInertia:
        """The same about the parent's origin, in the parent's frame (eq. 44)."""
        g, p = self.B.g, link.p_AL
        A, B, C = link.R_AL.conjugate(self.A), link.R_AL.conjugate_any(self.B), link.R_AL.conjugate(self.C)
        if p.is_zero:
            return ArticulatedInertia(A, B, C)
        # Rows of A [p] are those of A, x p; columns of [p] B are p x those of B.
        rows = [B.row(i) - A.matrix().row(i).cross(p) for i in range(3)]
        moved = Mat3(g, tuple(edge for row in rows for edge in row))
        first = Mat3.from_columns(g, [p.cross(B.column(j)) for j in range(3)])
        last = Mat3.from_columns(g, [p.cross(moved.column(j)) for j in range(3)])

        def both(i: int, j: int) -> Edge:
            return g.add(last.at(i, j), first.at(j, i))

        C = C + Sym3(g, both(0, 0), both(1, 1), both(2, 2), both(0, 1), both(0, 2), both(1, 2))
        return ArticulatedInertia(A, moved, C)


class _Joint:
    """The speeds of one joint, eliminated from what its bodies' accelerations take (eqs. 41-43).

    Args:
        g: The graph.
        body: What carries the joint's speeds, all beyond articulated.
        wrench: What it takes besides.
        per_speed: What it takes per rate of each speed.
        D: What the speeds take per rate (n x n).
        lacking: What they take besides, less their generalized force (n).
        in_parent: Whether all that is of the parent's acceleration, in its frame; otherwise of the link's own at
            rates zero.
        v: Index of the first speed.

    Attributes:
        body, wrench: The same with the joint free.
        in_parent: As given.

    Raises:
        SingularMassMatrixError: A pivot is the number zero.
    """

    def __init__(
        self, g: Graph, body: ArticulatedInertia, wrench: Wrench, per_speed: Sequence[Wrench], D: Matrix,
        lacking: Sequence[Edge], in_parent: bool, v: int,
    ) -> None:  # fmt: skip
        self.in_parent = in_parent
        self._g, self._n = g, len(per_speed)
        rows = body.rows() + [[*per.f, *per.n, *D[k]] for k, per in enumerate(per_speed)]
        right = [*wrench.f, *wrench.n, *lacking]
        self._ratios: list[list[Edge]] = []
        self._free: list[Edge] = []
        for k in reversed(range(6, 6 + self._n)):
            row, pivot = rows[k], rows[k][k]
            if pivot == ZERO:
                raise SingularMassMatrixError(v + k - 6)
            inverse = g.div(ONE, pivot)
            ratio = [_quotient(g, edge, pivot, inverse) for edge in row[:k]]
            for i in range(k):
                for j in range(i + 1):
                    rows[i][j] = g.sub(rows[i][j], _product(g, row[i], ratio[i], row[j], ratio[j]))
                right[i] = g.sub(right[i], g.mul(ratio[i], right[k]))
            self._ratios.insert(0, ratio)
            self._free.insert(0, -g.mul(right[k], inverse))
        self.body = ArticulatedInertia.of_rows(g, rows)
        self.wrench = Wrench(Vec3(g, *right[:3]), Vec3(g, *right[3:6]))

    def rates(self, x: Acceleration) -> list[Edge]:
        """Of its speeds, at an acceleration as given by `in_parent` (eq. 45)."""
        g, known = self._g, [*x.a, *x.alpha]
        for ratio, free in zip(self._ratios, self._free, strict=True):
            known.append(g.sub(free, g.sum(g.mul(a, b) for a, b in zip(ratio, known, strict=True))))
        return known[6:]


def _quotient(g: Graph, edge: Edge, pivot: Edge, inverse: Edge) -> Edge:
    """Edge / pivot: exactly 1 for the pivot itself, so that what a free joint can't transmit is zero."""
    return g.div(edge, pivot) if abs(edge) == abs(pivot) else g.mul(edge, inverse)


def _product(g: Graph, x: Edge, x_ratio: Edge, y: Edge, y_ratio: Edge) -> Edge:
    """X y / pivot, the same node for y x / pivot."""
    if abs(x_ratio) == ONE or (abs(y_ratio) != ONE and abs(x) > abs(y)):
        return g.mul(x_ratio, y)
    return g.mul(x, y_ratio)


@dataclass(frozen=True)
class _Coupling:
    """What the rates of a joint's speeds take besides the acceleration of its link.

    Attributes:
        own: Per rate of each speed, of each speed (n x n): modal masses, spins of rotors.
        wrenches: Per rate of each speed, of the parent (n).
        in_parent: Whether one of these is not zero.
    """

    own: Matrix
    wrenches: list[Wrench]

    @property
    def in_parent(self) -> bool:
        return not all(wrench.f.is_zero and wrench.n.is_zero for wrench in self.wrenches)


def _coupling(motion: Motion, rotors: Sequence[MovingRotor], index: int) -> _Coupling:
    """Of one link's joint: the beam that ends in the link, rotors that the joint drives (eq. 46)."""
    g, link = motion.g, motion.links[index]
    size = range(len(link.free_columns))
    own, wrenches = [[ZERO for _ in size] for _ in size], [Wrench(Vec3(g), Vec3(g)) for _ in size]
    for beam in motion.beams:
        if beam.tip == index:
            own = [[modal_mass(beam, i, j) for j in size] for i in size]
            wrenches = [Wrench(*added_momentum(motion, beam, i)) for i in size]
    for rotor in rotors:
        if rotor.link == index and rotor.k is not None:
            c = rotor.coordinate
            per_spin = g.mul(rotor.inertia, rotor.ratio)
            own[c][c] = g.add(own[c][c], g.mul(per_spin, rotor.ratio))
            if rotor.carrier != BASE:
                wrenches[c] = wrenches[c] + Wrench(Vec3(g), rotor.axis.scaled(per_spin))
    return _Coupling(own, wrenches)


def _power(column: Column, wrench: Wrench) -> Edge:
    return wrench.f.g.add(column.w.dot(wrench.n), column.v.dot(wrench.f))


def _wrench_carried(link: MovingLink, wrench: Wrench) -> Wrench:
    """From Lo, in L, to Ao, in A (eq. 11)."""
    f = link.R_AL.apply(wrench.f)
    return Wrench(f, link.R_AL.apply(wrench.n) + link.p_AL.cross(f))


def _acceleration_carried(link: MovingLink, x: Acceleration) -> Acceleration:
    """Of the parent -> what of it the link takes over, but for speeds (eqs. 7, 8)."""
    return Acceleration(link.R_AL.apply_inverse(x.alpha), link.R_AL.apply_inverse(x.a + x.alpha.cross(link.p_AL)))
