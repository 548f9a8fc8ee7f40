"""From two mechanisms to their differences, parents first."""

from __future__ import annotations

from collections import deque
from dataclasses import replace

import numpy as np

from symofros.base.arrays import Array
from symofros.description import IDENTITY_POSE, Pose
from symofros.studio.differences.alignment import Alignment, Alignments, Close
from symofros.studio.differences.difference import Difference, entries_of_joint, likelier
from symofros.studio.differences.mechanism import Body, Mechanism, Move, moved
from symofros.studio.differences.motion import Moving, Posture, adjoint, random_coordinates, spatial_inertia

# Postures that an inertia is asked at, and what of its largest possible effect is rounding.
POSTURES, _ROUNDING = 4, 1e-11
# Differences of the mechanism beyond which no more are looked for: who has as many compares two robots.
MOST_DIFFERENCES = 200
# Massive bodies of a part that are matched by what they weigh.
_MOST_RENAMED = 60
_MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")


class Findings:
    """The differences of two mechanisms.

    Args:
        a: First.
        b: Second.
        tolerance: Relative one.
        seed: Of the postures.

    Attributes:
        differences: What differs, parents first.
        pairs: Part of the first -> part of the second, and how it lies.
        errors: Largest relative differences over random postures, of "kinematics", "M", "g"; empty where parts are left
            over.
        reframed: Links whose frames are placed otherwise, which nothing shows.
    """

    def __init__(self, a: Mechanism, b: Mechanism, tolerance: float, seed: int) -> None:
        self.a, self.b, self.rng = a, b, np.random.default_rng(seed)
        self.close = Close(tolerance, max(a.size, b.size))
        self.aligned = Alignments(a, b, self.close)
        self.differences: list[Difference] = []
        self.pairs: dict[int, tuple[int, Alignment]] = {0: (0, Alignment(IDENTITY_POSE))}
        self.reframed: list[str] = []
        self.complete = True
        self._moving = [self._moved(a, k) for k in range(len(a.parts))]
        qs = [random_coordinates(self._moving, self.close.size, self.rng) for _ in range(POSTURES)]
        self._postures = [(q, Posture(self._moving, q)) for q in qs]
        self._carriers = {0: IDENTITY_POSE}  # Part of b -> how it lies.
        self._laid: dict[int, Pose] = {}  # Of bodies of b.
        self._compare()
        self.errors = self._errors() if self.complete else {}

    def _compare(self) -> None:
        if not self.close.points(self.a.gravity / 9.81, self.b.gravity / 9.81):
            self._add("gravity", None, None, self.a.gravity.tolist(), self.b.gravity.tolist(), ("g",))
        queue = deque([0])
        while queue and not self.is_cut:
            c = queue.popleft()
            d, alignment = self.pairs[c]
            bodies = self._place_bodies(c, d, alignment.T)
            pairs = self.aligned.pairs(c, d, lambda y: self._carrier(y))
            is_whole = self._left_over(c, d, pairs)
            if is_whole:
                self._inertias(c, d, bodies, alignment.T)
            for x, y in pairs:
                self.pairs[x] = (y, self._joint(x, y))
                self._carriers[y] = self.pairs[x][1].T
                queue.append(x)
        self.complete &= not queue

    @property
    def is_cut(self) -> bool:
        """Whether so much differs that the rest is not looked at."""
        return sum(item.is_mechanical for item in self.differences) >= MOST_DIFFERENCES

    def _carrier(self, part: int) -> Pose:
        """Displacement of what a joint of the second file hangs on."""
        move = self.b.parts[part].move
        if move is not None and move.carrier >= 0:
            return self._laid[move.carrier]
        return self._carriers[self.b.parts[part].parent]

    # What is there.

    def _left_over(self, c: int, d: int, pairs: list[tuple[int, int]]) -> bool:
        """Joints of a part that the other file's lacks; whether there are none."""
        ours = set(self.a.parts[c].children) - {x for x, _ in pairs}
        theirs = set(self.b.parts[d].children) - {y for _, y in pairs}
        for x in sorted(ours):
            self._lone(self.a, self.b, x, flipped=False)
        for y in sorted(theirs):
            self._lone(self.b, self.a, y, flipped=True)
        self.complete &= not ours and not theirs
        return not ours and not theirs

    def _lone(self, a: Mechanism, b: Mechanism, x: int, flipped: bool) -> None:
        """A joint without counterpart: fixed in the other file, on another parent, or not there."""
        move = a.parts[x].move
        assert move is not None
        body = a.carried_by(x)
        other = b.bodies[b.index[body.name]] if body.name in b.index else None
        entry, here, there = "presence", move.stated, "no such joint"
        if other is not None:
            joint = b.parts[other.part].move if b.carried_by(other.part) is other else None
            if joint is None:
                entry, there = "joint kind", "fixed"
            else:
                entry, here, there = "parent", _carrier_name(a, move), _carrier_name(b, joint)
        values = (there, here) if flipped else (here, there)
        bodies = (other or body, body) if flipped else (body, other)
        if entry == "parent" and (
            flipped or here == there
        ):  # Reported from the first file's side, or with the carrier.
            return
        self._add(entry, bodies, (move, move), *values, ("kinematics", "M", "g"))

    # Bodies.

    def _counterparts(self, c: int, d: int, T: Pose) -> dict[int, int]:
        """Bodies of a part -> their counterparts: by names, and massive ones that are left over by what they weigh."""
        there = {self.b.bodies[k].name: k for k in self.b.parts[d].bodies}
        pairs = {k: there.pop(self.a.bodies[k].name) for k in self.a.parts[c].bodies if self.a.bodies[k].name in there}
        ours = [k for k in self.a.parts[c].bodies if k not in pairs and self.a.bodies[k].mass]
        theirs = [k for k in there.values() if self.b.bodies[k].mass]
        if len(ours) == len(theirs) <= _MOST_RENAMED:
            unlike = sorted((self._unlike(self.a.bodies[x], self.b.bodies[y], T), x, y) for x in ours for y in theirs)
            for _, x, y in unlike:
                if x not in pairs and y not in pairs.values():
                    pairs[x] = y
        return pairs

    def _unlike(self, one: Body, two: Body, T: Pose) -> int:
        """How many of mass, mass centre and inertia of two bodies differ."""
        close = self.close
        agree = close.numbers(one.mass, two.mass), close.points(one.center, moved(T, two.center))
        return 3 - sum((*agree, close.inertias(one.inertia, T.R @ two.inertia @ T.R.T, one.mass)))

    def _place_bodies(self, c: int, d: int, T: Pose) -> list[tuple[Body, Body]]:
        """A part's bodies and their counterparts; where each of the second file lies."""
        for k in self.b.parts[d].bodies:
            self._laid[k] = T
        counterparts = self._counterparts(c, d, T)
        ours, pairs = self.a.parts[c].bodies, list[tuple[Body, Body]]()
        laid = dict.fromkeys(ours, T)
        for k in ours:
            body = self.a.bodies[k]
            if body.parent in laid:
                laid[k] = laid[body.parent]
            if k not in counterparts:
                continue
            other = self.b.bodies[counterparts[k]]
            if (body.parent in laid or c == 0) and body.joint:
                way = self.aligned.of_body(body, other, laid[k], (c, d))
                if way.is_moved:
                    self._origin(body, other, None, body.pose, laid[k] @ other.pose)
                laid[k] = way.T
            if not self.close.poses(body.pose, laid[k] @ other.pose):
                self.reframed.append(body.name)
            self._laid[counterparts[k]] = laid[k]
            self._frames(body, other, laid[k])
            pairs.append((body, other))
        return pairs

    def _frames(self, body: Body, other: Body, T: Pose) -> None:
        for name in body.frames.keys() & other.frames.keys():
            frame, placed = body.frames[name], T @ other.frames[name]
            if not self.close.poses(frame, placed):
                inside = body.pose.inverse()
                here, there = (_shown(inside @ pose) for pose in (frame, placed))
                self._add(f"frame '{name}'", (body, other), None, here, there, ("kinematics",))

    def _inertias(self, c: int, d: int, named: list[tuple[Body, Body]], T: Pose) -> None:
        """Inertias body by body, where both files have as many, or else those of the whole part."""
        ours, theirs = self.a.massive(c), self.b.massive(d)
        weighed = [(x, y) for x, y in named if x in ours or y in theirs]
        both = [(x, y) for x, y in weighed if x in ours and y in theirs]
        lone = len(weighed) - len(both)
        names = [{body.name for body in ours}, {body.name for body in theirs}]
        is_whole = any(names[k] - {pair[k].name for pair in weighed} for k in (0, 1))
        # Mass that one link has in one file alone is that link's, unless others differ, too: then links are fused.
        unlike = sum(bool(self._unlike(x, y, self._laid[self.b.index[y.name]])) for x, y in both) if lone else 0
        if is_whole or lone + unlike > 1:
            pairs = [(self.a.whole(c), self.b.whole(d), T)]
        else:
            pairs = [(x, y, self._laid[self.b.index[y.name]]) for x, y in weighed]
        for body, other, laid in pairs:
            self._inertia(c, body, other, laid)

    def _inertia(self, c: int, body: Body, other: Body, T: Pose) -> None:
        """Entries of one body's inertia."""
        center, turned = moved(T, other.center), T.R @ other.inertia @ T.R.T
        new = (body.mass, body.center, body.inertia)
        if not self.close.numbers(body.mass, other.mass):
            changes = self._shown_by(c, new, (other.mass, body.center, body.inertia))
            self._add("mass", (body, other), None, body.mass, other.mass, changes)
        if body.mass and other.mass and not self.close.points(body.center, center):
            changes = self._shown_by(c, new, (body.mass, center, body.inertia))
            inside = body.pose.inverse()
            here, there = moved(inside, body.center).tolist(), moved(inside, center).tolist()
            self._add("center of mass", (body, other), None, here, there, changes)
        if not self.close.inertias(body.inertia, turned, body.mass):
            changes = self._shown_by(c, new, (body.mass, body.center, turned))
            R, at = body.pose.R, np.triu_indices(3)
            values = [dict(zip(_MOMENTS, (R.T @ I @ R)[at].tolist(), strict=True)) for I in (body.inertia, turned)]  # noqa: E741
            size = self.close.tolerance * max(map(abs, values[0].values()))
            differing = [name for name in _MOMENTS if abs(values[0][name] - values[1][name]) > size] or [*_MOMENTS]
            here, there = ({name: value[name] for name in differing} for value in values)
            self._add("inertia", (body, other), None, here, there, changes)

    def _shown_by(self, c: int, old: tuple[float, Array, Array], new: tuple[float, Array, Array]) -> tuple[str, ...]:
        """Which of M and g another inertia of a part changes: they are linear in it, so that no digits cancel."""
        change = spatial_inertia(*new) - spatial_inertia(*old)
        weights = [0.0, 0.0]
        scale = self.close.size
        units = np.diag([1 / scale] * 3 + [1.0] * 3)
        largest = np.abs(units @ change @ units).max() * scale**2
        for _, posture in self._postures:
            J = posture.jacobian(c)
            if not J.size:
                continue
            size = np.abs(np.linalg.inv(units) @ J).max() / scale or 1.0
            weights[0] = max(weights[0], float(np.abs(J.T @ change @ J).max()) / size**2)
            down = np.concatenate([np.zeros(3), posture.placed[c].R.T @ self.a.gravity])
            strong = float(np.abs(self.a.gravity).max()) or 1.0
            weights[1] = max(weights[1], float(np.abs(J.T @ change @ down).max()) * scale / size / strong)
        return tuple(name for name, weight in zip(("M", "g"), weights, strict=True) if weight > _ROUNDING * largest)

    # Joints.

    def _joint(self, x: int, y: int) -> Alignment:
        """Differences of a joint; how what it carries lies."""
        m, n = self.a.parts[x].move, self.b.parts[y].move
        assert m is not None and n is not None
        T, bodies = self._carrier(y), (self.a.carried_by(x), self.b.carried_by(y))
        if m.kind != n.kind:
            self.complete = False
            self._add("joint kind", bodies, (m, n), m.stated, n.stated, ("kinematics", "M", "g"))
            return Alignment(T)
        way = self.aligned.of_joint(x, y, T)
        if way.is_moved:
            self._origin(*bodies, (m, n), m.frame, T @ n.frame)
        elif not way.has_line:
            axis = m.frame.R.T @ m.axis
            turned = m.frame.R.T @ T.R @ n.axis * way.sign
            if m.kind != "ball" and not self.close.directions(axis, turned):
                self._add("axis", bodies, (m, n), axis.tolist(), turned.tolist(), ("kinematics",))
            else:
                self._origin(*bodies, (m, n), m.frame, Pose(moved(T, n.point), m.frame.R))
        if not self.close.numbers(m.pitch, n.pitch):
            self._add("pitch", bodies, (m, n), m.pitch, n.pitch, ("kinematics",))
        self._entries(bodies, (m, n), way)
        return way

    def _entries(self, bodies: tuple[Body, Body], moves: tuple[Move, Move], way: Alignment) -> None:
        """Zero of the coordinate, limits, what resists it."""
        m, n = moves
        if way.is_remapped:
            self._add("zero of the coordinates", bodies, moves, m.name, n.name, ("coordinates",))
        if way.sign < 0.0:
            self._add("sign of the coordinate", bodies, moves, m.name, f"-{n.name}", ("coordinates",))
        if way.offset:
            sign = "-" if way.sign < 0.0 else ""
            blamed, blamed_moves = self._turned_by(bodies, moves)
            mapped = f"{sign}{n.name} {way.offset:+.9g}"
            self._add("zero of the coordinate", blamed, blamed_moves, m.name, mapped, ("coordinates",))
        for name, here, there, changes in entries_of_joint(m.entries, n.entries, way.sign, way.offset, self.close):
            self._add(name, bodies, moves, here, there, changes)

    def _turned_by(
        self, bodies: tuple[Body, Body], moves: tuple[Move, Move]
    ) -> tuple[tuple[Body, Body], tuple[Move, Move]]:
        """What the file states otherwise where a coordinate's zero is elsewhere: the joint, or the one beyond it."""
        m, n = moves
        if not self.close.poses(m.placed, n.placed):
            return bodies, moves
        after = [[x for x in mech.parts[b.part].children] for mech, b in zip((self.a, self.b), bodies, strict=True)]
        if [len(row) for row in after] == [1, 1]:
            x, y = after[0][0], after[1][0]
            next_m, next_n = self.a.parts[x].move, self.b.parts[y].move
            assert next_m is not None and next_n is not None
            if not self.close.poses(next_m.placed, next_n.placed):
                return (self.a.carried_by(x), self.b.carried_by(y)), (next_m, next_n)
        return bodies, moves

    def _origin(self, body: Body, other: Body, moves: tuple[Move, Move] | None, here: Pose, there: Pose) -> None:
        """A joint that stands elsewhere: its frame in what carries it, where the files' frames are the same there."""
        ours, theirs = (body.placed, other.placed) if moves is None else (moves[0].placed, moves[1].placed)
        carrier = here @ ours.inverse()
        seen = carrier.inverse() @ there
        shown = [_shown(ours), _shown(seen if not self.close.poses(seen, theirs) else theirs)]
        differing = [key for key in ("xyz", "rpy") if not np.allclose(shown[0][key], shown[1][key], 1e-9, 1e-12)]
        values = [{key: value[key] for key in differing or value} for value in shown]
        self._add("origin", (body, other), moves, values[0], values[1], ("kinematics",))

    # All at once.

    def _add(
        self,
        entry: str,
        bodies: tuple[Body, Body | None] | None,
        moves: tuple[Move, Move] | None,
        here: object,
        there: object,
        changes: tuple[str, ...],
    ) -> None:
        first, second = bodies or (None, None)
        joint = moves[0].name if moves else first.joint if first is not None and entry == "origin" else ""
        other = moves[1].name if moves else second.joint if second is not None and entry == "origin" else ""
        kinds = (
            ("joint", joint, other) if joint else ("body", first.name if first else "", second.name if second else "")
        )
        places = tuple(
            m.system.origin.get((kinds[0], name), "") for m, name in zip((self.a, self.b), kinds[1:], strict=True)
        )
        link = first.name if first is not None else ""
        found = Difference(entry, link, joint, here, there, changes, (second.name if second else "", other), places)  # type: ignore[arg-type]
        if first is not None and second is not None:
            which, reason = likelier((self.a, self.b), (first, second), entry, self.close)
            found = replace(found, likelier=which, reason=reason)
        self.differences.append(found)

    def _moved(self, mechanism: Mechanism, k: int) -> Moving:
        move = mechanism.parts[k].move
        inertia = spatial_inertia(*mechanism.total(k))
        if move is None:
            return Moving(-1, np.zeros((6, 0)), inertia)
        return Moving(mechanism.parts[k].parent, move.screws, inertia, move.entries.get("armature", 0.0))

    def _errors(self) -> dict[str, float]:
        """Largest differences over random postures: of poses by the size, of M and g by their own diagonals."""
        place = {x: k for k, x in enumerate(sorted(self.pairs))}
        theirs = [self._counterpart(x, place) for x in sorted(self.pairs)]
        errors = {"kinematics": 0.0, "M": 0.0, "g": 0.0}
        for q, ours in self._postures:
            other = Posture(theirs, q)
            for x, k in place.items():
                seen, there = ours.placed[x] @ self.pairs[x][1].T, other.placed[k]
                at = [np.abs(seen.p - there.p).max() / self.close.size, np.abs(seen.R - there.R).max()]
                errors["kinematics"] = max(errors["kinematics"], float(max(at)))
            M, M2 = ours.mass_matrix(), other.mass_matrix()
            scale = np.sqrt(np.abs(np.diag(M))) + 1e-150
            errors["M"] = max(errors["M"], float(np.abs((M - M2) / np.outer(scale, scale)).max(initial=0.0)))
            g, g2 = ours.gravity_forces(self.a.gravity), other.gravity_forces(self.b.gravity)
            largest = float(np.abs(g).max(initial=0.0)) or 1.0
            errors["g"] = max(errors["g"], float(np.abs(g - g2).max(initial=0.0)) / largest)
        return errors

    def _counterpart(self, x: int, place: dict[int, int]) -> Moving:
        """A part of the second file that moves with the first's coordinates."""
        y, way = self.pairs[x]
        own = self._moved(self.b, y)
        move = self.a.parts[x].move
        if move is None:
            return own
        carrier = self._carrier(y)
        zero = IDENTITY_POSE if way.is_moved else carrier.inverse() @ way.T
        screws = own.screws * way.sign
        if move.kind == "ball":  # Along the first file's axes, about the second's own centre.
            screws = own.screws @ carrier.R.T
        elif move.kind == "free":
            screws = adjoint(carrier.inverse()) @ move.screws
        return replace(own, parent=place[self.a.parts[x].parent], screws=screws, zero=zero)


def _carrier_name(mechanism: Mechanism, move: Move) -> str:
    return mechanism.bodies[move.carrier].name if move.carrier >= 0 else "world"


def _shown(pose: Pose) -> dict[str, list[float]]:
    """A frame as files state it: position, and roll, pitch and yaw."""
    R = pose.R
    pitch = np.arctan2(-R[2, 0], np.hypot(R[0, 0], R[1, 0]))
    roll, yaw = np.arctan2(R[2, 1], R[2, 2]), np.arctan2(R[1, 0], R[0, 0])
    return {"xyz": pose.p.tolist(), "rpy": [float(roll), float(pitch), float(yaw)]}
