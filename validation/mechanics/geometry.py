"""Rotations, placements and quaternions in plain NumPy, written apart from `symofros.mechanics.kinematics`.

The engines' models are built with these, so an error in the generator's own geometry can't hide in both sides.
Quaternions are (x, y, z, w). Functions on quaternions and vectors accept leading batch dimensions.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Placement:
    """A frame B placed in a frame A.

    Attributes:
        R: R_AB (3, 3).
        p: p_AB, from Ao to Bo, in A (3,) [m].
    """

    R: Array
    p: Array

    @staticmethod
    def identity() -> Placement:
        """B coincides with A."""
        return Placement(np.eye(3), np.zeros(3))

    def __matmul__(self, other: Placement) -> Placement:
        """A to B, then B to C."""
        return Placement(self.R @ other.R, self.p + self.R @ other.p)


def skew(p: Array) -> Array:
    """[p]x, the matrix of the cross product with p (..., 3, 3)."""
    zero = np.zeros_like(p[..., 0])
    x, y, z = p[..., 0], p[..., 1], p[..., 2]
    rows = [zero, -z, y, z, zero, -x, -y, x, zero]
    return np.stack(rows, axis=-1).reshape(*p.shape[:-1], 3, 3)


def about_axis(axis: Array, angle: float) -> Array:
    """The rotation by `angle` [rad] about a unit axis, by Rodrigues' formula (3, 3)."""
    K = skew(axis)
    return np.asarray(np.eye(3) + math.sin(angle) * K + (1.0 - math.cos(angle)) * (K @ K))


def rotation_matrix(kind: str, values: Array) -> Array:
    """R_AB of a rotation as a description states it.

    Args:
        kind: "rpy", "axis_angle", "quaternion" or "matrix", as in `symofros.Rotation`.
        values: Numbers of the rotation, in the order of its kind.
    """
    if kind == "matrix":
        return nearest_rotation(values.reshape(3, 3))
    if kind == "quaternion":
        return quaternion_matrix(values / np.linalg.norm(values))
    if kind == "axis_angle":
        return about_axis(values[:3] / np.linalg.norm(values[:3]), float(values[3]))
    x, y, z = np.eye(3)
    roll, pitch, yaw = map(float, values)
    return about_axis(z, yaw) @ about_axis(y, pitch) @ about_axis(x, roll)


def nearest_rotation(matrix: Array) -> Array:
    """The rotation nearest to a matrix that was typed with few digits (polar factor)."""
    U, _, Vt = np.linalg.svd(matrix)
    return np.asarray(U @ Vt)


def quaternion_matrix(quaternion: Array) -> Array:
    """R of unit quaternions (..., 4) -> (..., 3, 3)."""
    K = skew(quaternion[..., :3])
    return np.asarray(np.eye(3) + 2.0 * quaternion[..., 3, None, None] * K + 2.0 * (K @ K))


def matrix_quaternion(R: Array) -> Array:
    """The unit quaternions of rotation matrices (..., 3, 3) -> (..., 4).

    The largest of the four components is taken from the diagonal, so that no digits cancel (Shepperd 1978).
    """
    trace = np.trace(R, axis1=-2, axis2=-1)[..., None]
    diagonal = np.diagonal(R, axis1=-2, axis2=-1)
    # 4 q q^T, of which the row of the largest component is taken.
    products = np.empty((*R.shape[:-2], 4, 4))
    products[..., :3, :3] = R + R.swapaxes(-1, -2)
    products[..., [0, 1, 2], [0, 1, 2]] = 1.0 + 2.0 * diagonal - trace
    products[..., 3, 3] = 1.0 + trace[..., 0]
    spin = np.stack([R[..., 2, 1] - R[..., 1, 2], R[..., 0, 2] - R[..., 2, 0], R[..., 1, 0] - R[..., 0, 1]], axis=-1)
    products[..., 3, :3] = products[..., :3, 3] = spin
    largest = np.argmax(np.diagonal(products, axis1=-2, axis2=-1), axis=-1)
    row = np.take_along_axis(products, largest[..., None, None], -2)[..., 0, :]
    return np.asarray(row / np.linalg.norm(row, axis=-1, keepdims=True))


def quaternion_product(a: Array, b: Array) -> Array:
    """The Hamilton product a b: R(a b) = R(a) R(b) (..., 4)."""
    va, wa, vb, wb = a[..., :3], a[..., 3:], b[..., :3], b[..., 3:]
    vector = wa * vb + wb * va + np.cross(va, vb)
    scalar = wa * wb - np.sum(va * vb, axis=-1, keepdims=True)
    return np.concatenate([vector, scalar], axis=-1)
