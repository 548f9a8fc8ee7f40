"""Which part of one file is which of the other, and by which displacement it lies on it.

A displacement T turns places at zero coordinates of the second file into those of the first. The zero of a joint's
coordinate may be elsewhere in the two, and its axis may have the other sign: q = sign q' + offset.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from symofros.base.arrays import Array
from symofros.base.rotations import axis_rotation
from symofros.description import Pose
from symofros.studio.differences.mechanism import Body, Mechanism, Move, moved

# Pairs of joints of one body that are weighed against each other; of more, names and order decide.
_MOST_PAIRS = 2500
# What speaks against a pair of joints. A name weighs less than any fact: files name twins as they like.
_KIND, _COUNT, _LINE, _MASS, _CENTER, _JOINT_NAME, _LINK_NAME, _ENTRIES = 4.0, 3.0, 2.0, 1.0, 1.0, 0.5, 0.25, 0.1
# Joints beyond a part, that distinguish ways which all agree at the part itself.
_DEPTH = 4
# Rounding of an inertia whose mass centre is moved, of its mass times the square of the mechanism's size.
_STEINER = 1e-14


@dataclass(frozen=True)
class Close:
    """When numbers of two files are the same.

    Attributes:
        tolerance: Relative one, against the size of what is compared.
        size: Length of the mechanism [m].
    """

    tolerance: float
    size: float

    def numbers(self, a: float, b: float) -> bool:
        """Two numbers by their own size."""
        return a == b or abs(a - b) <= self.tolerance * max(abs(a), abs(b))

    def points(self, a: Array, b: Array) -> bool:
        """Two positions."""
        return bool(np.abs(a - b).max() <= self.tolerance * self.size)

    def directions(self, a: Array, b: Array) -> bool:
        """Unit vectors, or rotations."""
        return bool(np.abs(a - b).max() <= self.tolerance)

    def poses(self, a: Pose, b: Pose) -> bool:
        """Two frames."""
        return self.points(a.p, b.p) and self.directions(a.R, b.R)

    def inertias(self, a: Array, b: Array, mass: float) -> bool:
        """Whether moments of inertia agree."""
        slack = self.tolerance * max(np.abs(a).max(), np.abs(b).max()) + _STEINER * abs(mass) * self.size**2
        return bool(np.abs(a - b).max() <= slack)


class Alignment(NamedTuple):
    """How what a joint carries lies on its counterpart.

    Attributes:
        T: Displacement from the second file's places to the first's.
        sign: -1 where the axis points the other way.
        offset: Coordinate in the first file where that in the second is zero [rad or m].
        is_moved: Whether the joint's frame is elsewhere, with all that it carries.
        has_line: Whether its axis, or centre, is the same before it is moved.
        is_remapped: Whether coordinates of a ball or a free joint begin at another pose.
    """

    T: Pose
    sign: float = 1.0
    offset: float = 0.0
    is_moved: bool = False
    has_line: bool = True
    is_remapped: bool = False


class Alignments:
    """Alignment of two mechanisms.

    Args:
        a: First.
        b: Second.
        close: When numbers are the same.
    """

    def __init__(self, a: Mechanism, b: Mechanism, close: Close) -> None:
        self.a, self.b, self.close = a, b, close
        self._totals = [[m.total(k) for k in range(len(m.parts))] for m in (a, b)]
        self._names = [{part.move.name for part in m.parts if part.move is not None} for m in (a, b)]
        self._below = [_below(m) for m in (a, b)]
        self._frames = [_named_frames(m) for m in (a, b)]

    def pairs(self, c: int, d: int, T: Callable[[int], Pose]) -> list[tuple[int, int]]:
        """The joints on two parts in pairs, the most alike first; those that are left over have none.

        Args:
            c: Part of the first.
            d: Part of the second.
            T: Displacement of what a joint of the second hangs on, by its part.
        """
        ours, theirs = self.a.parts[c].children, self.b.parts[d].children
        if len(ours) * len(theirs) > _MOST_PAIRS:
            named = {self.b.parts[y].move.name: y for y in theirs}  # type: ignore[union-attr]
            known = {x: named.pop(self.a.parts[x].move.name, -1) for x in ours}  # type: ignore[union-attr]
            rest = zip([x for x, y in known.items() if y < 0], named.values(), strict=False)
            return sorted(({x: y for x, y in known.items() if y >= 0} | dict(rest)).items())
        costs = [
            (self._cost(x, y, T(y)) + 1e-6 * abs(i - j), x, y)
            for i, x in enumerate(ours)
            for j, y in enumerate(theirs)
            if not self._are_others(x, y, T(y))
        ]
        taken: list[tuple[int, int]] = []
        left, right = set(ours), set(theirs)
        for _, x, y in sorted(costs):
            if x in left and y in right:
                taken.append((x, y))
                left.remove(x)
                right.remove(y)
        return sorted(taken)

    def _are_others(self, x: int, y: int, T: Pose) -> bool:
        """Whether two joints can't be counterparts: they carry other trees, and neither name nor axis is the same."""
        m, n = self.a.parts[x].move, self.b.parts[y].move
        assert m is not None and n is not None
        if m.name == n.name or self._below[0][x][0] == self._below[1][y][0]:
            return False
        return m.name in self._names[1] or n.name in self._names[0] or not self.has_line(m, n, T)

    def _cost(self, x: int, y: int, T: Pose) -> float:
        m, n = self.a.parts[x].move, self.b.parts[y].move
        assert m is not None and n is not None
        (mass, center, _), (mass2, center2, _) = self._totals[0][x], self._totals[1][y]
        (count, below), (count2, below2) = self._below[0][x], self._below[1][y]
        cost = _KIND * (m.kind != n.kind) + _COUNT * (count != count2) + _JOINT_NAME * (m.name != n.name)
        cost += _LINE * (not self.has_line(m, n, T)) + _MASS * (not self.close.numbers(mass, mass2))
        cost += _MASS * (not self.close.numbers(below, below2))
        cost += _CENTER * (not self._is_reached(m, center, moved(T, center2)))
        # Equal twins that move to opposite sides.
        cost += _ENTRIES * (not np.allclose(_ends(m, 1.0), _ends(n, _sign(m, T.R @ n.axis))))
        return cost + _LINK_NAME * (_first(self.a, x) != _first(self.b, y))

    def _is_reached(self, m: Move, center: Array, other: Array) -> bool:
        """Whether a joint takes one mass centre to another."""
        along = np.array([m.axis @ center, m.axis @ other])
        across = [p - m.point - m.axis * (m.axis @ (p - m.point)) for p in (center, other)]
        if m.kind == "slide":
            return self.close.points(*across)
        if m.kind != "turn":
            return self.close.points(center, other)
        return self.close.points(along[:1], along[1:]) and self.close.points(*map(np.linalg.norm, across))  # type: ignore[arg-type]

    def has_line(self, m: Move, n: Move, T: Pose) -> bool:
        """Whether two joints have the same axis, or centre."""
        if m.kind != n.kind:
            return False
        point, axis = moved(T, n.point), T.R @ n.axis
        if m.kind == "free":
            return True
        if m.kind == "ball":
            return self.close.points(point, m.point)
        if not self.close.directions(m.axis, axis * _sign(m, axis)):
            return False
        across = point - m.point - m.axis * (m.axis @ (point - m.point))
        return m.kind == "slide" or self.close.points(across, np.zeros(3))

    def agreements(self, x: int, y: int, T: Pose) -> list[bool]:
        """What a joint carries, thing by thing: mass centre, inertia, axes of the next joints, named frames."""
        (mass, center, inertia), (mass2, center2, inertia2) = self._totals[0][x], self._totals[1][y]
        seen = []
        if mass and mass2:
            seen += [self.close.points(center, moved(T, center2))]
            seen += [self.close.inertias(inertia, T.R @ inertia2 @ T.R.T, mass)]
        for i, j in self.pairs(x, y, lambda _: T):
            m, n = self.a.parts[i].move, self.b.parts[j].move
            assert m is not None and n is not None
            seen.append(self.has_line(m, n, T))
        theirs = self._frames[1][y]
        return seen + [
            self.close.poses(f, T @ theirs[name]) for name, f in self._frames[0][x].items() if name in theirs
        ]

    def of_joint(self, x: int, y: int, T: Pose, depth: int = _DEPTH) -> Alignment:
        """How what a joint carries lies on its counterpart, where what it hangs on lies by T.

        Args:
            x: Part of the first file that the joint carries.
            y: Part of the second.
            T: Displacement of what carries the joints.
            depth: Number of joints beyond, that distinguish ways which all agree so far.
        """
        m, n = self.a.parts[x].move, self.b.parts[y].move
        assert m is not None and n is not None
        sign, line = _sign(m, T.R @ n.axis), self.has_line(m, n, T)
        stays = self.agreements(x, y, T)
        laid = m.frame @ n.frame.inverse()  # The joints' frames, one on the other.
        if m.kind == "free" or (m.kind == "ball" and line):
            turns = [T, laid] if m.kind == "ball" else [laid, T]
            if not all(self.agreements(x, y, turns[0])):
                turns += [turn for turn in self._registrations(x, y, T) if self.has_line(m, n, turn)]
            most = max(sum(self.agreements(x, y, turn)) for turn in turns)
            ways = [
                Alignment(turn, is_remapped=not self.close.poses(turn, T))
                for turn in turns
                if sum(self.agreements(x, y, turn)) == most
            ]
            return self._best(x, y, ways, depth)
        ways = [Alignment(T, sign)] if line and all(stays) else []
        if ways and self.close.poses(laid, T):
            return ways[0]
        for offset in self._offsets(m, n, x, y, T) if line else ():
            along = displacement(m, -offset) @ T
            if not any(self.close.poses(along, way.T) for way in ways) and all(self.agreements(x, y, along)):
                ways.append(Alignment(along, sign, offset))
        if ways:
            return self._best(x, y, ways, depth)
        if m.kind == n.kind and not self.close.poses(laid, T):
            goes = [self.has_line(m, n, laid), *self.agreements(x, y, laid)]
            if all(goes) or sum(goes) > line + sum(stays):
                return Alignment(laid, _sign(m, laid.R @ n.axis), is_moved=True, has_line=line)
            # The files have other frames: only places tell whether a joint went elsewhere with all that it carries.
            several = len(stays) + 1 - line - sum(stays) > 1
            here = 0 if several or not depth else self._beyond(x, y, T, depth - 1)
            for turn in self._registrations(x, y, T):
                if self.has_line(m, n, turn) and all(self.agreements(x, y, turn)):
                    if several or (depth and self._beyond(x, y, turn, depth - 1) > here):
                        return Alignment(turn, _sign(m, turn.R @ n.axis), is_moved=True, has_line=line)
        return Alignment(T, sign, has_line=line)

    def _best(self, x: int, y: int, ways: list[Alignment], depth: int) -> Alignment:
        """The way by which most beyond a part agrees; the first of several."""
        if len(ways) == 1 or depth == 0:
            return ways[0]
        return max(ways, key=lambda way: self._beyond(x, y, way.T, depth - 1))

    def _beyond(self, x: int, y: int, T: Pose, depth: int) -> int:
        """How many joints beyond a part agree with all that they carry."""
        agree = 0
        for i, j in self.pairs(x, y, lambda _: T):
            way = self.of_joint(i, j, T, 0)
            agree += not way.is_moved and way.has_line and all(self.agreements(i, j, way.T))
            agree += self._beyond(i, j, way.T, depth - 1) if depth else 0
        return agree

    def _registrations(self, x: int, y: int, T: Pose) -> Iterator[Pose]:
        """Displacements that lay a part on its counterpart, by frames of the same name and by principal axes."""
        theirs = self._frames[1][y]
        yield from (f @ theirs[name].inverse() for name, f in [*self._frames[0][x].items()][:4] if name in theirs)
        (mass, center, inertia), (mass2, center2, inertia2) = self._totals[0][x], self._totals[1][y]
        if mass and mass2:
            yield Pose(center - T.R @ center2, T.R)
            axes, axes2 = (np.linalg.eigh(moments)[1] for moments in (inertia, inertia2))
            for signs in ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)):
                R = axes @ np.diag(signs) @ axes2.T
                R = R if np.linalg.det(R) > 0.0 else axes @ np.diag(np.negative(signs)) @ axes2.T
                yield Pose(center - R @ center2, R)

    def _offsets(self, m: Move, n: Move, x: int, y: int, T: Pose) -> Iterator[float]:
        """Coordinates that may be the other file's zero: by frames, mass centres, principal axes, the next joints."""
        if m.kind not in ("turn", "slide"):
            return
        (mass, center, inertia), (mass2, center2, inertia2) = self._totals[0][x], self._totals[1][y]
        points = [(m.frame.p, n.frame.p), (center, center2)]
        vectors = [(m.frame.R[:, k], n.frame.R[:, k]) for k in range(3)]
        for i, j in self.pairs(x, y, lambda _: T)[:8]:
            p, r = self.a.parts[i].move, self.b.parts[j].move
            assert p is not None and r is not None
            points.append((p.frame.p, r.frame.p))
            vectors += [(p.axis, r.axis), (p.axis, -r.axis)]
        theirs = self._frames[1][y]
        frames = [(f, theirs[name]) for name, f in self._frames[0][x].items() if name in theirs][:8]
        points += [(f.p, g.p) for f, g in frames]
        vectors += [(f.R[:, k], g.R[:, k]) for f, g in frames for k in range(3)]
        if m.kind == "slide":
            yield from (float(m.axis @ (moved(T, q) - p)) for p, q in points)
            return
        if mass and mass2:
            pairs = zip(np.linalg.eigh(inertia)[1].T, np.linalg.eigh(inertia2)[1].T, strict=True)
            vectors += [(u, sign * v) for u, v in pairs for sign in (1.0, -1.0)]
        scale = self.close.size
        turned = [((p - m.point) / scale, (moved(T, q) - m.point) / scale) for p, q in points]
        across = []
        for u, v in [*turned, *((u, T.R @ v) for u, v in vectors)]:
            u, v = (w - m.axis * (m.axis @ w) for w in (u, v))
            across.append((float(min(np.linalg.norm(u), np.linalg.norm(v))), u, v))
        for length, u, v in sorted(across, key=lambda row: -row[0]):  # Long ones tell the angle best.
            if length > self.close.tolerance:
                yield math.atan2(float(m.axis @ np.cross(u, v)), float(u @ v))

    def of_body(self, body: Body, other: Body, T: Pose, part: tuple[int, int]) -> Alignment:
        """How a body lies on its counterpart that is fixed in place, as `of_joint`."""
        laid = body.pose @ other.pose.inverse()
        if self.close.poses(laid, T):
            return Alignment(T)
        stays, goes = (self._fixed(body, other, turn, part) for turn in (T, laid))
        return Alignment(laid, is_moved=True) if sum(goes) > sum(stays) else Alignment(T)

    def _fixed(self, body: Body, other: Body, T: Pose, part: tuple[int, int]) -> list[bool]:
        """What a fixed body carries, thing by thing."""
        seen = []
        if body.mass and other.mass:
            seen += [self.close.points(body.center, moved(T, other.center))]
            seen += [self.close.inertias(body.inertia, T.R @ other.inertia @ T.R.T, body.mass)]
        seen += [self.close.poses(f, T @ other.frames[k]) for k, f in body.frames.items() if k in other.frames]
        there = {self.b.bodies[k].name: self.b.bodies[k] for k in self.b.parts[part[1]].bodies}
        for k in self.a.parts[part[0]].bodies:
            child = self.a.bodies[k]
            if child.parent >= 0 and self.a.bodies[child.parent] is body and child.name in there:
                seen.append(self.close.poses(child.pose, T @ there[child.name].pose))
        for i, j in self.pairs(*part, lambda _: T):
            m, n = self.a.parts[i].move, self.b.parts[j].move
            if m is not None and n is not None and m.carrier >= 0 and self.a.bodies[m.carrier] is body:
                seen.append(self.has_line(m, n, T))
        is_frame = not seen and not body.mass and not other.mass
        return [self.close.poses(body.pose, T @ other.pose)] if is_frame else seen


def displacement(move: Move, q: float) -> Pose:
    """What a turn or a slide does to places at zero coordinates."""
    if move.kind == "slide":
        return Pose(q * move.axis, np.eye(3))
    R = axis_rotation(move.axis, math.cos(q), math.sin(q))
    return Pose(move.point - R @ move.point, R)


def _sign(m: Move, axis: Array) -> float:
    return -1.0 if m.axis @ axis < 0.0 else 1.0


def _ends(m: Move, sign: float) -> list[float]:
    """Limits of a coordinate, or of its negative."""
    return sorted(
        sign * m.entries.get(name, end) for name, end in (("lower limit", -math.inf), ("upper limit", math.inf))
    )


def _first(mechanism: Mechanism, part: int) -> str:
    bodies = mechanism.parts[part].bodies
    return mechanism.bodies[bodies[0]].name if bodies else ""


def _below(mechanism: Mechanism) -> list[tuple[int, float]]:
    """Number of parts and mass that each part carries, itself included."""
    counts = [1] * len(mechanism.parts)
    masses = [sum(body.mass for body in mechanism.massive(k)) for k in range(len(mechanism.parts))]
    for k in reversed(range(1, len(mechanism.parts))):
        parent = mechanism.parts[k].parent
        counts[parent] += counts[k]
        masses[parent] += masses[k]
    return list(zip(counts, masses, strict=True))


def _named_frames(mechanism: Mechanism) -> list[dict[str, Pose]]:
    """Frames on each part that stand for themselves: extremity frames, and massless bodies that carry nothing."""
    carriers = {body.parent for body in mechanism.bodies}
    carriers |= {child.move.carrier for child in mechanism.parts if child.move is not None}
    parts = []
    for part in mechanism.parts:
        frames = {name: frame for k in part.bodies for name, frame in mechanism.bodies[k].frames.items()}
        lone = [mechanism.bodies[k] for k in part.bodies[1:] if k not in carriers and not mechanism.bodies[k].mass]
        parts.append(frames | {body.name: body.pose for body in lone})
    return parts
