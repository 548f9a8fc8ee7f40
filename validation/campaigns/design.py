"""Which values the parameters of a sweep take."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, model_validator

from ..mechanics.geometry import Array

Design = Literal["grid", "latin_hypercube", "sobol"]

MAX_POINTS = 10**6


class Range(BaseModel):
    """The values of one parameter.

    Attributes:
        low: The smallest.
        high: The largest.
        count: Number of values, evenly spaced; for a grid only.
        log: Whether even spacing is that of logarithms.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    low: Annotated[float, Field(allow_inf_nan=False)]
    high: Annotated[float, Field(allow_inf_nan=False)]
    count: Annotated[int, Field(ge=1, le=MAX_POINTS)] | None = None
    log: bool = False

    @model_validator(mode="after")
    def _sound(self) -> Range:
        if not self.low <= self.high:
            raise ValueError(f"low {self.low:g} is above high {self.high:g}")
        if self.log and self.low <= 0.0:
            raise ValueError(f"logarithms need values above zero, low is {self.low:g}")
        return self

    def at(self, share: Array) -> Array:
        """The values at shares 0 … 1 of the way; the ends are met exactly."""
        if not self.log:
            return self.low + share * (self.high - self.low)
        inside = np.exp(math.log(self.low) + share * (math.log(self.high) - math.log(self.low)))
        return np.clip(inside, self.low, self.high)


def points_of(
    over: Mapping[str, Range], design: Design, points: int | None, seed: int, first: int = 0, count: int | None = None
) -> Array:
    """Some of the points of a design.

    Args:
        over: Parameter -> its values.
        design: Way in which they combine.
        points: Number of points, unless the design is a grid.
        seed: Seed of the spread.
        first: Number of the first point wanted.
        count: Number of values wanted; None: all that follow.

    Returns:
        One row a point, one column a parameter, (count, n).

    Raises:
        ValueError: The numbers of points do not suit the design.
    """
    shares = _grid(over, points) if design == "grid" else _spread(over, design, points, seed, count)
    chosen = shares[first:] if count is None else shares[first : first + count]
    return np.stack([values.at(chosen[:, k]) for k, values in enumerate(over.values())], axis=1)


def _grid(over: Mapping[str, Range], points: int | None) -> Array:
    if points is not None:
        raise ValueError("a grid has a 'count' for each parameter; 'points' belongs to other designs")
    counts = [values.count for values in over.values()]
    if None in counts:
        name = next(name for name, values in over.items() if values.count is None)
        raise ValueError(f"a grid needs the 'count' of '{name}'")
    whole = [count for count in counts if count is not None]
    if math.prod(whole) > MAX_POINTS:
        raise ValueError(f"a grid of {math.prod(whole)} points; at most {MAX_POINTS}")
    axes = [np.linspace(0.0, 1.0, count) for count in whole]
    return np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=1)


def _spread(over: Mapping[str, Range], design: Design, points: int | None, seed: int, count: int | None) -> Array:
    if points is None:
        raise ValueError(f"design '{design}' needs 'points'")
    for name, values in over.items():
        if values.count is not None:
            raise ValueError(f"'count' of '{name}' belongs to a grid; '{design}' has 'points'")
    if design == "sobol" and points & (points - 1):
        raise ValueError(f"a Sobol sequence is even over powers of two, {points} points are none")
    if count == 0:
        return np.empty((0, len(over)))
    from scipy.stats import qmc  # Half a second, which every worker of a check would take.

    if design == "sobol":
        return np.asarray(qmc.Sobol(len(over), seed=seed).random(points))
    return np.asarray(qmc.LatinHypercube(len(over), seed=seed).random(points))
