"""Derivatives of the acceleration of rigid trees by articulated bodies (docs/theory/linear.md, section 10).

What the routine `responses` needs of each speed, seen from the origin of the first link on the way from the base: the
elimination that forward dynamics makes, and what a unit of the coordinate and of the speed changes beyond its joint.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.vector import Mat3, Vec3
from symofros.mechanics.dynamics.acceleration import Acceleration, base_motion, base_to_tip
from symofros.mechanics.dynamics.applied.forces import rates_per_speed
from symofros.mechanics.dynamics.derivatives.flows import Flow, origin_velocities, own_flows
from symofros.mechanics.dynamics.derivatives.variations import JointVariations, Variation
from symofros.mechanics.dynamics.forward.free_joint import FreeJoint
from symofros.mechanics.dynamics.jourdain import link_wrenches, subtree_wrenches
from symofros.mechanics.dynamics.mass_matrix import Matrix
from symofros.mechanics.kinematics.links import TreeKinematics
from symofros.mechanics.spatial.inertia import LinkInertia
from symofros.mechanics.spatial.wrench import Wrench
from symofros.mechanics.topology.tree import BASE


@dataclass(frozen=True)
class Responses:
    """What the derivatives of the acceleration consist of.

    Attributes:
        steps: Of each speed -G (6), s (6), -h (3) and -1 / D (nv x 16).
        fields: Of each speed, by q and by v: wrench (6), acceleration (6) and w (3) (nv x 30).
        turned: Changes of the balances by what a joint's own coordinates change of its partial velocities (nv x nv).
        parents: Speed before each on the way to the base; -1 for none.
        firsts: First speed of the joint of each.
    """

    steps: Matrix
    fields: Matrix
    turned: Matrix
    parents: tuple[int, ...]
    firsts: tuple[int, ...]


class DirectChange(NamedTuple):
    """Change of the balance of speed `row` by a column of the derivatives by q, v or u (`by` is 0, 1, 2)."""

    row: int
    by: int
    column: int
    edge: Edge


def changes_tables(changes: Sequence[DirectChange], nv: int) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Index of the first change of each row, and of the end; and of each change `by` and its column."""
    begin = tuple(bisect_left(changes, (k,)) for k in range(nv + 1))
    return begin, tuple(place for change in changes for place in (change.by, change.column))


def responses(
    kinematics: TreeKinematics,
    inertias: list[LinkInertia],
    joints: Sequence[FreeJoint],
    v_rate: Sequence[Edge],
    gravity: Vec3,
) -> Responses:
    """Responses of a rigid tree.

    Args:
        kinematics: Kinematics of the tree.
        inertias: Inertia of each link, not regrouped.
        joints: Each joint with everything beyond it articulated.
        v_rate: v' (nv), which stays as it is.
        gravity: Acceleration of gravity in the world.
    """
    g, nv = kinematics.g, kinematics.nv
    base, motions = base_motion(gravity), base_to_tip(kinematics, v_rate, gravity)
    velocities, directions = origin_velocities(kinematics, motions), rates_per_speed(kinematics)
    wrenches = dict(subtree_wrenches(kinematics, link_wrenches(kinematics, inertias, [], motions, v_rate)[0]))
    turning = _turning_bodies(kinematics, joints, own_flows(inertias, motions, velocities))
    steps: Matrix = [[ZERO] * 15 + [-ONE] for _ in range(nv)]
    fields: Matrix = [[ZERO] * 30 for _ in range(nv)]
    turned: Matrix = [[ZERO] * nv for _ in range(nv)]
    parents, firsts, last = [-1] * nv, list(range(nv)), dict[int, int]()
    views = _views(kinematics)
    for i, link in enumerate(kinematics.links):
        view, joint, before = views[i], joints[i], last.get(link.parent, -1)
        parent = base if link.parent == BASE else motions[link.parent]
        of_joint = JointVariations(link, directions, parent, motions[i], velocities[i], v_rate)
        for k, partial in enumerate(link.free_partial_velocities):
            row = link.first_speed + k
            parents[row], firsts[row], before = before, link.first_speed, row
            G, h = joint.ratios[k], Vec3(g, *turning[i].forces[k]).scaled(joint.inverses[k])
            G_K, s_K = view.wrench(Vec3(g, *G[:3]), Vec3(g, *G[3:6])), view.motion(partial.v, partial.w)
            steps[row] = [*(-edge for edge in G_K), *s_K, *-view.R_KL.times(h), -joint.inverses[k]]
            total = wrenches[i]
            turn = Wrench(partial.w.cross(total.f), partial.w.cross(total.n) + partial.v.cross(total.f))
            for j in range(len(link.free_partial_velocities)):
                turned[link.first_speed + j][row] = of_joint.power_change(j, k, total)
            by_q, by_v = of_joint.by_coordinate(k), of_joint.by_speed(k)
            fields[row] = [
                *_field(view, joint, turning[i], by_q, turn),
                *_field(view, joint, turning[i], by_v, Wrench(Vec3(g), Vec3(g))),
            ]
        last[i] = before
    return Responses(steps, fields, turned, tuple(parents), tuple(firsts))


@dataclass(frozen=True)
class _View:
    """A link seen from the origin and in the axes of the first link K on its way from the base: R_KL, p_KL in K."""

    R_KL: Mat3
    p_KL: Vec3

    def motion(self, a: Vec3, alpha: Vec3) -> list[Edge]:
        """Acceleration of Lo and angular acceleration in L -> those of Ko in K."""
        alpha = self.R_KL.times(alpha)
        return [*(self.R_KL.times(a) + self.p_KL.cross(alpha)), *alpha]

    def wrench(self, f: Vec3, n: Vec3) -> list[Edge]:
        """Wrench about Lo, in L -> about Ko, in K."""
        f = self.R_KL.times(f)
        return [*f, *(self.R_KL.times(n) + self.p_KL.cross(f))]


def _views(kinematics: TreeKinematics) -> list[_View]:
    g = kinematics.g
    views: list[_View] = []
    for link in kinematics.links:
        if link.parent == BASE:
            views.append(_View(Mat3.identity(g), Vec3(g)))
        else:
            of_A = views[link.parent]
            views.append(_View(link.R_AL.after(of_A.R_KL), of_A.p_KL + of_A.R_KL.times(link.p_AL)))
    return views


@dataclass(frozen=True)
class _TurningBody:
    """What a field of accelerations 2 w x V of a body and all beyond it takes, the joints free, per unit of w, in L.

    Attributes:
        wrenches: f, n on the link, once its own joint is free, too (6 x 3).
        forces: Forces on the speeds of its joint (n x 3).
    """

    wrenches: list[list[Edge]]
    forces: list[list[Edge]]


def _turning_bodies(
    kinematics: TreeKinematics, joints: Sequence[FreeJoint], flows: Sequence[Flow]
) -> dict[int, _TurningBody]:
    """Turning body of each link, from the flows of links by themselves (eq. 33)."""
    g = kinematics.g
    f = [_cross_matrix(-flow.P) for flow in flows]
    n = [flow.about_axes() for flow in flows]
    bodies: dict[int, _TurningBody] = {}
    for i, link in reversed(list(enumerate(kinematics.links))):
        rows = [[*matrix.row(k)] for matrix in (f[i], n[i]) for k in range(3)]
        for partial in link.free_partial_velocities:
            factors = (*partial.v, *partial.w)
            rows.append([g.sum(g.mul(x, row[c]) for x, row in zip(factors, rows[:6], strict=True)) for c in range(3)])
        for k in reversed(range(6, len(rows))):
            for row, ratio in zip(rows[:k], joints[i].ratios[k - 6], strict=True):
                row[:] = [g.sub(x, g.mul(ratio, y)) for x, y in zip(row, rows[k], strict=True)]
        bodies[i] = _TurningBody(rows[:6], rows[6:])
        if link.parent != BASE:
            force, moment = (link.R_AL.conjugate_any(_matrix(g, rows[at : at + 3])) for at in (0, 3))
            shift = Mat3.from_columns(g, [link.p_AL.cross(force.column(c)) for c in range(3)])
            f[link.parent], n[link.parent] = f[link.parent] + force, n[link.parent] + (moment + shift)
    return bodies


def _field(view: _View, joint: FreeJoint, body: _TurningBody, change: Variation, turn: Wrench) -> list[Edge]:
    """Wrench on what carries the joint (6), acceleration (6) and w (3) of one column (eq. 34)."""
    g = change.w.g
    f, n = (_matrix(g, body.wrenches[at : at + 3]).times(change.w) for at in (0, 3))
    wrench = joint.body.inertia.times(Acceleration(change.alpha, change.a)) + Wrench(f, n) + turn
    return [*view.wrench(wrench.f, wrench.n), *view.motion(change.a, change.alpha), *view.R_KL.times(change.w)]


def _cross_matrix(p: Vec3) -> Mat3:
    """[p], with [p] x = p x x."""
    return Mat3(p.g, (ZERO, -p.z, p.y, p.z, ZERO, -p.x, -p.y, p.x, ZERO))


def _matrix(g: Graph, rows: Sequence[Sequence[Edge]]) -> Mat3:
    return Mat3(g, tuple(edge for row in rows for edge in row))
