"""Placements of a compiled MJCF model: quaternions, turns, and exact numbers for rounded ones."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from symofros.description.values import IDENTITY, Rotation, Vector
from symofros.expr.extended import nearest

Array = npt.NDArray[np.float64]


def turned(quaternion: Any) -> Array:
    """The rotation matrix (3, 3) of a quaternion (w, x, y, z), normalised."""
    components = np.asarray(quaternion, dtype=float)
    w, x, y, z = components / math.sqrt(math.fsum(components * components))
    K = cross(np.array([x, y, z]))
    return np.asarray(np.eye(3) + 2.0 * w * K + 2.0 * times(K, K))


def about(axis: Array, angle: float) -> Array:
    """The rotation matrix (3, 3) of a turn [rad] about a unit axis (3,)."""
    K = cross(axis)
    return np.asarray(np.eye(3) + nearest("sin", angle) * K + (1.0 - nearest("cos", angle)) * times(K, K))


def times(R: Array, x: Array) -> Array:
    """The product of a matrix (3, 3) with a vector (3,) or a matrix (3, 3), rounded alike on every machine."""
    columns = R[:, :, np.newaxis] if x.ndim == 2 else R
    return np.asarray(columns[:, 0] * x[0] + columns[:, 1] * x[1] + columns[:, 2] * x[2])


def cross(p: Array) -> Array:
    """The matrix (3, 3) of the cross product with p (3,)."""
    return np.array([[0.0, -p[2], p[1]], [p[2], 0.0, -p[0]], [-p[1], p[0], 0.0]])


class Exact:
    """Replaces numbers that rounding put beside exact ones.

    Attributes:
        tolerance: Largest distance.
        changed: How many numbers were replaced.
    """

    def __init__(self, tolerance: float) -> None:
        self.tolerance = tolerance
        self.changed = 0

    def _snapped(self, values: Array, exact: tuple[float, ...]) -> Array:
        result = np.array(values, dtype=float)
        for value in exact:
            near = (np.abs(result - value) <= self.tolerance) & (result != value)
            result[near] = value
            self.changed += int(near.sum())
        return result

    def vector(self, values: Array) -> Vector:
        """A position or the like (3,): zeros."""
        x, y, z = self._snapped(values, (0.0,)).tolist()
        return x, y, z

    def direction(self, values: Array) -> Vector:
        """A unit vector (3,): zeros and ones."""
        x, y, z = self._snapped(values, (0.0, 1.0, -1.0)).tolist()
        return x, y, z

    def rotation(self, R: Array) -> Rotation:
        """A rotation matrix (3, 3): zeros and ones."""
        R = self._snapped(R, (0.0, 1.0, -1.0))
        return IDENTITY if np.array_equal(R, np.eye(3)) else Rotation.matrix(R.tolist())

    def placement(self, p: Array, R: Array) -> tuple[Vector, Rotation]:
        """A position and a rotation."""
        return self.vector(p), self.rotation(R)
