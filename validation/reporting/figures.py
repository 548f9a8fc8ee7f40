"""Figures as data: curves over a pair of axes, drawn by `charts`, and drawings of other kinds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from validation.mechanics.geometry import Array
from validation.reporting.numbers import rounded

Values = Array | Sequence[float]
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

    def data(self) -> dict[str, Any]:
        """The chart for JSON."""
        marks: dict[str, dict[str, float]] = {"x": {}, "y": {}}
        for mark in self.marks:
            marks[mark.axis][mark.label] = mark.at
        curves = [
            {"label": c.label, "kind": c.kind, "color": c.color, "x": rounded(c.x), "y": rounded(c.y)}
            for c in self.curves
        ]
        return {
            "title": self.title,
            "x": self.x,
            "y": self.y,
            "log": ["x" in self.log, "y" in self.log],
            "curves": curves,
            "marks": marks["y"],
            "marks_x": marks["x"],
            "range_y": self.range_y,
            "tags": [[tag.label, tag.x, tag.y] for tag in self.tags],
            "equal": self.equal,
        }

    @classmethod
    def of(cls, data: Mapping[str, Any]) -> Chart:
        """The chart that `data` wrote; of reports made before axes of limits were kept, it has no limits."""
        curves = tuple(
            Curve(c["label"], np.array(c["x"], float), np.array(c["y"], float), c.get("color", k % COLORS), c["kind"])
            for k, c in enumerate(data["curves"])
        )
        along = {"y": data["marks"], "x": data["marks_x"]} if "marks_x" in data else {}
        marks = [Mark(label, at, "x" if axis == "x" else "y") for axis, of in along.items() for label, at in of.items()]
        span = data.get("range_y")
        logarithmic: Any = "".join(name for name, log in zip("xy", data["log"], strict=True) if log)
        return cls(
            data["title"],
            data["x"],
            data["y"],
            curves,
            tuple(marks),
            log=logarithmic,
            range_y=None if span is None else (span[0], span[1]),
            tags=tuple(Tag(*tag) for tag in data.get("tags", ())),
            equal=data.get("equal", False),
        )


@dataclass(frozen=True)
class Drawing:
    """A picture that is drawn already.

    Attributes:
        title: What it shows.
        legend: Pairs of a sample, as SVG of 24 by 12 units, and its name.
        svg: The picture as an SVG element.
        note: Further line of the legend.
    """

    title: str
    legend: tuple[tuple[str, str], ...]
    svg: str
    note: str = ""


@dataclass(frozen=True)
class Figure:
    """Pictures side by side, and the sentence that says what to see in them."""

    caption: str
    charts: tuple[Chart | Drawing, ...]

    def data(self) -> dict[str, Any]:
        """The figure for JSON: its caption, and the curves of each chart."""
        charts = [chart.data() for chart in self.charts if isinstance(chart, Chart)]
        return {"caption": self.caption, "charts": charts}

    @classmethod
    def of(cls, data: Mapping[str, Any]) -> Figure:
        """The figure that `data` wrote."""
        return cls(data["caption"], tuple(map(Chart.of, data["charts"])))
