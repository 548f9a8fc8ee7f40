"""A number with the bounds it must keep, and the answer to one question that such numbers make."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import BeforeValidator

from ..mechanics.geometry import Array
from .figures import Figure
from .numbers import short
from .plain import Number

# A bound: JSON writes null where a side is open.
_High = Annotated[float, BeforeValidator(lambda x: math.inf if x is None else x)]
_Low = Annotated[float, BeforeValidator(lambda x: -math.inf if x is None else x)]


@dataclass(frozen=True)
class Finding:
    """A number, named by a quantity with its unit, the bounds it must keep, both allowed, and the reason of these."""

    quantity: str
    value: Number
    high: _High
    low: _Low = -math.inf
    reason: str = ""

    @property
    def ok(self) -> bool:
        """Whether the number is within its bounds; NaN is not."""
        return bool(self.low <= self.value <= self.high)

    @property
    def bounds(self) -> str:
        """The number beside its bounds, in words."""
        bounds = " to ".join(filter(None, (short(self.low), short(self.high))))
        return f"{short(self.value)}, asked for is {bounds}"


@dataclass(frozen=True)
class Study:
    """A question, the answer in words, figures that show it, numbers with bounds, and sources of references."""

    title: str
    answer: str
    figures: tuple[Figure, ...]
    findings: tuple[Finding, ...]
    sources: tuple[str, ...] = ()

    @property
    def ok(self) -> bool:
        """Whether every number is within its bounds."""
        return all(finding.ok for finding in self.findings)


# Answers a question; the argument says whether a short way is taken: fewer points and shorter motions.
Question = Callable[[bool], Study]


def near(quantity: str, value: float, expected: float, relative: float, reason: str) -> Finding:
    """A finding whose bounds are the expected number, less and more a relative tolerance."""
    margin = abs(expected) * relative
    return Finding(quantity, value, expected + margin, expected - margin, reason)


def exponent(x: Array, y: Array) -> float:
    """The k of y ~ x^-k, by least squares on logarithms."""
    return -float(np.polyfit(np.log(x), np.log(y), 1)[0])
