"""Axes and marks as SVG text: they need no library, and take their colours from the page."""

from __future__ import annotations

import math
from collections.abc import Iterable
from html import escape
from typing import NamedTuple


class Axis(NamedTuple):
    """Values low ... high onto start ... end [px]; logarithms of values if `log`."""

    low: float
    high: float
    start: float
    end: float
    log: bool

    def at(self, value: float) -> float:
        """Where a value lies [px]."""
        value = math.log10(value) if self.log else value
        return self.start + (value - self.low) / (self.high - self.low) * (self.end - self.start)

    def ticks(self) -> list[float]:
        """Values with a line of the grid."""
        if self.log:
            step = max(1, math.ceil((self.high - self.low) / 7))
            decades = range(math.ceil(self.low - 1e-9), math.floor(self.high + 1e-9) + 1)
            powers = [10.0**d for d in decades if d % step == 0]
            return powers if len(powers) > 1 else _within_a_decade(10**self.low, 10**self.high)
        rough = (self.high - self.low) / 6
        power = 10.0 ** math.floor(math.log10(rough))
        unit = next(m * power for m in (1, 2, 5, 10) if m * power >= rough)
        return [k * unit for k in range(math.ceil(self.low / unit - 1e-9), math.floor(self.high / unit + 1e-9) + 1)]


def _within_a_decade(low: float, high: float) -> list[float]:
    """For a logarithmic axis of less than two decades."""
    scale = 10.0 ** math.floor(math.log10(low))
    return [m * scale * p for p in (1, 10) for m in (1, 2, 5) if low * 0.999 <= m * scale * p <= high * 1.001]


def shown(value: float, log: bool) -> str:
    """A value of an axis: a power of ten where the axis is logarithmic and the value far from one."""
    if log and not 1e-2 <= value < 1e4:
        decade = f"{math.floor(math.log10(value) + 1e-9)}".replace("-", "−")
        return f'10<tspan dy="-5" font-size="75%">{decade}</tspan>'
    return f"{0.0 if abs(value) < 1e-12 else value:.6g}".replace("-", "−")


def grid(x: Axis, y: Axis) -> list[str]:
    """Lines of the grid, their values, and the two axes."""
    parts = []
    for value in x.ticks():
        parts.append(line("grid", x.at(value), x.at(value), y.start, y.end))
        parts.append(text(x.at(value), y.start + 18, shown(value, x.log), "middle", "tick"))
    for value in y.ticks():
        parts.append(line("grid", x.start, x.end, y.at(value), y.at(value)))
        parts.append(text(x.start - 7, y.at(value) + 4, shown(value, y.log), "end", "tick"))
    return [*parts, line("axis", x.start, x.end, y.start, y.start), line("axis", x.start, x.start, y.start, y.end)]


def line(kind: str, x1: float, x2: float, y1: float, y2: float) -> str:
    """A straight line of a kind that the style sheet knows."""
    return f'<line class="{kind}" x1="{x1:.1f}" x2="{x2:.1f}" y1="{y1:.1f}" y2="{y2:.1f}"/>'


def text(x: float, y: float, text: str, anchor: str, kind: str) -> str:
    """A text that is escaped already; the only markup in it is our own (`shown`)."""
    return f'<text class="{kind}" x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{text}</text>'


def point(kind: str, x: float, y: float, shape: int, size: float, title: str = "") -> str:
    """A point: disc, square, diamond or triangle, of like areas; `title` is said when the pointer rests on it."""
    said = f"<title>{escape(title)}</title>" if title else ""
    if shape == 0:
        return f'<circle class="point {kind}" cx="{x:.1f}" cy="{y:.1f}" r="{size:g}">{said}</circle>'
    s = {1: 0.9, 2: 1.25, 3: 1.3}[shape] * size
    path = {1: f"m{-s} {-s}h{2 * s}v{2 * s}h{-2 * s}z", 2: f"m0 {-s}l{s} {s}l{-s} {s}l{-s} {-s}z"}.get(
        shape, f"m0 {-s}l{s} {1.7 * s}h{-2 * s}z"
    )
    return f'<path class="point {kind}" d="M{x:.1f} {y:.1f}{path}">{said}</path>'


def svg(width: float, height: float, title: str, parts: Iterable[str], kind: str = "") -> str:
    """The picture as an element."""
    box = f'class="{kind}" viewBox="0 0 {width:.0f} {height:.0f}" role="img" aria-label="{escape(title)}"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {box}>{"".join(parts)}</svg>'
