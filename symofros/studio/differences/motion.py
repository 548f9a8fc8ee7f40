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


class Posture:
    """Parts at one posture.

    Args:
        parts: Parts, parents first.
        q: Exponential coordinates of each.

    Attributes:
        placed: Displacement of each part from zero coordinates.
        moves: Whether a speed moves a part (parts, n).
    """

    def __init__(self, parts: Sequence[Moving], q: Sequence[Array]) -> None:
        self.parts, self.placed = parts, list[Pose]()
        columns, self._owners = [np.zeros((6, 0))], list[int]()
        self.moves = np.zeros((len(parts), sum(part.screws.shape[1] for part in parts)), dtype=bool)
        for k, (part, values) in enumerate(zip(parts, q, strict=True)):
            carrier = self.placed[part.parent] if part.parent >= 0 else IDENTITY_POSE
            w, v = np.split(part.screws @ values, 2)
            turned = carrier @ Pose(screw_displacement(w, v), quaternion_matrix(quaternion_exp(w)))
            self.placed.append(turned @ part.zero)
            columns.append(adjoint(turned) @ part.screws)
            first = len(self._owners)
            self._owners += [k] * part.screws.shape[1]
            if part.parent >= 0:
                self.moves[k] = self.moves[part.parent]
            self.moves[k, first : len(self._owners)] = True
        self._columns = np.hstack(columns)
        self._composite = self._composite_inertias()

    def _composite_inertias(self) -> Array:
        """Spatial inertias of parts with all that they carry, about the origin, in the world's axes (parts, 6, 6)."""
        inertias = np.zeros((len(self.parts), 6, 6))
        for k in reversed(range(len(self.parts))):
            back = adjoint(self.placed[k].inverse())
            inertias[k] += back.T @ self.parts[k].inertia @ back
            if self.parts[k].parent >= 0:
                inertias[self.parts[k].parent] += inertias[k]
        return inertias

    def mass_matrix(self) -> Array:
        """M (n, n)."""
        momenta = np.einsum("nij,jn->in", self._composite[self._owners], self._columns)
        full, above = self._columns.T @ momenta, self.moves[self._owners].T
        M = np.where(above, full, np.where(above.T, full.T, 0.0))
        return np.asarray(M + np.diag([self.parts[k].armature for k in self._owners]))

    def gravity_forces(self, gravity: Array) -> Array:
        """Gravity's part of h (n)."""
        acceleration = np.concatenate([np.zeros(3), gravity])
        return np.asarray(-np.einsum("in,nij,j->n", self._columns, self._composite[self._owners], acceleration))

    def jacobian(self, part: int) -> Array:
        """Twists of a part by the speeds that move it, in its own axes at zero coordinates (6, n of these)."""
        return np.asarray(adjoint(self.placed[part].inverse()) @ self._columns[:, self.moves[part]])


def random_coordinates(parts: Sequence[Moving], size: float, rng: np.random.Generator) -> list[Array]:
    """Random exponential coordinates: turns to both sides by up to two thirds of pi, slides by half the size."""
    scale = [np.where(np.linalg.norm(part.screws[:3], axis=0) > 0.5, 2.0, 0.5 * size) for part in parts]
    return [rng.uniform(-1.0, 1.0, len(most)) * most for most in scale]
