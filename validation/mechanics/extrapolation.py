"""Values on meshes, each of twice the elements of the one before, and their limit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from .geometry import Array

# Steps below this share of the largest value may be rounding, and tell nothing of a rate.
RESOLVED = 1e-11


class Refined(NamedTuple):
    """A quantity on meshes.

    Attributes:
        name: What it is, for people.
        powers: Powers of the element length in its error, the lowest first, as many as values less one.
        values: Values, that of the coarsest mesh first.
    """

    name: str
    powers: Sequence[int]
    values: Sequence[Array]

    def limit(self) -> Array:
        """The value without the errors of these powers (Richardson)."""
        row = list(self.values)
        for power in self.powers[: len(row) - 1]:
            factor = 2.0**power
            row = [(factor * fine - coarse) / (factor - 1.0) for coarse, fine in pairwise(row)]
        return row[-1]

    def steps(self) -> list[float]:
        """Distances between meshes that follow each other, relative to the largest entry of the finest.

        Distances from the limit would show no rate but the one that the limit assumes.
        """
        size = float(np.abs(self.values[-1]).max()) or 1.0
        return [float(np.abs(fine - coarse).max()) / size for coarse, fine in pairwise(self.values)]

    def rate(self) -> float | None:
        """The power by which the finest steps that rounding does not hide fall; None where all are too small."""
        resolved = [pair for pair in pairwise(self.steps()) if pair[1] > RESOLVED]
        return math.log2(resolved[-1][0] / resolved[-1][1]) if resolved else None
