"""Planar joints of URDF: motion in the plane across an axis, where ours is in the plane across z of P."""

from __future__ import annotations

import numpy as np

from symofros.base.arrays import Array
from symofros.base.rotations import skew
from symofros.description.imported.geometry import matrix_of
from symofros.description.values import Rotation, Vector


def planar_frames(rotation: Rotation, axis: Vector) -> tuple[Rotation, Rotation | None]:
    """Rotation to P, and from the frame that the joint moves to the child; None where that is the child's own.

    P is the joint's frame, turned so that its z lies along the axis: by the shortest turn, and after half a turn about
    x where the axis points to below.

    Args:
        rotation: Rotation to the joint's frame, roll, pitch and yaw.
        axis: Normal of the plane in that frame, not zero.
    """
    n = np.array(axis, dtype=float)
    R = _turn_to(n / np.linalg.norm(n)) if n.any() else np.eye(3)
    if np.array_equal(R, np.eye(3)):
        return rotation, None
    placed = matrix_of(rotation) @ R
    return Rotation.matrix(placed.tolist()), Rotation.matrix(R.T.tolist())


def _turn_to(n: Array) -> Array:
    """A rotation (3, 3) that takes z to a unit vector (3,): the shortest, or after half a turn about x, from -z."""
    if n[2] < 0.0:  # Near the opposite of z the axis of the shortest turn is noise.
        half = np.diag([1.0, -1.0, -1.0])
        return np.asarray(half @ _turn_to(half @ n))
    V = skew(np.array([-n[1], n[0], 0.0]))
    return np.asarray(np.eye(3) + V + V @ V / (1.0 + n[2]))
