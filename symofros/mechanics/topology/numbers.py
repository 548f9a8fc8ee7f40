"""The description at its parameters' default values: are its numbers numbers, its rotations rotations."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.base.rotations import axis_rotation, nearest_rotation, quaternion_matrix, unit_scale
from symofros.description.joints.joint import Joint
from symofros.description.system import System
from symofros.description.values import Rotation, Value, symbols
from symofros.errors import Problem
from symofros.expr.expression import evaluate

# Entries typed with seven digits still pass; a reflection or a shear does not.
ROTATION_TOLERANCE = 1e-6


class Numbers:
    """Evaluates values of a system at its parameters' defaults.

    Args:
        system: The system, whose parameters have default values.
        more: Values of further symbols.
    """

    def __init__(self, system: System, more: Mapping[str, float] | None = None) -> None:
        self.system = system
        self.parameters = {**system.parameter_values(), **(more or {})}

    def extended(self, more: Mapping[str, float]) -> Numbers:
        """The same numbers with values of further symbols, such as coordinates."""
        return Numbers(self.system, {**self.parameters, **more})

    def value(self, value: Value) -> float:
        """The number of a value; NaN where it has none."""
        try:
            return float(evaluate(value, self.parameters))
        except (ArithmeticError, KeyError):
            return math.nan

    def values(self, values: Any) -> Array:
        """The numbers of several values."""
        return np.array([self.value(value) for value in values])

    def rotation(self, rotation: Rotation) -> Array:
        """The 3x3 matrix of a rotation; NaN where it has none."""
        x = self.values(rotation)
        if not np.all(np.isfinite(x)):
            return np.full((3, 3), math.nan)
        if rotation.kind == "matrix":
            R = x.reshape(3, 3)
            return nearest_rotation(R) if _defect(R) <= ROTATION_TOLERANCE else R
        if rotation.kind == "rpy":
            roll, pitch, yaw = (_about(axis, angle) for axis, angle in zip(np.eye(3), x, strict=True))
            return np.asarray(yaw @ pitch @ roll)
        direction = unit_scale(x if rotation.kind == "quaternion" else x[:3])
        if not direction.any():
            return np.full((3, 3), math.nan)
        direction = direction / np.linalg.norm(direction)
        return quaternion_matrix(direction) if rotation.kind == "quaternion" else _about(direction, x[3])

    def rotation_problems(self, what: str, rotation: Any, where: str) -> Iterator[Problem]:
        """A rotation that is none."""
        if rotation.is_identity:
            return
        if not np.all(np.isfinite(self.values(rotation))):
            return  # Reported as values that are not finite.
        R = self.rotation(rotation)
        if not np.all(np.isfinite(R)):
            yield Problem(
                f"{what}: has no direction",
                f"{rotation.kind} {_show(rotation)}",
                "axis and quaternion are neither zero nor endless",
                "give a direction",
                where,
            )
            return
        error = _defect(R)
        if error > ROTATION_TOLERANCE or np.linalg.det(R) < 0.0:
            yield Problem(
                f"{what}: the matrix is not a rotation",
                f"|R R^T - 1| = {error:.2g}, determinant {np.linalg.det(R):.3g}",
                f"R R^T = 1 within {ROTATION_TOLERANCE:g} and determinant +1",
                "give more digits, or state it as rpy, axis_angle or quaternion",
                where,
            )

    def rounded(self, rotation: Rotation) -> float:
        """Defect |R R^T - 1| of a matrix of numbers, which may be stated with few digits; 0 for other rotations."""
        if rotation.kind != "matrix" or any(map(symbols, rotation)):
            return 0.0
        return _defect(self.values(rotation).reshape(3, 3))

    def axis_problems(self, joint: Joint, where: str) -> Iterator[Problem]:
        """An axis of no length, or of one that overflows."""
        if not 1e-9 < np.linalg.norm(self.values(joint.axis)) < math.inf:
            yield Problem(
                f"joint '{joint.name}': the axis has no direction",
                _show(joint.axis),
                "the axis of a joint is neither zero nor endless",
                "give a direction such as [0, 0, 1]",
                where,
            )


def _defect(R: Array) -> float:
    """|R R^T - 1|, by its largest entry."""
    return float(np.abs(R @ R.T - np.eye(3)).max())


def _about(axis: Array, angle: float) -> Array:
    return axis_rotation(axis, math.cos(angle), math.sin(angle))


def _show(values: Any) -> str:
    return "[" + ", ".join(str(value) for value in values) + "]"
