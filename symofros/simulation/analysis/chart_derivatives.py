"""Derivatives of a step's charts: of q0 (+) theta, and of the rates of theta (docs/theory/simulation.md, eq. 22, 23).

Linear coordinates are their own chart. Balls and free joints have blocks of 3 and 6 rows, the only ones that are kept.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from symofros.base.arrays import Array
from symofros.base.rotations import cross, quaternion_exp, rotate, rotation_vector_rate, skew
from symofros.runtime.record import Segment


@dataclass(frozen=True)
class BlockDiagonal:
    """Matrices (..., nv, nv) that are a diagonal of equal numbers but for blocks of consecutive rows.

    Attributes:
        diagonal: The number, 0 or 1.
        rows: Rows, and columns, of each block.
        blocks: Entries of each block (..., m, m).
    """

    diagonal: float
    rows: tuple[slice, ...]
    blocks: tuple[Array, ...]

    def times(self, at: Any, x: Array) -> Array:
        """The product of the matrix with index `at` with columns x (nv, k); x itself where there are no blocks."""
        return self._product(x, [block[at] for block in self.blocks])

    def transposed_times(self, at: Any, x: Array) -> Array:
        """The product of the transposed matrix with index `at` with a vector x (nv); x itself without blocks."""
        return self._product(x, [block[at].T for block in self.blocks])

    def _product(self, x: Array, blocks: Sequence[Array]) -> Array:
        if not self.rows:
            return x if self.diagonal else np.zeros_like(x)
        y = self.diagonal * x
        for rows, block in zip(self.rows, blocks, strict=True):
            y[rows] = block @ x[rows]
        return y


class ChartSlopes(NamedTuple):
    """Derivatives at points theta of charts about configurations q0, with changes of configurations along the manifold.

    Attributes:
        by_start: Change of q0 (+) theta as q0 changes: A.
        by_theta: Change of q0 (+) theta as theta changes: B.
        rate_by_theta: Change of theta' as theta changes: C.
        rate_by_v: Change of theta' as the speeds change: D.
    """

    by_start: BlockDiagonal
    by_theta: BlockDiagonal
    rate_by_theta: BlockDiagonal
    rate_by_v: BlockDiagonal


def chart_slopes(segments: Sequence[Segment], theta: Array, v: Array) -> ChartSlopes:
    """The derivatives at theta (..., nv), where the speeds are v (..., nv)."""
    curved = [segment for segment in segments if segment.kind != "linear"]
    rows = tuple(slice(segment.v, segment.v + segment.speeds) for segment in curved)
    found = [
        (_ball_derivatives if segment.kind == "quaternion" else _pose_derivatives)(theta[..., each], v[..., each])
        for segment, each in zip(curved, rows, strict=True)
    ]
    columns = [tuple(blocks[i] for blocks in found) for i in range(4)]
    return ChartSlopes(*(BlockDiagonal(float(i != 2), rows, blocks) for i, blocks in enumerate(columns)))


def _ball_derivatives(theta: Array, w: Array) -> tuple[Array, Array, Array, Array]:
    """A, B, C, D of a rotation vector theta (..., 3) at the angular velocity w (..., 3)."""
    turned = np.stack([rotate(quaternion_exp(theta), e) for e in np.eye(3)], axis=-2)  # exp([theta])^T
    rate_by_w = np.stack([rotation_vector_rate(theta, e) for e in np.eye(3)], axis=-1)
    moved: Array = np.asarray(np.linalg.inv(rate_by_w), dtype=np.float64)
    return turned, moved, _rate_slopes(theta, w), rate_by_w


def _pose_derivatives(theta: Array, v: Array) -> tuple[Array, Array, Array, Array]:
    """A, B, C, D of a displacement and a rotation vector theta (..., 6) at the twist v (..., 6)."""
    A, B, C, D = np.zeros((4, *theta.shape, 6))
    angular = slice(3, 6)
    A[..., angular, angular], B[..., angular, angular], C[..., angular, angular], D[..., angular, angular] = (
        _ball_derivatives(theta[..., 3:], v[..., 3:])
    )
    turned, moved = A[..., angular, angular], B[..., angular, angular]
    A[..., :3, :3] = B[..., :3, :3] = turned
    A[..., :3, angular] = -turned @ skew(theta[..., :3])
    D[..., :3, :3] = forward = np.swapaxes(turned, -1, -2)
    C[..., :3, angular] = -forward @ skew(v[..., :3]) @ moved
    return A, B, C, D


# Angle [rad] below which the series is exact to rounding, and the closed form loses digits.
_SERIES = 0.1


def _rate_slopes(theta: Array, w: Array) -> Array:
    """The derivative (..., 3, 3) of w + theta x w / 2 + c theta x (theta x w) by theta; c: simulation.md, (2)."""
    square = np.sum(theta * theta, axis=-1)[..., np.newaxis, np.newaxis]
    angle = np.sqrt(square)
    a = np.where(angle < _SERIES, 1.0, angle)
    cot, sine = 1.0 / np.tan(a / 2.0), np.sin(a / 2.0)
    closed_c = (1.0 - a / 2.0 * cot) / a**2
    closed_slope = ((a / (4.0 * sine**2) - cot / 2.0) / a - 2.0 * closed_c) / (2.0 * a**2)
    small = angle < _SERIES
    c = np.where(small, 1 / 12 + square * (1 / 720 + square * (1 / 30240 + square / 1209600)), closed_c)
    series = 1 / 720 + square * (1 / 15120 + square * (1 / 403200 + square / 11975040))
    slope = np.where(small, series, closed_slope)  # dc/d(angle^2)
    tw = cross(theta, w)
    ttw = cross(theta, tw)
    return np.asarray(
        -0.5 * skew(w)
        - c * (skew(tw) + skew(theta) @ skew(w))
        + 2.0 * slope * ttw[..., :, np.newaxis] * theta[..., np.newaxis, :]
    )
