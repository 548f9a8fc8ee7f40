"""What a study finds: charts with captions, and numbers with the bounds they must keep."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np

from validation.mechanics.geometry import Array

Kind = Literal["line", "dashed", "dotted", "points", "joined"]


@dataclass(frozen=True)
class Curve:
    """One set of points.

    Attributes:
        label: In the legend.
        x: Abscissae (n).
        y: Ordinates (n); what is not finite, or not positive on a logarithmic axis, leaves a gap.
        color: Number of a colour of the page.
        kind: How it is drawn; "joined" is points on a line.
    """

    label: str
    x: Array
    y: Array
    color: int = 0
    kind: Kind = "line"


@dataclass(frozen=True)
class Mark:
    """A straight line across the chart, named on it.

    Attributes:
        label: Its name.
        at: Where.
        axis: The axis that `at` is a value of.
    """

    label: str
    at: float
    axis: Literal["x", "y"] = "y"


@dataclass(frozen=True)
class Tag:
    """A short name beside a point."""

    label: str
    x: float
    y: float


@dataclass(frozen=True)
class Chart:
    """Curves over one pair of axes.

    Attributes:
        title: What it shows.
        x: Name and unit of the abscissa; y: of the ordinate.
        curves: In the order of the legend.
        marks: Limits and thresholds.
        log_x, log_y: Whether an axis is logarithmic.
        range_y: Part of the ordinate that is shown; None for all.
        tags: Names of points, in the figure's words.
        equal: Whether a unit is as long on both axes, as on a map.
    """

    title: str
    x: str
    y: str
    curves: tuple[Curve, ...]
    marks: tuple[Mark, ...] = ()
    log_x: bool = False
    log_y: bool = False
    range_y: tuple[float, float] | None = None
    tags: tuple[Tag, ...] = ()
    equal: bool = False


@dataclass(frozen=True)
class Figure:
    """Charts side by side, and the sentence that says what to see in them."""

    caption: str
    charts: tuple[Chart, ...]


@dataclass(frozen=True)
class Check:
    """A number and the bounds it must keep.

    Attributes:
        what: The number, in words.
        found: Its value.
        high: It may not be larger.
        low: Nor smaller.
        reason: Where the bounds come from.
    """

    what: str
    found: float
    high: float
    low: float = -math.inf
    reason: str = ""

    @property
    def ok(self) -> bool:
        """Whether it is within its bounds; NaN is not."""
        return bool(self.low <= self.found <= self.high)


@dataclass(frozen=True)
class Study:
    """The answer to one question.

    Attributes:
        title: The question.
        answer: In words, with the numbers found.
        figures: What shows it.
        checks: What must hold.
        sources: Of the reference numbers.
    """

    title: str
    answer: str
    figures: tuple[Figure, ...]
    checks: tuple[Check, ...]
    sources: tuple[str, ...] = field(default=())

    @property
    def ok(self) -> bool:
        """Whether every number is within its bounds."""
        return all(check.ok for check in self.checks)


# Whether it may take a short way: fewer points and shorter motions, the same questions.
Asked = Callable[[bool], Study]


def near(what: str, found: float, expected: float, relative: float, reason: str) -> Check:
    """A check that a number is what is expected, to a relative tolerance."""
    room = abs(expected) * relative
    return Check(what, found, expected + room, expected - room, reason)


def exponent(x: Array, y: Array) -> float:
    """The k of y ~ x^-k, by least squares on logarithms."""
    return -float(np.polyfit(np.log(x), np.log(y), 1)[0])
