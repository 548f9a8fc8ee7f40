"""Poses and Jacobians of a tree's links in many digits, from the charts that an engine says it keeps its joints in."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from decimal import Decimal
from typing import NamedTuple

import numpy as np

from ..interface import Constraint, End, HasLayout, Joint, Link, Slot, Tendon, Tree, Wrap
from .arithmetic import (
    Exact,
    arc,
    cross,
    exact,
    eye,
    many_digits,
    orthonormal,
    rate,
    root,
    skew,
    stack,
    vee,
    zeros,
)
from .charts import CHARTS, GEOMETRIES, Pose

_REMEMBERED = 1000


class Held(NamedTuple):
    """A frame in the world, with the Jacobian (6, nv) of its origin along world axes."""

    R: Exact
    p: Exact
    J: Exact


class Kinematics:
    """Kinematics of a tree in an engine's coordinates and speeds.

    Args:
        tree: The tree.
        model: Says how the engine keeps its joints.
        roundings: Of each link, parts (L, 3) of its position in the world that it is off by; None for none.
    """

    def __init__(self, tree: Tree, model: HasLayout, roundings: Exact | None = None) -> None:
        self.tree, self.slots, self._roundings = tree, model.slots, roundings
        self.nq, self.nv = model.nq, model.nv
        # Speeds that are no rates of coordinates.
        self.curved = sorted(
            {v for own in model.slots for slot in own if not CHARTS[slot.chart].is_flat for v in slot.v}
        )
        self._places = {link.name: k for k, link in enumerate(tree.links)}
        with many_digits():
            self._placements = [
                [(orthonormal(joint.R), exact(joint.p)) for joint in link.joints] for link in tree.links
            ]
        # Differences ask for the same joint at the same coordinates again and again.
        self._frames: dict[tuple[object, ...], list[tuple[Exact, Exact, Exact]]] = {}
        self._motions: dict[tuple[object, ...], tuple[Exact, Exact, list[tuple[Exact, Exact]]]] = {}

    def joints(self, index: int) -> Iterator[tuple[Joint, Slot | None]]:
        """Joints of a link with their slots; fixed and locked ones have none."""
        slots = iter(self.slots[index])
        for joint in self.tree.links[index].joints:
            still = joint.kind == "fixed" or joint.locked is not None
            yield joint, None if still else next(slots)

    def moving(self) -> Iterator[tuple[Joint, Slot]]:
        """Joints that move by themselves, with their slots."""
        for index in range(len(self.tree.links)):
            for joint, slot in self.joints(index):
                if slot is not None and not joint.mimics:
                    yield joint, slot

    def rates(self, q: Exact) -> Exact:
        """N (nq, nv) with q' = N v."""
        N = zeros(self.nq, self.nv)
        for joint, slot in self.moving():
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

    def held(self, q: Exact, end: End) -> Held:
        """A frame of a link, or of the world."""
        if not end.link:
            return Held(orthonormal(end.R), exact(end.p), zeros(6, self.nv))
        index = self._places[end.link]
        R, p, J = self._links(q)[index]
        offset = R @ exact(end.p)
        return Held(R @ orthonormal(end.R), p + offset, np.concatenate([J[:3] - skew(offset) @ J[3:], J[3:]]))

    def line(self, q: Exact, line: Tendon | Constraint) -> tuple[Exact, Exact]:
        """Length of a "coupling", a "polynomial" or a "path", and its derivative (nv) along the speeds."""
        length, J = Decimal(0), zeros(self.nv)
        if line.kind == "polynomial":
            (driven,), (driver,) = (self.slots[self._places[end.link]] for end in line.ends)
            x, coefficients = q[driver.q[0]], exact(line.coefficients)
            length, J[driven.v[0]] = q[driven.q[0]], Decimal(1)
            for power, coefficient in enumerate(coefficients):
                length = length - coefficient * x**power
                J[driver.v[0]] -= power * coefficient * x ** (power - 1) if power else 0
            return length, J
        if line.kind == "coupling":
            for end, coefficient in zip(line.ends, exact(line.coefficients), strict=True):
                (slot,) = self.slots[self._places[end.link]]
                length, J[slot.v[0]] = length + coefficient * q[slot.q[0]], J[slot.v[0]] + coefficient
            return length, J
        wraps = {wrap.after: wrap for wrap in line.wraps} if isinstance(line, Tendon) else {}
        points = [self.held(q, end) for end in line.ends]
        for number, (before, after) in enumerate(zip(points, points[1:], strict=False)):
            if number in wraps:
                own, arms = self._wrapped(q, line.ends[number], wraps[number], line.ends[number + 1])
                length, J = length + own, J + arms
                continue
            step = after.p - before.p
            distance = root(step @ step)
            length, J = length + distance, J + (step / distance) @ (after.J[:3] - before.J[:3])
        return length, J

    def seen(self, q: Exact, end: End, frame: Held) -> tuple[Exact, Exact]:
        """Position of a frame's point in another frame (3), and its derivative (3, nv)."""
        point = self.held(q, end)
        apart = point.p - frame.p
        return frame.R.T @ apart, frame.R.T @ (point.J[:3] - frame.J[:3] + skew(apart) @ frame.J[3:])

    def _wrapped(self, q: Exact, first: End, wrap: Wrap, second: End) -> tuple[Exact, Exact]:
        """Length of a line that is tight around a surface, and its derivative (nv): by differences of the length."""
        frame, radius = self.held(q, wrap.end), exact(wrap.radius)[()]
        (a, at_a), (b, at_b) = (self.seen(q, end, frame) for end in (first, second))

        side = exact(wrap.side) if wrap.side else None

        def length(points: Exact) -> Exact:
            return np.array([around(points[:3], points[3:], radius, wrap.is_sphere, side)], dtype=object)

        points, unit = np.concatenate([a, b]), eye(6)
        slopes = np.array([rate(length, points, unit[k])[0] for k in range(6)], dtype=object)
        return length(points)[0], slopes @ np.concatenate([at_a, at_b])

    def _links(self, q: Exact, with_jacobians: bool = True) -> list[tuple[Exact, Exact, Exact]]:
        """R, p and Jacobian of each link; what depends on them must not be changed in place."""
        key = (tuple(q), with_jacobians)
        if key not in self._frames:
            if len(self._frames) >= _REMEMBERED:
                self._frames.clear()
            self._frames[key] = self._walk(q, with_jacobians)
        return self._frames[key]

    def _walk(self, q: Exact, with_jacobians: bool) -> list[tuple[Exact, Exact, Exact]]:
        frames: list[tuple[Exact, Exact, Exact]] = []
        for index, link in enumerate(self.tree.links):
            start = (eye(3), zeros(3), zeros(6, self.nv if with_jacobians else 0))
            R, p, J = frames[link.parent] if link.parent >= 0 else start
            for number, (joint, slot) in enumerate(self.joints(index)):
                R, p, J = _moved(R, p, J, *self._placements[index][number])
                if joint.locked is not None:
                    R, p, J = _moved(R, p, J, *_locked(joint))
                if slot is not None:
                    R_step, p_step, columns = self._motion(joint, slot, q)
                    R_before = R
                    R, p, J = _moved(R, p, J, R_step, p_step)
                    if with_jacobians:
                        for place, (linear, spin) in zip(slot.v, columns, strict=True):
                            J[:3, place] = J[:3, place] + R_before @ linear
                            J[3:, place] = J[3:, place] + R_before @ spin
            if self._roundings is not None:
                R, p, J = _moved(R, p, J, eye(3), R.T @ (self._roundings[index] * p))
            frames.append((R, p, J))
        return frames

    def _motion(self, joint: Joint, slot: Slot, q: Exact) -> tuple[Exact, Exact, list[tuple[Exact, Exact]]]:
        """Placement after a joint, in the frame before it, and its rates by each speed: linear, angular."""
        own = _own(joint, q[list(slot.q)])
        key = (id(joint), tuple(own))
        if key not in self._motions:
            if len(self._motions) >= _REMEMBERED:
                self._motions.clear()
            chart = CHARTS[slot.chart]
            N = chart.rates(joint, own)
            ratio = exact(joint.ratio)[()] if joint.mimics else 1

            def flat(coordinates: Exact) -> Exact:
                R, p = chart.pose(joint, coordinates)
                return np.concatenate([p, R.reshape(9)])

            R, p = chart.pose(joint, own)
            rates = [ratio * rate(flat, own, N[:, k]) for k in range(chart.nv)]
            columns = [(column[:3], vee(column[3:].reshape(3, 3) @ R.T)) for column in rates]
            self._motions[key] = (R, p, columns)
        return self._motions[key]


def around(a: Exact, b: Exact, radius: Exact, is_sphere: bool, side: Exact | None = None) -> Exact:
    """The shortest way from a to b around a sphere about the origin, or a cylinder about z; straight where it can be.

    Of a sphere it lies in the plane of a, b and the centre: two tangents, and between them a part of a circle. A
    cylinder unrolls: the way across z is that around a circle, and the rise along z makes a right triangle with it.
    Where a point `side` is given, the way passes on its side in that plane, though the other be shorter.
    """
    rise = (b - a) if is_sphere else (b - a)[2:]
    flat_a, flat_b = (a, b) if is_sphere else (a[:2], b[:2])
    squares = [one @ one - radius * radius for one in (flat_a, flat_b)]
    if min(squares) <= 0:  # What begins inside is not held by the surface.
        return root((b - a) @ (b - a))
    tangents = [root(square) for square in squares]
    normal = cross(a, b) if is_sphere else np.array([flat_a[0] * flat_b[1] - flat_a[1] * flat_b[0]])
    between = arc(flat_a @ flat_b, root(normal @ normal))
    tangent_arcs = sum(arc(radius, one) for one in tangents)
    rest = between - tangent_arcs
    if side is not None and _is_beyond(flat_a, flat_b, side, normal):
        rest = 2 * _half_turn() - between - tangent_arcs
    if rest <= 0:
        return root((b - a) @ (b - a))
    way = sum(tangents) + radius * rest
    return way if is_sphere else root(way * way + rise @ rise)


def _is_beyond(a: Exact, b: Exact, side: Exact, normal: Exact) -> bool:
    """Whether a point is on the other side of the centre than the nearest point from a to b, in their plane."""
    flat = side[: len(a)] if len(a) == 2 else side - normal * (normal @ side) / (normal @ normal)
    along = b - a
    part = min(max(-(a @ along) / (along @ along), Decimal(0)), Decimal(1))
    return bool((a + part * along) @ flat < 0)


def _half_turn() -> Exact:
    return arc(Decimal(-1), Decimal(0))


def _locked(joint: Joint) -> Pose:
    """Placement after a joint that moves no more."""
    return CHARTS[GEOMETRIES[joint.kind]].pose(joint, exact([joint.locked]))


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
