"""Truth of what links carry, of wholes of trees, and of links as other links see them."""

from __future__ import annotations

from decimal import Decimal

import numpy as np

from .arithmetic import Exact, cross, exact, eye, orthonormal, root, skew, zeros
from .derived import Frame, TruthOf, classical, com, com_jacobian, joint_wrenches, unit_inertias
from .dynamics import Point, Truth


def centre_velocity(truth: Truth, s: Point) -> Exact:
    """Velocity of the mass centre (3)."""
    return com_jacobian(truth, s.q) @ s.v


def centre_acceleration(truth: Truth, s: Point) -> Exact:
    """Acceleration of the mass centre (3)."""
    turning = truth.kinematics.along(lambda q: com_jacobian(truth, q), s.q, s.v)
    return com_jacobian(truth, s.q) @ s.a + turning @ s.v


def _gathered(truth: Truth, own: list[Exact]) -> list[Exact]:
    """Sums over each link and all that it carries."""
    sums = list(own)
    for k, link in reversed(list(enumerate(truth.tree.links))):
        if link.parent >= 0:
            sums[link.parent] = sums[link.parent] + sums[k]
    return sums


def subtree_masses(truth: Truth, s: Point) -> Exact:
    """Masses of each link with all it carries (L)."""
    return np.array(_gathered(truth, [inertia.mass for inertia in truth.inertias]), dtype=object)


def _centres(truth: Truth, q: Exact) -> Exact:
    firsts = [i.mass * p + R @ i.first for i, (R, p) in zip(truth.inertias, truth.kinematics.poses(q), strict=True)]
    masses = _gathered(truth, [inertia.mass for inertia in truth.inertias])
    return np.array([x / m for x, m in zip(_gathered(truth, firsts), masses, strict=True)], dtype=object)


def subtree_centres(truth: Truth, s: Point) -> Exact:
    """Mass centres of each link with all it carries (L, 3)."""
    return _centres(truth, s.q)


def subtree_jacobians(truth: Truth, s: Point) -> Exact:
    """Their Jacobians (L, 3, nv)."""
    return truth.kinematics.tangent(lambda q: _centres(truth, q), s.q)


def subtree_velocities(truth: Truth, s: Point) -> Exact:
    """Velocities of these mass centres (L, 3)."""
    return subtree_jacobians(truth, s) @ s.v


def subtree_accelerations(truth: Truth, s: Point) -> Exact:
    """Their accelerations (L, 3)."""
    return (
        subtree_jacobians(truth, s) @ s.a
        + truth.kinematics.along(lambda q: subtree_jacobians(truth, s._replace(q=q)), s.q, s.v) @ s.v
    )


def total_mass(truth: Truth, s: Point) -> Exact:
    """Mass of the tree (1)."""
    return np.array([sum(inertia.mass for inertia in truth.inertias)])


def centroidal_inertia(truth: Truth, s: Point) -> Exact:
    """Momentum of the tree as one body about its mass centre for twists there, along the world's axes (6, 6)."""
    centre, total = com(truth, s.q), zeros(6, 6)
    for inertia, (R, p) in zip(truth.inertias, truth.kinematics.poses(s.q), strict=True):
        shift = np.block([[eye(3), -skew(p - centre)], [zeros(3, 3), eye(3)]])
        total = total + shift.T @ inertia.turned(R).matrix() @ shift
    return total


# A point of the world that distances are from.
AFAR = (4.0, -8.0, 8.0)


def distances(truth: Truth, s: Point) -> Exact:
    """Distances of the links' origins from `AFAR` (L)."""
    apart = [p - exact(AFAR) for _, p in truth.kinematics.poses(s.q)]
    return np.array([root(x @ x) for x in apart])


def carried_inertias(truth: Truth, s: Point) -> Exact:
    """Momentum of each link with all it carries, as one body, for twists at its origin along its axes (L, 6, 6)."""
    poses, about_world = truth.kinematics.poses(s.q), []
    for inertia, (R, p) in zip(truth.inertias, poses, strict=True):
        shift = np.block([[eye(3), -skew(p)], [zeros(3, 3), eye(3)]])
        about_world.append(shift.T @ inertia.turned(R).matrix() @ shift)
    rows = []
    for (R, p), whole in zip(poses, _gathered(truth, about_world), strict=True):
        there = np.block([[R, skew(p) @ R], [zeros(3, 3), R]])
        rows.append(there.T @ whole @ there)
    return np.array(rows)


def link_regressors(truth: Truth, s: Point) -> Exact:
    """Y (L, 6, 10): what moves each link against gravity, at its origin along its axes, is Y its parameters."""
    motions, poses = truth.motions(s.q, s.v, s.a), truth.kinematics.poses(s.q)
    columns = []
    for inertia in unit_inertias():
        wrenches = truth.wrenches(motions, poses, [inertia] * len(poses))
        turned = [np.concatenate([R.T @ wrenches[k][:3], R.T @ wrenches[k][3:]]) for k, (R, _) in enumerate(poses)]
        columns.append(np.array(turned))
    return np.stack(columns, axis=-1)


def static_regressor(truth: Truth, s: Point) -> Exact:
    """Y (3, 4 L): the mass centre is Y (m, m c of each link), as the whole mass stays."""
    whole = sum(inertia.mass for inertia in truth.inertias)
    return np.concatenate([np.column_stack([p, R]) for R, p in truth.kinematics.poses(s.q)], axis=1) / whole


def energy(truth: Truth, s: Point) -> Exact:
    """Kinetic and potential energy together."""
    return truth.T(s.q, s.v) + truth.V(s.q)


def driven(truth: Truth, s: Point) -> Exact:
    """Accelerations of links (L, 6) at those that the forces make."""
    return classical(truth, s.q, s.v, truth.FD(s.q, s.v, s.tau))


def coordinate_rates(truth: Truth, s: Point) -> Exact:
    """N v (nq)."""
    return truth.kinematics.rates(s.q) @ s.v


def squared_distance(truth: Truth, s: Point) -> Exact:
    """The square of v2, which leads from q to where it ends (1)."""
    return np.array([s.v2 @ s.v2], dtype=object)


def relative_poses(truth: Truth, s: Point) -> Exact:
    """Positions and rows of R of links in the first link (L, 12)."""
    (A, x), *_ = poses = truth.kinematics.poses(s.q)
    return np.array([np.concatenate([A.T @ (p - x), (A.T @ R).reshape(9)]) for R, p in poses])


def _relative(truth: Truth, q: Exact) -> Exact:
    poses, jacobians = truth.kinematics.poses(q), truth.kinematics.jacobians(q)
    (A, x), base = poses[0], jacobians[0]
    rows = []
    for (_, p), J in zip(poses, jacobians, strict=True):
        linear = J[:3] - base[:3] + skew(p - x) @ base[3:]
        rows.append(np.concatenate([A.T @ linear, A.T @ (J[3:] - base[3:])]))
    return np.array(rows, dtype=object)


def relative_jacobians(truth: Truth, s: Point) -> Exact:
    """Jacobians of links' origins as the first link sees them, along its axes (L, 6, nv)."""
    return _relative(truth, s.q)


def relative_velocities(truth: Truth, s: Point) -> Exact:
    """Velocities of links as the first link sees them, along its axes (L, 6)."""
    return _relative(truth, s.q) @ s.v


def relative_accelerations(truth: Truth, s: Point) -> Exact:
    """Accelerations of links' origins as the first link sees them, and angular ones, along its axes (L, 6)."""
    return _relative(truth, s.q) @ s.a + truth.kinematics.along(lambda q: _relative(truth, q), s.q, s.v) @ s.v


def bodies(truth: Truth, s: Point) -> Exact:
    """Mass, first moment, moments about the mass centre (L, 10) of each link, as it is stated."""
    places, rows = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)), []
    for inertia, link in zip(truth.inertias, truth.tree.links, strict=True):
        stated = exact(link.inertia)
        rows.append(np.array([inertia.mass, *inertia.first, *(stated[place] for place in places)]))
    return np.array(rows)


def base_wrench(truth: Truth, s: Point) -> Exact:
    """What the world exerts on the first links, about its origin along its axes (6)."""
    held, total = joint_wrenches(truth, s), zeros(6)
    for link, own, (R, p) in zip(truth.tree.links, held, truth.kinematics.poses(s.q), strict=True):
        if link.parent < 0:
            force = R @ own[:3]
            total = total + np.concatenate([force, R @ own[3:] + cross(p, force)])
    return total + Decimal(0)


def placement_regressor(frame: Frame) -> TruthOf:
    """Twists of the links in a frame for those of each link's placement, along the axes that it places (L, 6, 6 L).

    A placement is what stands before the first joint that moves a link.
    """

    def function(truth: Truth, s: Point) -> Exact:
        poses, links = truth.kinematics.poses(s.q), truth.tree.links
        rows = zeros(len(links), 6, 6 * len(links))
        for place, link in enumerate(links):
            R, p = poses[link.parent] if link.parent >= 0 else (eye(3), zeros(3))
            for joint in link.joints:
                R, p = R @ orthonormal(joint.R), p + R @ exact(joint.p)
                if joint.kind != "fixed":
                    break
            for k, (R_k, p_k) in enumerate(poses):
                if place not in _above(truth, k):
                    continue
                at = {"local": p_k, "aligned": p_k, "world": zeros(3)}[frame]
                twists = np.block([[R, -skew(at - p) @ R], [zeros(3, 3), R]])
                own = R_k.T if frame == "local" else eye(3)
                rows[k][:, 6 * place : 6 * place + 6] = np.concatenate([own @ twists[:3], own @ twists[3:]])
        return rows

    return function


def _above(truth: Truth, k: int) -> set[int]:
    """A link and those that carry it."""
    own = {k}
    while (k := truth.tree.links[k].parent) >= 0:
        own.add(k)
    return own
