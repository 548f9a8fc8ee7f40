"""What is right: dynamics of a tree in many digits, in an engine's coordinates and speeds.

From poses alone (`kinematics`): Newton's and Euler's equations of each link, projected by its Jacobian. No generator,
no engine and no recursion has a part in it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..interface import Array, HasLayout, Slot, State, Tree
from .acting.forces import Forces
from .arithmetic import Exact, cross, exact, eye, many_digits, rate, solve, stack, zeros
from .charts import CHARTS, Pose
from .kinematics import Inertia, Kinematics

_REMEMBERED = 1000
ROUNDING = 2.0**-52


class Point(NamedTuple):
    """A state in many digits (`interface.State`)."""

    q: Exact
    v: Exact
    a: Exact
    tau: Exact
    v2: Exact
    q2: Exact

    @staticmethod
    def of(state: State) -> Point:
        """The doubles of a state as they are."""
        return Point(*map(exact, (state.q, state.v, state.a, state.tau, state.v2, state.q2)))


class Truth:
    """Functions of a tree, as `functions.FUNCTIONS` names them; each takes a point.

    Args:
        tree: The tree.
        model: Says how an engine keeps its joints.
        roundings: Seed of a rounding that each component of each link's force, moment and momentum suffers, and of its
            position in the world, as in the steadiest of recursions; None for none.
    """

    def __init__(self, tree: Tree, model: HasLayout, roundings: int | None = None) -> None:
        self.tree, self.nv = tree, model.nv
        self._rounded, stored = exact(np.ones((len(tree.links), 6))), None
        if roundings is not None:
            # All different: the effects of equal ones would cancel where the terms cancel.
            draw = np.random.default_rng(roundings)
            self._rounded = self._rounded + exact(draw.uniform(-1.0, 1.0, (len(tree.links), 6)) * ROUNDING)
            stored = exact(draw.uniform(-1.0, 1.0, (len(tree.links), 3)) * ROUNDING)
        self.kinematics = Kinematics(tree, model, stored)
        self.own = Forces(tree, self.kinematics)
        # Differences of several functions ask for the same again and again.
        self.remembered: dict[tuple[object, ...], Exact] = {}
        self.gravity_vector = exact(tree.gravity)
        self.inertias = [Inertia.of(link) for link in tree.links]
        self.armature = zeros(self.nv)
        for index in range(len(tree.links)):
            for joint, slot in self.kinematics.joints(index):
                if slot is not None and joint.armature and not joint.mimics:
                    self.armature[list(slot.v)] = exact(joint.armature)

    def once(self, key: tuple[object, ...], compute: Callable[[], Exact]) -> Exact:
        """What was worked out under a key, or is now; it must not be changed in place."""
        if key not in self.remembered:
            if len(self.remembered) >= _REMEMBERED:
                self.remembered.clear()
            self.remembered[key] = compute()
        return self.remembered[key]

    def M(self, q: Exact) -> Exact:
        """The mass matrix (nv, nv)."""
        return self.once(("M", *q), lambda: self._mass_matrix(q))

    def _mass_matrix(self, q: Exact) -> Exact:
        M = np.array(np.diag(self.armature))
        for inertia, (R, _), J, rounded in zip(
            self.inertias, self.kinematics.poses(q), self.kinematics.jacobians(q), self._rounded, strict=True
        ):
            M = M + J.T @ (rounded[:, np.newaxis] * (inertia.turned(R).matrix() @ J))
        for armature, J in self.own.heavy(q):
            M = M + armature * np.outer(J, J)
        return M

    def motions(self, q: Exact, v: Exact, a: Exact) -> tuple[Exact, Exact, Exact]:
        """Jacobians (L, 6, nv), velocities (L, 6) and their rates (L, 6) of the links' origins, along world axes."""
        J = self.kinematics.jacobians(q)
        turning = self.kinematics.along(self.kinematics.jacobians, q, v)
        return J, J @ v, J @ a + turning @ v

    def forces(self, motions: tuple[Exact, Exact, Exact], poses: list[Pose], inertias: list[Inertia | None]) -> Exact:
        """M a + h (nv) without armature, of links that have the given inertias; None for none."""
        J, total = motions[0], zeros(self.nv)
        for k, wrench in self.wrenches(motions, poses, inertias).items():
            total = total + J[k].T @ wrench
        return total

    def wrenches(
        self, motions: tuple[Exact, Exact, Exact], poses: list[Pose], inertias: list[Inertia | None]
    ) -> dict[int, Exact]:
        """Link -> wrench that moves it against gravity (6): force, and moment about its origin, along world axes."""
        _, velocity, acceleration = motions
        wrenches: dict[int, Exact] = {}
        for k, stated in enumerate(inertias):
            if stated is None:
                continue
            inertia = stated.turned(poses[k][0])
            w, alpha = velocity[k, 3:], acceleration[k, 3:]
            falling = acceleration[k, :3] - self.gravity_vector
            force = inertia.mass * falling + cross(alpha, inertia.first) + cross(w, cross(w, inertia.first))
            momentum = inertia.second @ w
            moment = cross(inertia.first, falling) + inertia.second @ alpha + cross(w, momentum)
            wrenches[k] = np.concatenate([force, moment]) * self._rounded[k]
        return wrenches

    def ID(self, q: Exact, v: Exact, a: Exact) -> Exact:
        """M a + h (nv)."""
        return self.of_links(q, v, a) + self.armature * a + self._of_tendons(q, v, a)

    def of_links(self, q: Exact, v: Exact, a: Exact) -> Exact:
        """The part of the links in M a + h (nv)."""
        return self.forces(self.motions(q, v, a), self.kinematics.poses(q), list(self.inertias))

    def _of_tendons(self, q: Exact, v: Exact, a: Exact) -> Exact:
        """What the mass that moves with tendons takes (nv): that times the acceleration of each length."""

        def arms(at: Exact) -> Exact:
            return np.array([J for _, J in self.own.heavy(at)], dtype=object).reshape(-1, self.nv)

        heavy = self.own.heavy(q)
        if not heavy:
            return zeros(self.nv)
        rates = arms(q) @ a + self.kinematics.along(arms, q, v) @ v
        return sum((armature * J * rate_ for (armature, J), rate_ in zip(heavy, rates, strict=True)), zeros(self.nv))

    def h(self, q: Exact, v: Exact) -> Exact:
        """Coriolis, centrifugal and gravity forces (nv)."""
        return self.once(("h", *q, *v), lambda: self.ID(q, v, zeros(self.nv)))

    def g(self, q: Exact) -> Exact:
        """Gravity forces (nv)."""
        return self.ID(q, zeros(self.nv), zeros(self.nv))

    def FD(self, q: Exact, v: Exact, tau: Exact) -> Exact:
        """M^-1 (tau + Q - h) (nv), Q what the tree states to act on itself."""
        return solve(self.M(q), tau + self.own.applied(q, v) - self.h(q, v))

    def inverse(self, q: Exact) -> Exact:
        """M^-1 (nv, nv)."""
        return solve(self.M(q), eye(self.nv))

    def T(self, q: Exact, v: Exact) -> Exact:
        """Kinetic energy."""
        return v @ self.M(q) @ v / 2

    def V(self, q: Exact) -> Exact:
        """Potential energy, zero with all mass centres at the world's origin and all springs without force."""
        weights = (
            self.gravity_vector @ (inertia.mass * p + R @ inertia.first)
            for inertia, (R, p) in zip(self.inertias, self.kinematics.poses(q), strict=True)
        )
        return self.own.stored(q) - sum(weights)

    def value(self, function: Callable[[Truth, Point], Exact], point: Point) -> Exact:
        """A function of the tree, in many digits."""
        with many_digits():
            return function(self, point)

    def along_speeds(self, function: Callable[[Exact], Exact], v: Exact) -> Exact:
        """Derivatives of a function by each speed, along a new last axis."""
        unit = eye(self.nv)
        return stack([rate(function, v, unit[k]) for k in range(self.nv)])


def neutral(layout: HasLayout) -> Array:
    """Coordinates (nq) that move nothing: zeros, but for the real parts of quaternions and the cosines."""
    q = np.zeros(layout.nq)
    for slot in (slot for link in layout.slots for slot in link):
        unit = _unit_places(slot)
        if unit:
            q[unit[-1] if "xyzw" in slot.chart else unit[0]] = 1.0
    return q


def _unit_places(slot: Slot) -> tuple[int, ...]:
    """Places of the coordinates of a joint that make a unit vector: a quaternion, or cosine and sine."""
    if "cos sin" in slot.chart:
        return slot.q[-2:]
    if "quaternion first" in slot.chart:
        return slot.q[:4]
    return slot.q[-4:] if "xyzw" in slot.chart or "wxyz" in slot.chart else ()


def _nearer(layout: HasLayout, q: Array, part: float) -> Array:
    """Coordinates (nq) a part of the way from where nothing has moved to q."""
    start = neutral(layout)
    near = start + part * (q - start)
    for slot in (slot for link in layout.slots for slot in link):
        if unit := list(_unit_places(slot)):
            near[unit] /= math.hypot(*near[unit])
    return near


def _beside(tree: Tree, layout: HasLayout, q: Array, q2: Array) -> tuple[Array, Array]:
    """Coordinates (nq), twice, of which the quaternions are special ones (`Tree.beside`)."""
    part = 2.0**-tree.near if tree.near else 0.0
    ends = q.copy(), q2.copy()
    near, near2 = (_nearer(layout, one, part) for one in (q, q2))
    for slot in (slot for link in layout.slots for slot in link):
        places = list(_unit_places(slot))
        scalar_first = [places[-1], *places[:-1]] if "xyzw" in slot.chart else places
        one, other, close, close2 = (x[scalar_first] for x in (q, q2, near, near2))
        axis = np.eye(3)[int(np.argmax(np.abs(one[1:])))]
        if tree.beside == "one axis":
            pair = _about(axis, one), _about(axis, other)
        elif tree.beside.startswith("half turns"):
            axis = axis if tree.beside.endswith("axis") else one[1:] / math.hypot(*one[1:])
            pair = _product(np.array([0.0, *axis]), close2), close
        else:
            turned = _product(one, close2)
            pair = one, -turned if tree.beside.endswith("opposite") else turned
        for end, quaternion in zip(ends, pair, strict=True):
            end[scalar_first] = quaternion / math.hypot(*quaternion)
    return ends


def _about(axis: Array, quaternion: Array) -> Array:
    """A turn (4) about an axis by less than a quarter turn, with the sign of the quaternion's scalar."""
    half = math.pi / 4.0 * float(quaternion[1:] @ axis)
    return np.array([math.cos(half), *(math.sin(half) * axis)]) * math.copysign(1.0, quaternion[0])


def _product(p: Array, q: Array) -> Array:
    """Product of two quaternions (4), scalars first."""
    (w, *x), (s, *y) = p, q
    return np.array([w * s - np.dot(x, y), *(w * np.array(y) + s * np.array(x) + np.cross(x, y))])


def random_state(tree: Tree, model: HasLayout, seed: int) -> State:
    """A random state on the manifold of an engine's coordinates, of sizes about one, or near others (`Tree.near`)."""
    draw = np.random.default_rng(seed)
    kinematics = Kinematics(tree, model)
    q, q2 = np.zeros(model.nq), np.zeros(model.nq)
    for joint, slot in kinematics.moving():
        chart = CHARTS[slot.chart]
        for coordinates in (q, q2):
            coordinates[list(slot.q)] = chart.sample(joint, draw)
            coordinates[[slot.q[k] for k in chart.position]] += tree.away[: len(chart.position)]
    v, a, tau, v2 = (draw.uniform(-1.0, 1.0, model.nv) for _ in range(4))
    if tree.beside:
        q, q2 = _beside(tree, model, q, q2)
    elif tree.near:
        part = 2.0**-tree.near
        q, q2 = (_nearer(model, one, part) for one in (q, q2))
        v, tau, v2 = (part * one for one in (v, tau, v2))
    return State(q, v, a, tau, v2, q2)


def digits(value: Exact) -> Array:
    """Rounded to doubles."""
    return np.asarray(np.vectorize(float, otypes=[float])(np.asarray(value, dtype=object)))
