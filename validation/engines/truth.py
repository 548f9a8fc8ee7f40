"""What is right: dynamics of a tree in many digits, in an engine's coordinates and speeds.

From poses alone (`kinematics`): Newton's and Euler's equations of each link, projected by its Jacobian. No generator,
no
engine, no recursion has a part in it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from validation.engines.arithmetic import Exact, cross, exact, eye, rate, skew, solve, stack, zeros
from validation.engines.charts import CHARTS
from validation.engines.interface import Array, EngineModel, State, Tree
from validation.engines.kinematics import Inertia, Kinematics


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
    """

    def __init__(self, tree: Tree, model: EngineModel) -> None:
        self.tree, self.kinematics = tree, Kinematics(tree, model)
        self.nv = model.nv
        self.gravity_vector = exact(tree.gravity)
        self.inertias = [Inertia.of(link) for link in tree.links]
        self.armature = zeros(self.nv)
        for index in range(len(tree.links)):
            for joint, slot in self.kinematics.joints(index):
                if slot is not None and joint.armature and not joint.mimics:
                    self.armature[list(slot.v)] = exact(joint.armature)

    def M(self, q: Exact) -> Exact:
        """The mass matrix (nv, nv)."""
        M = np.array(np.diag(self.armature))
        for inertia, (R, _), J in zip(
            self.inertias, self.kinematics.poses(q), self.kinematics.jacobians(q), strict=True
        ):
            M = M + J.T @ inertia.turned(R).matrix() @ J
        return M

    def motions(self, q: Exact, v: Exact, a: Exact) -> tuple[Exact, Exact, Exact]:
        """Jacobians (L, 6, nv), velocities (L, 6) and their rates (L, 6) of the links' origins, along world axes."""
        J = self.kinematics.jacobians(q)
        turning = self.kinematics.along(self.kinematics.jacobians, q, v)
        return J, J @ v, J @ a + turning @ v

    def forces(self, q: Exact, v: Exact, a: Exact, inertias: list[Inertia]) -> Exact:
        """M a + h (nv) without armature, of links that have the given inertias."""
        J, velocity, acceleration = self.motions(q, v, a)
        total = zeros(self.nv)
        for k, (R, _) in enumerate(self.kinematics.poses(q)):
            inertia = inertias[k].turned(R)
            w, alpha = velocity[k, 3:], acceleration[k, 3:]
            falling = acceleration[k, :3] - self.gravity_vector
            force = inertia.mass * falling + cross(alpha, inertia.first) + cross(w, cross(w, inertia.first))
            momentum = inertia.second @ w
            moment = cross(inertia.first, falling) + inertia.second @ alpha + cross(w, momentum)
            total = total + J[k, :3].T @ force + J[k, 3:].T @ moment
        return total

    def ID(self, q: Exact, v: Exact, a: Exact) -> Exact:
        """M a + h (nv)."""
        return self.forces(q, v, a, self.inertias) + self.armature * a

    def h(self, q: Exact, v: Exact) -> Exact:
        """Coriolis, centrifugal and gravity forces (nv)."""
        return self.ID(q, v, zeros(self.nv))

    def g(self, q: Exact) -> Exact:
        """Gravity forces (nv)."""
        return self.ID(q, zeros(self.nv), zeros(self.nv))

    def FD(self, q: Exact, v: Exact, tau: Exact) -> Exact:
        """M^-1 (tau - h) (nv)."""
        return solve(self.M(q), tau - self.h(q, v))

    def inverse(self, q: Exact) -> Exact:
        """M^-1 (nv, nv)."""
        return solve(self.M(q), eye(self.nv))

    def T(self, q: Exact, v: Exact) -> Exact:
        """Kinetic energy."""
        return v @ self.M(q) @ v / 2

    def V(self, q: Exact) -> Exact:
        """Potential energy, zero with all mass centres at the world's origin."""
        return -sum(
            self.gravity_vector @ (inertia.mass * p + R @ inertia.first)
            for inertia, (R, p) in zip(self.inertias, self.kinematics.poses(q), strict=True)
        )

    def centre(self, q: Exact) -> Exact:
        """The mass centre of all links (3)."""
        poses = self.kinematics.poses(q)
        first = sum(i.mass * p + R @ i.first for i, (R, p) in zip(self.inertias, poses, strict=True))
        return first / sum(inertia.mass for inertia in self.inertias)

    def centroidal(self, q: Exact) -> Exact:
        """The map (6, nv) from speeds to momentum about the mass centre, along world axes: linear, then angular."""
        centre, total = self.centre(q), zeros(6, self.nv)
        jacobians = self.kinematics.jacobians(q)
        for inertia, (R, p), J in zip(self.inertias, self.kinematics.poses(q), jacobians, strict=True):
            momentum = inertia.turned(R).matrix() @ J
            total = total + np.concatenate([momentum[:3], momentum[3:] + skew(p - centre) @ momentum[:3]])
        return total

    def centre_jacobian(self, q: Exact) -> Exact:
        """The Jacobian of the mass centre (3, nv)."""
        return self.centroidal(q)[:3] / sum(inertia.mass for inertia in self.inertias)

    def along_speeds(self, function: Callable[[Exact], Exact], v: Exact) -> Exact:
        """Derivatives of a function by each speed, along a new last axis."""
        unit = eye(self.nv)
        return stack([rate(function, v, unit[k]) for k in range(self.nv)])


def random_state(tree: Tree, model: EngineModel, seed: int) -> State:
    """A random state on the manifold of an engine's coordinates, of sizes about one."""
    draw = np.random.default_rng(seed)
    kinematics = Kinematics(tree, model)
    q, q2 = np.zeros(model.nq), np.zeros(model.nq)
    for index in range(len(tree.links)):
        for joint, slot in kinematics.joints(index):
            if slot is not None and not joint.mimics:
                for coordinates in (q, q2):
                    coordinates[list(slot.q)] = CHARTS[slot.chart].sample(joint, draw)
    v, a, tau, v2 = (draw.uniform(-1.0, 1.0, model.nv) for _ in range(4))
    return State(q, v, a, tau, v2, q2)


def digits(value: Exact) -> Array:
    """Rounded to doubles."""
    return np.asarray(np.vectorize(float, otypes=[float])(np.asarray(value, dtype=object)))
