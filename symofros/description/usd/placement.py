"""Placements of prims: USD's matrices as rotations, scales and positions, in SI units."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.description.frames import Pose
from symofros.description.imported.geometry import rotation_of

# Axes of a frame that deviate by more from right angles are sheared, for which a rigid body has no use.
SHEAR = 1e-6


@dataclass(frozen=True)
class Affine:
    """Where a prim's coordinates lie in the world: x_W = A x + p.

    Attributes:
        A: Linear part (3, 3), with the prim's scale.
        p: Origin (3,) [m].
    """

    A: Array
    p: Array

    @property
    def scale(self) -> Array:
        """Factors along the prim's axes (3,)."""
        return np.asarray(np.sqrt((self.A * self.A).sum(axis=0)))

    @property
    def is_rigid(self) -> bool:
        """Whether it turns, shifts and scales along the prim's axes, and does nothing else."""
        scale = self.scale
        if not np.all(np.isfinite(self.A)) or not np.all(scale > 0.0):
            return False
        R = self.A / scale
        return bool(np.abs(R.T @ R - np.eye(3)).max() <= SHEAR and np.linalg.det(R) > 0.0)

    @property
    def pose(self) -> Pose:
        """The prim's frame in the world, without its scale."""
        return Pose(self.p, self.A / self.scale)

    def point(self, x: Array) -> Array:
        """A point (3,) of the prim, in the world."""
        return np.asarray(self.A @ x + self.p)


def affine(rows: list[list[float]] | None, meters: float) -> Affine:
    """The placement that a matrix of USD's states, whose rows are images of axes; the identity where there is none.

    Args:
        rows: The matrix (4, 4), in the stage's unit of length.
        meters: Metres in that unit.
    """
    if rows is None:
        return Affine(np.eye(3) * meters, np.zeros(3))
    M = np.array(rows, dtype=float)
    return Affine(M[:3, :3].T * meters, M[3, :3] * meters)


def turn(quaternion: Any) -> Array:
    """The rotation (3, 3) of a quaternion (w, x, y, z) of any length; the identity where none is stated, or zero."""
    if quaternion is None or not any(quaternion):
        return np.eye(3)
    return rotation_of(quaternion)
