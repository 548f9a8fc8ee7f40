"""Rotations as formulas without branches: matrices, quaternions (x, y, z, w), rotation vectors, Euler angles.

Formulas of quaternions and rotation vectors are those of `symofros.base.rotations`.
"""

from __future__ import annotations

from symofros.base.rotations import TINY, quaternion_exp, quaternion_log, quaternion_matrix
from symofros.diagrams.tensor import Tensor, joined, stacked

# Axes of the three turns, applied left to right as matrices: R = R_a(x1) R_b(x2) R_c(x3).
EULER = tuple(a + b + c for a in "xyz" for b in "xyz" for c in "xyz" if b not in (a, c))


def length(v: Tensor) -> Tensor:
    """The Euclidean norm, never zero."""
    return ((v * v).sum() + TINY).apply("sqrt")


def matrix_of_vector(w: Tensor) -> Tensor:
    """R = exp([w]) of a rotation vector w (3) [rad]."""
    return Tensor.of_terms(w.g, quaternion_matrix(quaternion_exp(w.terms)))


def matrix_of_quaternion(quaternion: Tensor) -> Tensor:
    """R (3, 3) of a quaternion (4) of any length."""
    unit = quaternion / length(quaternion)
    return Tensor.of_terms(quaternion.g, quaternion_matrix(unit.terms))


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


def vector_of_matrix(R: Tensor) -> Tensor:
    """The rotation vector (3), of at most pi, of a rotation (3, 3) [rad]."""
    return Tensor.of_terms(R.g, quaternion_log(quaternion_of_matrix(R).terms))


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
    return (a * a + b * b + TINY).apply("sqrt")


def error_vector(R_desired: Tensor, R: Tensor) -> Tensor:
    """The rotation vector (3) that takes R to R_desired, in world axes [rad]."""
    return vector_of_matrix(R_desired @ R.T)
