"""Vectors and rotations as they are stated, and frames of links."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Vector = tuple[float, float, float]
Rows = tuple[Vector, Vector, Vector]


def rows(matrix: Array) -> Rows:
    """A matrix (3, 3) as tuples."""
    a, b, c = (tuple(row) for row in np.asarray(matrix, dtype=float).tolist())
    return (a, b, c)


def vector(values: Array) -> Vector:
    """A vector (3) as a tuple."""
    x, y, z = np.asarray(values, dtype=float).tolist()
    return (x, y, z)


ORIGIN: Vector = (0.0, 0.0, 0.0)
IDENTITY: Rows = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


class End(NamedTuple):
    """A frame that a constraint holds.

    Attributes:
        link: Name of its link; "" for the world.
        R: Rotation (3, 3) in the link's frame.
        p: Position (3) in the link's frame [m].
    """

    link: str
    R: Rows = IDENTITY
    p: Vector = ORIGIN
