"""The one style of figures: charts and drawings -> SVG by Matplotlib, in the page's colours, light and dark."""

from __future__ import annotations

import io
import re
import textwrap
from collections import Counter
from html import escape
from importlib import import_module
from typing import Any
from zlib import crc32

import numpy as np

from .figures import SHAPES, Chart, Curve, Drawing
from .numbers import short

# Names in the style sheet -> colours on light and on dark paper.
INK, SOFT, LINE, PAPER, GOOD, BAD, SHORT = "#1c2024", "#5c6670", "#dfe3e6", "#fcfcfb", "#1a7f4b", "#c0362c", "#8a6000"
SERIES = tuple(
    "#2563b8 #d9730d #5aa0e6 #e39a45 #7a8691 #2f9e6e #8a5cc7 #b0508a #12908e #8c5a2b #5b6fae #c2342d "
    "#6b7d2a #3d4a57".split()
)
_DARK_SERIES = (
    "#6ea8ff #ff9d45 #9cc9ff #ffc98f #98a4ae #5fd0a0 #b794f0 #e08abf #4fd0ce #d0a070 #a3b4ea #ff8a80 #b9cc6a #c9d4de"
).split()
PALETTE = {
    "ink": (INK, "#e6e9eb"),
    "soft": (SOFT, "#9aa5ae"),
    "line": (LINE, "#343a40"),
    "paper": (PAPER, "#15181b"),
    "good": (GOOD, "#4cc38a"),
    "bad": (BAD, "#ff7a6e"),
    "short": (SHORT, "#e0b040"),
    **{f"e{k}": pair for k, pair in enumerate(zip(SERIES, _DARK_SERIES, strict=True))},
}
MARKS = "osD^vPX*"
_GROWN = {"P": 1.3, "X": 1.3, "*": 1.8}
_DASHES = {"dashed": (4, 2.5), "dotted": (1.2, 2)}
_LIMITS = ((6, 2), (2, 2), (8, 2, 2, 2))
_RC = {
    "svg.fonttype": "none",
    "font.size": 11,
    "font.family": "DejaVu Sans",
    "text.color": INK,
    "axes.labelcolor": INK,
    "axes.edgecolor": SOFT,
    "axes.titlesize": 11,
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "axes.grid": True,
    "grid.color": LINE,
    "xtick.color": SOFT,
    "ytick.color": SOFT,
    "xtick.major.size": 0,
    "ytick.major.size": 0,
    "lines.linewidth": 1.6,
    "legend.frameon": False,
    "legend.handlelength": 2.2,
}
# Pixels of the page for a unit of a picture: two pictures stand beside each other, and letters are of one size in all.
_SCALE = 1.05
# Points of Matplotlib are units of the picture; widths of letters are of this font.
_LETTER = 5.8


def library(name: str) -> Any:
    """A module of Matplotlib, loaded when the first figure is drawn.

    Raises:
        ModuleNotFoundError: It is not installed; says what brings it.
    """
    try:
        return import_module(name)
    except ModuleNotFoundError:
        needed = "figures are drawn by Matplotlib, which is not installed: pip install 'symofros[validation]'"
        raise ModuleNotFoundError(needed) from None


def draw(item: Chart | Drawing) -> str:
    """The picture with its legend as an SVG element, titled and described."""
    width, height = item.size
    with library("matplotlib").rc_context(_RC | {"svg.hashsalt": item.title}):
        figure = library("matplotlib.figure").Figure(figsize=(width / 72, height / 72))
        axes = figure.add_axes((0, 0, 1, 1))
        axes.set_title(item.y)
        axes.set_xlabel(item.x)
        if isinstance(item, Drawing):
            item.paint(axes)
        else:
            _curves(item, axes)
        names = _legend(axes, width, height, item.note if isinstance(item, Drawing) else "")
        text = io.StringIO()
        figure.savefig(
            text, format="svg", bbox_inches="tight", pad_inches=0.05, metadata={"Date": None}, transparent=True
        )
    return _inlined(text.getvalue(), item.title, f"{item.y} against {item.x}. {'; '.join(names)}.")


def logarithmic(axis: Any) -> None:
    """Decades of an axis, as powers of ten where they are far from one."""
    low, high = sorted(axis.get_view_interval())
    ticker = library("matplotlib.ticker")
    axis.set_major_locator(ticker.LogLocator(subs=(1.0,) if high > 60 * low else (1.0, 2.0, 5.0), numticks=8))
    axis.set_minor_locator(ticker.NullLocator())
    axis.set_major_formatter(ticker.FuncFormatter(lambda value, _: power(value)))


def power(value: float) -> str:
    """A value of a logarithmic axis."""
    if 1e-2 <= value < 1e4:
        return f"{value:g}"
    mantissa, _, exponent = f"{value:.0e}".partition("e")
    raised = str(int(exponent)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return f"10{raised}" if mantissa == "1" else f"{mantissa}·10{raised}"


def style(curve: Curve, size: float = 5.0) -> dict[str, Any]:
    """Colour, line and mark of a curve; marks that cover little are drawn larger than `size`."""
    dashes, mark = _DASHES.get(curve.kind, ()), MARKS[(curve.color + curve.shape) % SHAPES]
    return {
        "label": curve.label,
        "color": SERIES[curve.color % len(SERIES)],
        "linestyle": "none" if curve.kind == "points" else (0, dashes) if dashes else "-",
        "drawstyle": "steps-post" if curve.kind == "steps" else "default",
        "marker": mark if curve.kind in ("points", "joined", "steps") else "",
        "markersize": _GROWN.get(mark, 1.0) * size,
        "markeredgecolor": PAPER,
        "markeredgewidth": 0.5,
    }


def _curves(chart: Chart, axes: Any) -> None:
    for curve in chart.curves:
        axes.plot(curve.x, np.where(np.isfinite(curve.y), curve.y, np.nan), **style(curve))
    for k, mark in enumerate(chart.marks):
        line = axes.axhline if mark.axis == "y" else axes.axvline
        said = f"{mark.label}: {short(float(format(mark.at, '.3g')))}"
        line(mark.at, color=BAD, linewidth=1.3, linestyle=(0, _LIMITS[k % 3]), label=said, zorder=1.5)
    for name in chart.log:
        getattr(axes, f"set_{name}scale")("log", nonpositive="mask")
        logarithmic(getattr(axes, f"{name}axis"))
    if chart.range_x is not None:
        axes.set_xlim(chart.range_x)
    if chart.range_y is not None:
        axes.set_ylim(chart.range_y)
    if chart.equal:
        axes.set_aspect("equal", adjustable="datalim")


def _legend(axes: Any, width: float, height: float, note: str) -> list[str]:
    """Below the axes, in as many columns as fit: nothing of it lies on a point or is cut."""
    handles, names = axes.get_legend_handles_labels()
    lines = [textwrap.fill(name, int(width / _LETTER)) for name in names]
    longest = max((len(line) for name in lines for line in name.split("\n")), default=0)
    columns = max(1, min(4, int(width / (longest * _LETTER + 38))))
    if names:
        place = {"loc": "upper left", "bbox_to_anchor": (-0.02, -38 / height)}
        axes.legend(
            handles, lines, ncols=columns, fontsize=10, title=note, alignment="left", title_fontsize=10, **place
        )
    return [*names, note] if note else list(names)


def _inlined(text: str, title: str, description: str) -> str:
    """SVG text as an inline element, without what the page supplies: head, fonts, colours, names of groups."""
    box = text.partition('viewBox="')[2].partition('"')[0]
    body = text.partition("</metadata>")[2]
    body = body.replace("xlink:href", "href").replace("font-family: 'DejaVu Sans'; ", "")
    unused = r'<style.*?</style>|<!--.*?-->| id="[a-z0-9_.]*_\d+"| transform="rotate\(-0 [^)]*\)"|\n\s*'
    body = re.sub(unused, "", body, flags=re.S)
    body = re.sub(r"<[^>]*>", lambda tag: re.sub(r"(\.\d)\d+", r"\1", tag[0]), body)
    for name, (light, _) in PALETTE.items():
        body = body.replace(light, f"var(--{name})")
    # What is drawn often is styled once: a map has hundreds of numbers.
    often = {f"m{crc32(one.encode()):x}": one for one, n in Counter(re.findall('style="(.*?)"', body)).items() if n > 3}
    for name, one in often.items():
        body = body.replace(f'style="{one}"', f'class="{name}"')
    rules = " ".join(f".{name} {{ {one} }}" for name, one in often.items())
    body = re.sub(r"<g>(<text[^>]*>[^<]*</text>)</g>|<g/>", r"\1", f"<style>{rules}</style>{body}")
    width = float(box.split()[2])
    head = f'<svg role="img" viewBox="{box}" style="width: {_SCALE * width:.0f}px">'
    return f"{head}<title>{escape(title)}</title><desc>{escape(description)}</desc>{body}"
