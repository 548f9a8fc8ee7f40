"""Placements in foreign files: quaternions, turns, angles, and exact numbers for rounded ones."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.base.rotations import axis_rotation, nearest_rotation, quaternion_matrix
from symofros.description.values import IDENTITY, Rotation, Vector
from symofros.expr.numerics.extended import nearest


def rotation_of(quaternion: Any) -> Array:
    """The rotation matrix (3, 3) of a quaternion of MuJoCo's (w, x, y, z), of any length."""
    components = np.asarray(quaternion, dtype=float)
    w, x, y, z = components / math.sqrt(math.fsum(components * components))
    return quaternion_matrix(np.array([x, y, z, w]))


def about(axis: Array, angle: float) -> Array:
    """The rotation matrix (3, 3) by an angle [rad] about a unit axis (3,), the same on every machine."""
    return axis_rotation(axis, nearest("cos", angle), nearest("sin", angle))


def roll_pitch_yaw(angles: Sequence[float]) -> Array:
    """The rotation matrix (3, 3) of fixed-axis roll, pitch and yaw [rad]: Rz(yaw) Ry(pitch) Rx(roll)."""
    x, y, z = (about(axis, angle) for axis, angle in zip(np.eye(3), angles, strict=True))
    return np.asarray(z @ y @ x)


def matrix_of(rotation: Rotation) -> Array:
    """The matrix (3, 3) of a rotation that a reader made of numbers: by angles or by its entries."""
    numbers = [float(value) for value in rotation.values if isinstance(value, int | float)]
    return roll_pitch_yaw(numbers) if rotation.kind == "rpy" else np.reshape(numbers, (3, 3))


def stated_rotation(R: Array) -> Rotation:
    """A rotation matrix (3, 3) as a description states it; none for the identity."""
    return IDENTITY if np.array_equal(R, np.eye(3)) else Rotation.matrix(R.tolist())


class Exact:
    """Replaces numbers that rounding put beside exact ones.

    Attributes:
        tolerance: Largest distance.
        changed: Number of values replaced so far.
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
        return stated_rotation(nearest_rotation(self._snapped(R, (0.0, 1.0, -1.0))))

    def placement(self, p: Array, R: Array) -> tuple[Vector, Rotation]:
        """A position and a rotation."""
        return self.vector(p), self.rotation(R)
