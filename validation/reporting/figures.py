"""Figures as data: curves over a pair of axes, and pictures of other kinds; `charts` draws them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import PlainValidator

from ..mechanics.geometry import Array
from .plain import as_array

Values = Annotated[Array | Sequence[float], PlainValidator(as_array)]
Kind = Literal["line", "dashed", "dotted", "points", "joined", "steps"]
# Marks of points: so many series have a colour and a mark of their own.
SHAPES = 8
SIZE = (430.0, 270.0)


@dataclass(frozen=True)
class Curve:
    """Points (x, y) under a label of the legend; what is not finite, or no logarithm, leaves a gap.

    Attributes:
        color: Index of a colour of series.
        kind: Style; "joined" is points on a line, "steps" points whose value holds until the next one.
        shape: Index of the mark of points, counted from that of the colour.
    """

    label: str
    x: Values
    y: Values
    color: int = 0
    kind: Kind = "line"
    shape: int = 0


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
    """A straight line across the chart at a value of an axis, named in the legend."""

    label: str
    at: float
    axis: Literal["x", "y"] = "y"


@dataclass(frozen=True)
class Chart:
    """Curves over one pair of axes, `x` and `y` by name and unit.

    Attributes:
        marks: Limits and thresholds.
        log: Names of the logarithmic axes.
        range_y: Part of the ordinate that is shown; None for all.
        equal: Whether a unit is as long on both axes, as on a map.
        range_x: Part of the abscissa that is shown; None for all.
        size: Width and height of the axes [px].
    """

    title: str
    x: str
    y: str
    curves: tuple[Curve, ...]
    marks: tuple[Mark, ...] = ()
    log: Literal["", "x", "y", "xy"] = ""
    range_y: tuple[float, float] | None = None
    equal: bool = False
    range_x: tuple[float, float] | None = None
    size: tuple[float, float] = SIZE


@dataclass(frozen=True)
class Drawing:
    """A picture that is no set of curves, over axes `x` and `y` by name and unit.

    Attributes:
        paint: Draws it into Matplotlib's axes; labelled artists make the legend.
        note: Line above the legend.
        size: Width and height of the axes [px].
    """

    title: str
    x: str
    y: str
    paint: Callable[[Any], None]
    note: str = ""
    size: tuple[float, float] = SIZE


@dataclass(frozen=True)
class Figure:
    """Pictures side by side, and the sentence that says what to see in them."""

    caption: str
    charts: tuple[Chart | Drawing, ...]
