"""Rotations, symmetric matrices and solutions in CasADi's scalars, which drop zeros and ones as they are built."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np

SX = Any  # CasADi has no types.

ZERO: SX = ca.SX.zeros(3)
UNIT: SX = ca.SX.eye(3)
# Numbers as near to -1, 0 or 1 as this are those: what is left of products of rotations.
_NOISE = 1e-13


def exact(values: Any) -> SX:
    """Numbers as constants, noise about -1, 0 and 1 taken off."""
    given = np.asarray(values, dtype=float)
    nearest = np.round(given) + 0.0  # No -0.0, which CasADi keeps.
    small = (np.abs(nearest) <= 1) & (np.abs(given - nearest) < _NOISE)
    return ca.SX(np.where(small, nearest, given))


def symmetric(A: SX) -> SX:
    """A matrix of which the entries above the diagonal count, so that no others are computed."""
    n = A.shape[0]
    return ca.blockcat([[A[min(i, j), max(i, j)] for j in range(n)] for i in range(n)])


def turned(R: SX, S: SX) -> SX:
    """R S R^T of a symmetric S."""
    return symmetric(R @ S @ R.T)


def about(axis: SX, s: SX, c: SX) -> SX:
    """The rotation about a unit axis by the angle of that sine and cosine; about one of coordinates, 0, 1, s and c."""
    along = axis @ axis.T
    return along + c * (UNIT - along) + s * ca.skew(axis)


def of_quaternion(e: SX) -> SX:
    """R of a unit quaternion (x, y, z, w)."""
    x, y, z, w = _entries(e)
    rows = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
        [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
        [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
    ]
    return ca.blockcat(rows)


def _entries(a: SX) -> list[SX]:
    return list(ca.vertsplit(a))


def solve(A: SX, columns: Sequence[SX]) -> SX:
    """A^-1 times columns, side by side, for a symmetric positive definite A.

    Eliminated from the last row to the first, which keeps the zeros between branches of a tree (L^T D L; Featherstone,
    Rigid Body Dynamics Algorithms, 8.4).
    """
    n = A.shape[0]
    L: dict[tuple[int, int], SX] = {}
    D: dict[int, SX] = {}
    for j in range(n - 1, -1, -1):
        scaled = [A[i, j] - sum((L[k, j] * D[k] * L[k, i] for k in range(j + 1, n)), ca.SX(0)) for i in range(j + 1)]
        D[j] = scaled[j]
        inverse = 1.0 / D[j]
        L |= {(j, i): inverse * scaled[i] for i in range(j)}
    return ca.horzcat(*(_substituted(L, D, column) for column in columns))


def _substituted(L: dict[tuple[int, int], SX], D: dict[int, SX], b: SX) -> SX:
    n, x = b.shape[0], _entries(b)
    for i in range(n - 1, -1, -1):
        x[i] = x[i] - sum((L[k, i] * x[k] for k in range(i + 1, n)), ca.SX(0))
    x = [x[i] / D[i] for i in range(n)]
    for i in range(n):
        x[i] = x[i] - sum((L[i, k] * x[k] for k in range(i)), ca.SX(0))
    return ca.vertcat(*x)
