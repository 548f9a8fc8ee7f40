"""Figures as data: curves over a pair of axes, drawn by `charts`, and drawings of other kinds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import PlainValidator

from validation.mechanics.geometry import Array
from validation.reporting.plain import as_array

Values = Annotated[Array | Sequence[float], PlainValidator(as_array)]
Kind = Literal["line", "dashed", "dotted", "points", "joined"]
Logarithmic = Literal["", "x", "y", "xy"]
# Colours of the page, and shapes of points: a pair of the two tells more series apart than colours alone.
COLORS, SHAPES = 12, 4


@dataclass(frozen=True)
class Curve:
    """One set of points.

    Attributes:
        label: Name in the legend.
        x: Abscissae (n).
        y: Ordinates (n); what is not finite, or not positive on a logarithmic axis, leaves a gap.
        color: Index of a colour of the page.
        kind: Style; "joined" is points on a line.
        shape: Index of the shape of points: disc, square, diamond, triangle.
        hints: Text shown when the pointer rests on a point (n), or nothing.
    """

    label: str
    x: Values
    y: Values
    color: int = 0
    kind: Kind = "line"
    shape: int = 0
    hints: tuple[str, ...] = ()


def curves(
    x: Any, named: Mapping[str, Any], kind: Kind = "joined", colors: Mapping[str, int] | None = None
) -> tuple[Curve, ...]:
    """Curves over common abscissae, by label; colours are those of the labels, or follow their order."""
    return tuple(
        Curve(label, x, np.asarray(y, float), k if colors is None else colors[label], kind)
        for k, (label, y) in enumerate(named.items())
    )


@dataclass(frozen=True)
class Mark:
    """A straight line across the chart, named in the legend.

    Attributes:
        label: Name in the legend.
        at: Value of the axis.
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
        title: Title of the figure.
        x: Name and unit of the abscissa; y: of the ordinate.
        curves: Curves in the order of the legend.
        marks: Limits and thresholds.
        log: Names of the logarithmic axes.
        range_y: Part of the ordinate that is shown; None for all.
        tags: Names of points, in the figure's words.
        equal: Whether a unit is as long on both axes, as on a map.
    """

    title: str
    x: str
    y: str
    curves: tuple[Curve, ...]
    marks: tuple[Mark, ...] = ()
    log: Logarithmic = ""
    range_y: tuple[float, float] | None = None
    tags: tuple[Tag, ...] = ()
    equal: bool = False


@dataclass(frozen=True)
class Drawing:
    """A picture that is drawn already.

    Attributes:
        title: What it shows.
        legend: Pairs of a sample, as SVG of 24 by 12 units, and its name.
        svg: The picture as an SVG element.
        x: Name and unit of the abscissa, written below; y: of the ordinate, written above.
        note: Further line of the legend.
    """

    title: str
    legend: tuple[tuple[str, str], ...]
    svg: str
    x: str
    y: str = ""
    note: str = ""


@dataclass(frozen=True)
class Figure:
    """Pictures side by side, and the sentence that says what to see in them."""

    caption: str
    charts: tuple[Chart | Drawing, ...]
