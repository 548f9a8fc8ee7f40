"""Families of shape functions, and functions of the user's own."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal, get_args

from symofros.description.entries import refuses_unknown_entries
from symofros.description.values import Value, as_value
from symofros.errors import DescriptionError

Family = Literal["spline", "polynomial", "legendre", "clamped_free", "hermite", "user"]
FAMILIES: tuple[Family, ...] = get_args(Family)


@refuses_unknown_entries
@dataclass(frozen=True)
class Samples:
    """A shape function by its values at stations; a cubic spline goes through them, the cubic itself where it is one.

    Attributes:
        xi: Stations x/L of the samples, rising from 0 to 1.
        values: Values of the function at the stations.
    """

    xi: tuple[float, ...]
    values: tuple[float, ...]

    def __post_init__(self) -> None:
        """Convert, and check the stations."""
        object.__setattr__(self, "xi", tuple(float(x) for x in self.xi))
        object.__setattr__(self, "values", tuple(float(x) for x in self.values))
        rising = all(a < b for a, b in zip(self.xi, self.xi[1:], strict=False))
        if len(self.xi) < 4 or len(self.xi) != len(self.values) or not rising or (self.xi[0], self.xi[-1]) != (0, 1):
            raise DescriptionError(
                "sampled shape function: unusable stations",
                f"{len(self.xi)} stations, {len(self.values)} values",
                "at least 4 stations that rise from 0 to 1, and one value for each",
                "sort the stations, divide them by the length, and give each its value",
            )
        if not all(map(math.isfinite, self.values)):
            at = next(i for i, value in enumerate(self.values) if not math.isfinite(value))
            raise DescriptionError(
                "sampled shape function: a value is not a finite number",
                f"{self.values[at]} at xi = {self.xi[at]:g}",
                "values of shape functions are finite numbers",
                "mend or leave out the sample",
            )


UserShape = Value | Samples


def as_shape(stated: Any, what: str) -> UserShape:
    """A function of the user: samples, or a formula of xi."""
    return stated if isinstance(stated, Samples) else as_value(stated, what)
