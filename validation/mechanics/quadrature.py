"""Gauss-Legendre quadrature over pieces of an interval."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from .geometry import Array

# Name of the station [m] in formulas of a beam's section.
STATION = "x"


def gauss_stations(knots: Sequence[float], points: int) -> tuple[Array, Array]:
    """Nodes (n,), rising, and weights (n,) of quadrature over all intervals between knots.

    Args:
        knots: Ends of the intervals, rising.
        points: Nodes an interval.
    """
    nodes, weights = np.polynomial.legendre.leggauss(points)
    halves = [((a + b) / 2, (b - a) / 2) for a, b in pairwise(knots)]
    return (
        np.concatenate([middle + half * nodes for middle, half in halves]),
        np.concatenate([half * weights for _, half in halves]),
    )
