"""Rotations as formulas without branches: matrices, quaternions (x, y, z, w), rotation vectors, Euler angles.

Where a formula has a removable singularity, a number far below rounding is added under a square root, which leaves
sin(a)/a and its like at 1 where a is 0.
"""

from __future__ import annotations

import numpy as np

from symofros.diagrams.tensor import Tensor, joined, stacked
from symofros.expr import Quaternion

# Its root is 1e-150: lost beside any length that is not zero itself.
_TINY = 1e-300
# Square of the angle below which a series of four terms is exact to rounding [rad^2].
_SERIES = 0.01
# Axes of the three turns, applied left to right as matrices: R = R_a(x1) R_b(x2) R_c(x3).
EULER = tuple(a + b + c for a in "xyz" for b in "xyz" for c in "xyz" if b not in (a, c))


def length(v: Tensor) -> Tensor:
    """The Euclidean norm, never zero."""
    return ((v * v).sum() + _TINY).apply("sqrt")


def skew(w: Tensor) -> Tensor:
    """The matrix (3, 3) of w x."""
    zero = w[0] * 0.0
    rows = [[zero, -w[2], w[1]], [w[2], zero, -w[0]], [-w[1], w[0], zero]]
    return stacked([joined(row) for row in rows])


def matrix_of_vector(w: Tensor) -> Tensor:
    """R = exp([w]) of a rotation vector w (3) [rad]: Rodrigues' formula."""
    angle = length(w)
    half = (0.5 * angle).apply("sin") / (0.5 * angle)
    K = skew(w)
    return (angle.apply("sin") / angle) * K + (0.5 * half * half) * (K @ K) + np.eye(3)


def matrix_of_quaternion(quaternion: Tensor) -> Tensor:
    """R (3, 3) of a quaternion (4) of any length."""
    unit = _quaternion(quaternion / length(quaternion))
    return Tensor.of(quaternion.g, unit.matrix.entries, (3, 3))


def _quaternion(tensor: Tensor) -> Quaternion:
    return Quaternion.of(tensor.g, *tensor.flat)


def quaternion_of_matrix(R: Tensor) -> Tensor:
    """The quaternion (4) with w >= 0 of a rotation (3, 3).

    Of the four columns of 4 q q^T, which are linear in R, the one with the largest diagonal is taken: no digits are
    lost at any angle.
    """
    r = [[R[i, j] for j in range(3)] for i in range(3)]
    rows = [
        [1.0 + r[0][0] - r[1][1] - r[2][2], r[0][1] + r[1][0], r[0][2] + r[2][0], r[2][1] - r[1][2]],
        [r[0][1] + r[1][0], 1.0 - r[0][0] + r[1][1] - r[2][2], r[1][2] + r[2][1], r[0][2] - r[2][0]],
        [r[0][2] + r[2][0], r[1][2] + r[2][1], 1.0 - r[0][0] - r[1][1] + r[2][2], r[1][0] - r[0][1]],
        [r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1], 1.0 + r[0][0] + r[1][1] + r[2][2]],
    ]
    total = None
    left = 1.0 + R[0, 0] * 0.0
    for i in (3, 0, 1, 2):
        is_largest = left
        for j in range(4):
            if j != i:
                is_largest = is_largest * (rows[i][i] - rows[j][j]).apply("step")
        left = left * (1.0 - is_largest)
        column = is_largest * joined(rows[i])
        total = column if total is None else total + column
    assert total is not None
    return _upper(total / length(total))


def _upper(quaternion: Tensor) -> Tensor:
    """The one of q and -q with w >= 0."""
    return quaternion * (2.0 * quaternion[3].apply("step") - 1.0)


def vector_of_quaternion(quaternion: Tensor) -> Tensor:
    """The rotation vector (3), of at most pi, of a quaternion (4) of any length [rad]."""
    return Tensor.of(quaternion.g, _quaternion(quaternion).logarithm, (3,))


def vector_of_matrix(R: Tensor) -> Tensor:
    """The rotation vector (3), of at most pi, of a rotation (3, 3) [rad]."""
    return vector_of_quaternion(quaternion_of_matrix(R))


def rotation_between(a: Tensor, b: Tensor) -> Tensor:
    """The rotation vector (3), in body axes, from one unit quaternion (4) to another [rad]."""
    return Tensor.of(a.g, (_quaternion(a).conjugate * _quaternion(b)).logarithm, (3,))


def matrix_of_euler(angles: Tensor, sequence: str) -> Tensor:
    """R (3, 3) of three turns about the axes of a sequence, such as "zyx": R = Rz(x1) Ry(x2) Rx(x3)."""
    first, second, third = (_turn("xyz".index(axis), angles[i]) for i, axis in enumerate(sequence))
    return first @ second @ third


def _turn(k: int, angle: Tensor) -> Tensor:
    c, s = angle.apply("cos"), angle.apply("sin")
    i, j = (k + 1) % 3, (k + 2) % 3
    entries = [[c * 0.0 + float(row == column) for column in range(3)] for row in range(3)]
    entries[i][i] = entries[j][j] = c
    entries[i][j], entries[j][i] = -s, s
    return stacked([joined(row) for row in entries])


def euler_of_matrix(R: Tensor, sequence: str) -> Tensor:
    """Three angles [rad] of a rotation (3, 3): the second within +-pi/2, or within 0 to pi where axes repeat.

    Where the second angle aligns the other two axes, only their sum or difference is defined: the third is zero then.
    """
    i, j = "xyz".index(sequence[0]), "xyz".index(sequence[1])
    k, repeats = 3 - i - j, sequence[0] == sequence[2]
    sign = 1.0 if (j - i) % 3 == 1 else -1.0
    if repeats:
        side = _pair(R[i, j], R[i, k])
        second = side.apply("atan2", R[i, i])
        first = R[j, i].apply("atan2", -sign * R[k, i])
    else:
        side = _pair(R[i, i], R[i, j])
        second = (sign * R[i, k]).apply("atan2", side)
        first = (-sign * R[j, k]).apply("atan2", R[k, k])
    regular = (side - _ALIGNED).apply("step")
    first = first * regular + (1.0 - regular) * (sign * R[k, j]).apply("atan2", R[j, j])
    # Row j of what is left once the first turn is undone is that of the third turn alone.
    c, s = first.apply("cos"), first.apply("sin")
    row = [c * R[j, n] + sign * s * R[k, n] for n in range(3)]
    third = (-sign * row[k] if repeats else sign * row[i]).apply("atan2", row[j])
    return joined([first, second, regular * third])


# Sine or cosine of the second angle below which the other two axes are one but for rounding.
_ALIGNED = 1e-14


def _pair(a: Tensor, b: Tensor) -> Tensor:
    return (a * a + b * b + _TINY).apply("sqrt")


def error_vector(R_desired: Tensor, R: Tensor) -> Tensor:
    """The rotation vector (3) that takes R to R_desired, in world axes [rad]."""
    return vector_of_matrix(R_desired @ R.T)


def position_of_step(w: Tensor, shift: Tensor) -> Tensor:
    """The linear part (3) of the step that turns by w (3) and leads to a position (3): the inverse left Jacobian.

    J^-1 p = p - w x p / 2 + c w x (w x p), c = (1 - (a/2) cot(a/2)) / a^2, a = |w|, by its series where a is small.
    """
    angle = length(w)
    half, a2 = 0.5 * angle, angle * angle
    series = 1.0 / 12.0 + a2 * (1.0 / 720.0 + a2 * (1.0 / 30240.0 + a2 / 1209600.0))
    # Where the series holds, the other formula must still be finite: it is at one radian.
    large = (a2 - _SERIES).apply("step")
    safe = half * large + 0.5 * (1.0 - large)
    closed = (1.0 - safe * safe.apply("cos") / safe.apply("sin")) / (4.0 * safe * safe)
    once = w.cross(shift)
    return shift - 0.5 * once + (large * closed + (1.0 - large) * series) * w.cross(once)
