"""Poses, mass matrix and gravity of mechanisms by products of exponentials, in NumPy: two descriptions at one posture.

Nothing is compiled: a comparison is over before a compiler starts. Configurations are exponential coordinates of the
joints' screws, which both files have alike; so quaternions and link frames of the files play no part.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from symofros.base.arrays import Array
from symofros.base.rotations import quaternion_exp, quaternion_matrix, screw_displacement, skew
from symofros.description import IDENTITY_POSE, Pose


@dataclass(frozen=True)
class Moving:
    """A part as it moves.

    Attributes:
        parent: Index of what carries it; -1 for the ground.
        screws: Twists (6, n) of its speeds at zero coordinates.
        inertia: Spatial inertia (6, 6) about the origin at zero coordinates.
        armature: Added to the diagonal of the mass matrix.
        zero: Displacement between its zero and that of the coordinates.
    """

    parent: int
    screws: Array
    inertia: Array
    armature: float = 0.0
    zero: Pose = IDENTITY_POSE


def adjoint(T: Pose) -> Array:
    """What turns twists (angular; linear at the origin) before a displacement into those after it (6, 6)."""
    return np.block([[T.R, np.zeros((3, 3))], [skew(T.p) @ T.R, T.R]])


def spatial_inertia(mass: float, center: Array, inertia: Array) -> Array:
    """Inertia (6, 6) about the origin, of mass, mass centre and inertia about it."""
    S = skew(center)
    return np.block([[inertia - mass * S @ S, mass * S], [-mass * S, mass * np.eye(3)]])


def poses(parts: Sequence[Moving], q: Sequence[Array]) -> list[Pose]:
    """Displacement of each part from zero coordinates."""
    placed: list[Pose] = []
    for part, values in zip(parts, q, strict=True):
        carrier = placed[part.parent] if part.parent >= 0 else IDENTITY_POSE
        w, v = np.split(part.screws @ values, 2)
        turn = Pose(screw_displacement(w, v), quaternion_matrix(quaternion_exp(w)))
        placed.append(carrier @ turn @ part.zero)
    return placed


def jacobians(parts: Sequence[Moving], placed: Sequence[Pose]) -> list[tuple[Array, Array]]:
    """Of each part the speeds that move it, and its twists by them (6, n) in its own axes at zero coordinates."""
    starts = np.cumsum([0, *(part.screws.shape[1] for part in parts)])
    world: list[tuple[Array, Array]] = []
    for k, part in enumerate(parts):
        own = adjoint(placed[k] @ part.zero.inverse()) @ part.screws
        above, columns = world[part.parent] if part.parent >= 0 else (np.zeros(0, dtype=int), np.zeros((6, 0)))
        world.append((np.r_[above, starts[k] : starts[k + 1]], np.hstack([columns, own])))
    return [(speeds, adjoint(placed[k].inverse()) @ columns) for k, (speeds, columns) in enumerate(world)]


def mass_matrix(parts: Sequence[Moving], moving: Sequence[tuple[Array, Array]]) -> Array:
    """M (n, n)."""
    armatures = [np.full(part.screws.shape[1], part.armature) for part in parts]
    M = np.diag(np.concatenate([np.zeros(0), *armatures]))
    for part, (speeds, J) in zip(parts, moving, strict=True):
        M[np.ix_(speeds, speeds)] += J.T @ part.inertia @ J
    return M


def gravity_forces(
    parts: Sequence[Moving], placed: Sequence[Pose], moving: Sequence[tuple[Array, Array]], gravity: Array
) -> Array:
    """Gravity's part of h (n)."""
    g = np.zeros(sum(part.screws.shape[1] for part in parts))
    for part, pose, (speeds, J) in zip(parts, placed, moving, strict=True):
        acceleration = np.concatenate([np.zeros(3), pose.R.T @ gravity])
        g[speeds] -= J.T @ (part.inertia @ acceleration)
    return g


def posture(parts: Sequence[Moving], size: float, rng: np.random.Generator) -> list[Array]:
    """Random exponential coordinates: turns to both sides by up to two thirds of pi, slides by half the size."""
    scale = [np.where(np.linalg.norm(part.screws[:3], axis=0) > 0.5, 2.0, 0.5 * size) for part in parts]
    return [rng.uniform(-1.0, 1.0, len(most)) * most for most in scale]
