"""Vectors, rotations and symmetric matrices over CasADi's scalars, which drop zeros and ones as they are built."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

# A CasADi SX or a number; typed as what CasADi's missing types amount to.
Scalar = Any
Vector = Sequence[Scalar]
# Rows.
Matrix = Sequence[Sequence[Scalar]]

ZERO: Vector = (0.0, 0.0, 0.0)
# Numbers as near to -1, 0 or 1 as this are those: what is left of products of rotations.
_NOISE = 1e-13


def exact(values: Any) -> Any:
    """Nested numbers, noise about -1, 0 and 1 taken off."""
    if hasattr(values, "__len__"):
        return [exact(value) for value in values]
    nearest = round(float(values))
    return float(nearest) if abs(nearest) <= 1 and abs(values - nearest) < _NOISE else float(values)


def add(*vectors: Vector) -> Vector:
    """The sum."""
    return [sum(parts[1:], parts[0]) for parts in zip(*vectors, strict=True)]


def sub(a: Vector, b: Vector) -> Vector:
    """The difference."""
    return [x - y for x, y in zip(a, b, strict=True)]


def scale(k: Scalar, a: Vector) -> Vector:
    """Multiples."""
    return [k * x for x in a]


def dot(a: Vector, b: Vector) -> Scalar:
    """The inner product."""
    products = [x * y for x, y in zip(a, b, strict=True)]
    return sum(products[1:], products[0])


def cross(a: Vector, b: Vector) -> Vector:
    """The cross product."""
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def times(A: Matrix, b: Vector) -> Vector:
    """Matrix times vector."""
    return [dot(row, b) for row in A]


def transposed(A: Matrix) -> Matrix:
    """Columns as rows."""
    return list(zip(*A, strict=True))


def product(A: Matrix, B: Matrix) -> Matrix:
    """Matrix times matrix."""
    columns = transposed(B)
    return [[dot(row, column) for column in columns] for row in A]


def skew(a: Vector) -> Matrix:
    """The matrix of the cross product with a."""
    return [[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]]


def plus(A: Matrix, B: Matrix) -> Matrix:
    """The sum of matrices."""
    return [add(a, b) for a, b in zip(A, B, strict=True)]


def symmetric(entry: Any) -> Matrix:
    """A 3 x 3 matrix of which entry(i, j) is asked for i <= j only."""
    upper = {(i, j): entry(i, j) for i in range(3) for j in range(i, 3)}
    return [[upper[min(i, j), max(i, j)] for j in range(3)] for i in range(3)]


def turned(R: Matrix, S: Matrix) -> Matrix:
    """R S R^T of a symmetric S."""
    half = product(R, S)
    return symmetric(lambda i, j: dot(half[i], R[j]))


def about(axis: Vector, s: Scalar, c: Scalar) -> Matrix:
    """The rotation about a unit axis by the angle of that sine and cosine."""
    x, y, z = axis
    d = 1.0 - c
    if sum(1 for part in axis if part != 0.0) == 1:
        # About an axis of coordinates 1 - cos cancels, and c is left.
        k = next(i for i in range(3) if axis[i] != 0.0)
        i, j = (k + 1) % 3, (k + 2) % 3
        R: list[list[Scalar]] = [[0.0] * 3 for _ in range(3)]
        R[k][k], R[i][i], R[j][j] = 1.0, c, c
        R[i][j], R[j][i] = -axis[k] * s, axis[k] * s
        return R
    return [
        [c + d * x * x, d * x * y - s * z, d * x * z + s * y],
        [d * x * y + s * z, c + d * y * y, d * y * z - s * x],
        [d * x * z - s * y, d * y * z + s * x, c + d * z * z],
    ]


def of_quaternion(e: Vector) -> Matrix:
    """R of a unit quaternion (x, y, z, w)."""
    x, y, z, w = e
    return [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
        [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
        [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
    ]


def solve(A: Matrix, columns: Sequence[Vector]) -> list[Vector]:
    """A^-1 times columns for a symmetric positive definite A.

    Eliminated from the last row to the first, which keeps the zeros between branches of a tree (L^T D L; Featherstone,
    Rigid Body Dynamics Algorithms, 8.4).
    """
    rows = range(len(A) - 1, -1, -1)
    L: dict[tuple[int, int], Scalar] = {}
    D: dict[int, Scalar] = {}
    for j in rows:
        scaled = {}
        for i in range(j + 1):
            scaled[i] = A[i][j] - sum((L[k, j] * D[k] * L[k, i] for k in range(j + 1, len(A))), 0.0)
        D[j] = scaled[j]
        inverse = 1.0 / D[j]
        L |= {(j, i): inverse * scaled[i] for i in range(j)}
    return [_substituted(L, D, column) for column in columns]


def _substituted(L: dict[tuple[int, int], Scalar], D: dict[int, Scalar], b: Vector) -> Vector:
    n, x = len(b), list(b)
    for i in range(n - 1, -1, -1):
        x[i] = x[i] - sum((L[k, i] * x[k] for k in range(i + 1, n)), 0.0)
    x = [x[i] / D[i] for i in range(n)]
    for i in range(n):
        x[i] = x[i] - sum((L[i, k] * x[k] for k in range(i)), 0.0)
    return x
