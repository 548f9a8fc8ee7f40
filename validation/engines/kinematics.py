"""Poses and Jacobians of a tree's links in many digits, from the charts that an engine says it keeps its joints in."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from validation.engines.arithmetic import Exact, exact, eye, rate, skew, stack, vee, zeros
from validation.engines.charts import CHARTS, Pose
from validation.engines.interface import EngineModel, Joint, Link, Slot, Tree


class Kinematics:
    """Kinematics of a tree in an engine's coordinates and speeds.

    Args:
        tree: The tree.
        model: Says how the engine keeps its joints.
    """

    def __init__(self, tree: Tree, model: EngineModel) -> None:
        self.tree, self.slots = tree, model.slots
        self.nq, self.nv = model.nq, model.nv

    def joints(self, index: int) -> Iterator[tuple[Joint, Slot | None]]:
        """Joints of a link with their slots; those of kind "fixed" have none."""
        slots = iter(self.slots[index])
        for joint in self.tree.links[index].joints:
            yield joint, None if joint.kind == "fixed" else next(slots)

    def rates(self, q: Exact) -> Exact:
        """N (nq, nv) with q' = N v."""
        N = zeros(self.nq, self.nv)
        for index in range(len(self.tree.links)):
            for joint, slot in self.joints(index):
                if slot is not None and not joint.mimics:
                    N[np.ix_(slot.q, slot.v)] = CHARTS[slot.chart].rates(joint, q[list(slot.q)])
        return N

    def along(self, function: Callable[[Exact], Exact], q: Exact, v: Exact) -> Exact:
        """The rate of a function of q as the tree moves with speeds v."""
        return rate(function, q, self.rates(q) @ v)

    def tangent(self, function: Callable[[Exact], Exact], q: Exact) -> Exact:
        """The derivatives of a function of q along each speed, along a new last axis (..., nv)."""
        N = self.rates(q)
        return stack([rate(function, q, N[:, k]) for k in range(self.nv)])

    def poses(self, q: Exact) -> list[Pose]:
        """R_WL and p_WL of each link."""
        return [(R, p) for R, p, _ in self._links(q, with_jacobians=False)]

    def flat_poses(self, q: Exact) -> Exact:
        """Positions and rows of R (L, 12)."""
        return np.array([np.concatenate([p, R.reshape(9)]) for R, p in self.poses(q)], dtype=object)

    def jacobians(self, q: Exact) -> Exact:
        """Jacobians of the links' origins, along world axes: linear, then angular (L, 6, nv)."""
        return np.array([J for _, _, J in self._links(q)], dtype=object)

    def _links(self, q: Exact, with_jacobians: bool = True) -> list[tuple[Exact, Exact, Exact]]:
        frames: list[tuple[Exact, Exact, Exact]] = []
        for index, link in enumerate(self.tree.links):
            start = (eye(3), zeros(3), zeros(6, self.nv))
            R, p, J = frames[link.parent] if link.parent >= 0 else start
            for joint, slot in self.joints(index):
                R, p, J = _moved(R, p, J, exact(joint.R), exact(joint.p))
                if slot is not None:
                    R_step, p_step = self._pose(joint, slot, q)
                    R_before = R
                    R, p, J = _moved(R, p, J, R_step, p_step)
                    if with_jacobians:
                        self._add_columns(J, joint, slot, q, R_before, R_step)
            frames.append((R, p, J))
        return frames

    def _pose(self, joint: Joint, slot: Slot, q: Exact) -> Pose:
        return CHARTS[slot.chart].pose(joint, _own(joint, q[list(slot.q)]))

    def _add_columns(self, J: Exact, joint: Joint, slot: Slot, q: Exact, R_before: Exact, R_step: Exact) -> None:
        own = _own(joint, q[list(slot.q)])
        chart = CHARTS[slot.chart]
        N = chart.rates(joint, own)

        def flat(coordinates: Exact) -> Exact:
            R, p = chart.pose(joint, coordinates)
            return np.concatenate([p, R.reshape(9)])

        for k, place in enumerate(slot.v):
            column = rate(flat, own, N[:, k])
            if joint.mimics:
                column = exact(joint.ratio) * column
            spin = vee(column[3:].reshape(3, 3) @ R_step.T)
            J[:3, place] = J[:3, place] + R_before @ column[:3]
            J[3:, place] = J[3:, place] + R_before @ spin


def _own(joint: Joint, q: Exact) -> Exact:
    """Coordinates of a joint: those of the one that it mimics, turned into its own."""
    return exact(joint.ratio) * q + exact(joint.offset) if joint.mimics else q


def _moved(R: Exact, p: Exact, J: Exact, R_step: Exact, p_step: Exact) -> tuple[Exact, Exact, Exact]:
    """A frame placed in another, with the Jacobian of a point that is fixed in it."""
    offset = R @ p_step
    shifted = np.concatenate([J[:3] - skew(offset) @ J[3:], J[3:]])
    return R @ R_step, p + offset, shifted


class Inertia:
    """A link's inertia about its origin, along its axes; dynamics are linear in it.

    Attributes:
        mass: Mass.
        first: Mass times mass centre (3).
        second: Moments of inertia about the origin (3, 3).
    """

    def __init__(self, mass: Exact, first: Exact, second: Exact) -> None:
        self.mass, self.first, self.second = mass, first, second

    @staticmethod
    def of(link: Link) -> Inertia:
        """The inertia that a link states about its mass centre."""
        mass, com = exact(link.mass)[()], exact(link.com)
        offset = skew(com)
        return Inertia(mass, mass * com, exact(link.inertia) - mass * (offset @ offset))

    def turned(self, R: Exact) -> Inertia:
        """The same along other axes."""
        return Inertia(self.mass, R @ self.first, R @ self.second @ R.T)

    def matrix(self) -> Exact:
        """The matrix (6, 6) of momentum about the origin: linear, then angular."""
        offset = skew(self.first)
        return np.block([[self.mass * eye(3), -offset], [offset, self.second]])
