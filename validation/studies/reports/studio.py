"""The studio as a user meets it: clicks of sessions against their bars, times, frames, sizes, findings of axe."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

from ...reporting.charts import GOOD, SERIES
from ...reporting.charts import SHORT as SHORT_COLOR
from ...reporting.figures import Drawing, Figure
from ...reporting.numbers import counted
from ...reporting.record import Bullets, Data, Fact, Report, Section, Table, Topic, verdict
from ..studio import measure

_LIMITS = """Each session is a test: a beginner's hand at the mouse, with keys for names and numbers only, whose presses
the browser counts; one that does not get where it should fails. Times hold for this machine, Chromium without a
graphics card and what else ran (load {load:.1f}): pictures are drawn by the processor. Of edits and frames the median
and the 95 % quantile are stated; an edit lasts from the press of OK to the frame that shows the next revision."""
_BIG = "chain60"
_MB = 1e6


def compose(data: Data) -> Report:
    """The report of its JSON."""
    sessions, sizes, axe = data["sessions"], data["sizes"], data["axe"]
    facts = tuple(_facts(data))
    ok = not data["failed"] and not axe["findings"] and all(map(_is_within, sessions)) and all(map(_fits, sizes))
    head = "session | clicks | at most | keys | at most"
    rows = (
        (
            row["name"],
            verdict(row["clicks"], row["clicks"] <= row["most_clicks"]),
            str(row["most_clicks"]),
            verdict(row["keys"], row["keys"] <= row["most_keys"]),
            str(row["most_keys"]),
        )
        for row in sessions
    )
    caption = "Clicks of a beginner, and the bar of each session: shorter is better, left of the mark is within it."
    drawing = Drawing(
        "Clicks of sessions", "clicks", "", partial(_bars, sessions), size=(430.0, 40.0 + 40.0 * len(sessions))
    )
    failed = (Bullets(tuple(f"`{name}` fails" for name in data["failed"])),)
    return Report(
        "The studio as a user meets it",
        f"{sum(map(_is_within, sessions))} of {counted(len(sessions), 'session')} within their bars; "
        f"{counted(len(axe['findings']), 'finding')} of axe in {counted(axe['looks'], 'look')}.",
        ok,
        (_LIMITS.format(**data),),
        (
            Section("Tests that fail", failed if data["failed"] else (), ok=not data["failed"]),
            Section("Sessions", (Figure(caption, (drawing,) if sessions else ()), Table.of(head, rows)), "sessions"),
            Section("Times", (_times(data),), "times"),
            Section("Sizes", (_sizes(sizes),), "sizes"),
            Section("Findings of axe", (Bullets(tuple(axe["findings"])),), "axe", ok=not axe["findings"]),
        ),
        facts=facts,
        aims=not data["failed"],
    )


def _is_within(row: dict[str, Any]) -> bool:
    return bool(row["clicks"] <= row["most_clicks"] and row["keys"] <= row["most_keys"])


def _weight(row: dict[str, Any]) -> int:
    """Bytes that count: of a file as it stands, of a page as it is sent."""
    return int(row["bytes"] if row["is_file"] else row["sent"])


def _fits(row: dict[str, Any]) -> bool:
    return bool(_weight(row) <= row["most"])


def _facts(data: Data) -> Iterator[Fact]:
    sessions = data["sessions"]
    yield Fact(
        f"{sum(map(_is_within, sessions))} of {len(sessions)}",
        "sessions within their bars",
        all(map(_is_within, sessions)),
    )
    for row in data["first"][:1]:
        yield Fact(f"{row['diagram_s']:.1f} s", "from the address to the diagram")
        yield Fact(f"{row['picture_s']:.1f} s", "from 3-D to the first picture, drawn by the processor")
    for row in data["edits"]:
        if row["model"] == _BIG:
            yield Fact(f"{row['median_ms']:.0f} ms", f"an edit of 60 bodies, 95 % within {row['most_ms']:.0f} ms")
    for row in data["frames"]:
        if row["of"].startswith(_BIG) and "drag" in row["of"]:
            rate = 1000.0 / row["median_ms"]
            yield Fact(f"{rate:.0f} a second", "frames while a block of 60 is dragged")
    for row in data["sizes"]:
        yield Fact(f"{_weight(row) / _MB:.2f} MB", f"{row['what']}; at most {row['most'] / _MB:g} MB", _fits(row))
    axe = data["axe"]
    yield Fact(str(len(axe["findings"])), f"findings of axe in {counted(axe['looks'], 'look')}", not axe["findings"])


def _times(data: Data) -> Table:
    """Medians and 95 % of edits and frames."""
    rows = [(f"edit, {row['model']}", f"{row['median_ms']:.0f}", f"{row['most_ms']:.0f}") for row in data["edits"]]
    rows += [(f"frame, {row['of']}", f"{row['median_ms']:.1f}", f"{row['most_ms']:.1f}") for row in data["frames"]]
    return Table(("what", "median [ms]", "95 % within [ms]"), tuple(rows))


def _sizes(sizes: list[dict[str, Any]]) -> Table:
    rows = (
        (
            row["what"],
            f"{row['bytes'] / _MB:.2f}",
            f"{row['sent'] / _MB:.2f}",
            verdict(f"{row['most'] / _MB:g}", _fits(row)),
        )
        for row in sizes
    )
    return Table(("file", "as it stands [MB]", "as it is sent, gzip [MB]", "at most [MB]"), tuple(rows))


def _bars(sessions: list[dict[str, Any]], axes: Any) -> None:
    """A bar a session, and a mark where its bar is."""
    names = [row["name"] for row in sessions]
    colors = [SERIES[0] if _is_within(row) else SHORT_COLOR for row in sessions]
    axes.barh(names, [row["clicks"] for row in sessions], 0.55, color=colors)
    axes.plot([row["most_clicks"] for row in sessions], names, "|", color=GOOD, markersize=20, label="at most")
    axes.invert_yaxis()
    axes.grid(False, axis="y")


TOPIC = Topic(
    "studio",
    "Use",
    "How many clicks, how much waiting does the editor take?",
    compose,
    measure,
    beside=("tests/studio/editor/browser", "symofros/studio"),
)
