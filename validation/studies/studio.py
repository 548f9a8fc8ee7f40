"""The studio as a user meets it: what the tests in the browser measure on their way, and sizes of what is loaded."""

from __future__ import annotations

import gzip
import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Iterator
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import typer

import symofros as sf

from ..inputs.cases import ROBOTS, robot_file
from ..reporting.charts import GOOD, SERIES
from ..reporting.charts import SHORT as SHORT_COLOR
from ..reporting.command import Run
from ..reporting.figures import Drawing, Figure
from ..reporting.numbers import counted
from ..reporting.record import Bullets, Data, Fact, Report, Section, Table, Topic, verdict

_ROOT = Path(__file__).parents[2]
_FOLDER = "tests/studio/editor/browser"
# Files of tests that measure: sessions with their clicks and keys, times, findings of axe.
TESTS = ("test_sessions.py", "test_fluid.py", "test_accessibility.py", "test_native_code.py")
_SECONDS = 10.0  # Of the replay's motion.


def missing() -> str:
    """What this machine lacks of it; "" for nothing."""
    if not (_ROOT / _FOLDER).is_dir():
        return "a checkout: the sessions are tests of the repository"
    return "" if find_spec("playwright") else "package playwright"


def measure(run: Run) -> Data:
    """Measure the studio in a browser: times to the first picture and of edits, frames, sizes, clicks of sessions."""
    if lacking := missing():
        raise typer.BadParameter(lacking)
    run.expect(2, "sessions in the browser")
    lines, failed = sessions()
    run.advance("sizes of pages and replays")
    found = {**gathered(lines), "failed": failed, "sizes": sizes(), "load": os.getloadavg()[0]}
    run.advance()
    return found


def sessions() -> tuple[list[dict[str, Any]], list[str]]:
    """What the tests measured, and the names of those that failed."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "measures.jsonl"
        files = [f"{_FOLDER}/{name}" for name in TESTS]
        command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--browser", "--slow", *files]
        environment = {**os.environ, "SYMOFROS_STUDIO_MEASURES": str(file), "PYTHONPATH": str(_ROOT)}
        done = subprocess.run(command, cwd=_ROOT, env=environment, capture_output=True, text=True, check=False)
        texts = file.read_text(encoding="utf-8").splitlines() if file.exists() else []
    failed = re.findall(r"^(?:FAILED|ERROR) (\S+)", done.stdout, re.MULTILINE)
    if done.returncode and not failed:
        failed = [f"pytest ends with code {done.returncode}"]
    return [json.loads(text) for text in texts], failed


def gathered(lines: Iterable[dict[str, Any]]) -> dict[str, Any]:
    """Lines of the tests by what they are about; a session that was recorded twice counts by its dearer time."""
    by_kind: dict[str, list[dict[str, Any]]] = {kind: [] for kind in ("session", "frames", "edits", "first", "axe")}
    for line in lines:
        by_kind[line["what"]].append({key: value for key, value in line.items() if key != "what"})
    cost = {row["name"]: row for row in sorted(by_kind["session"], key=lambda row: (row["clicks"], row["keys"]))}
    looks = [row["findings"] for row in by_kind["axe"]]
    return {
        "sessions": list(cost.values()),
        "frames": by_kind["frames"],
        "edits": by_kind["edits"],
        "first": by_kind["first"],
        "axe": {"looks": len(looks), "findings": sorted({finding for found in looks for finding in found})},
    }


def sizes() -> list[dict[str, Any]]:
    """Bytes of what is loaded first, of replays, as stated and as servers send them (gzip)."""
    static = Path(str(sf.__file__)).parent / "studio" / "editor" / "static"
    page = (static / "index.html").read_text(encoding="utf-8")
    needed = [static / "index.html", *(static / name for name in re.findall(r'(?:src|href)="\./([^"]+)"', page))]
    rows = [_size("page of the editor, first load", [file.read_bytes() for file in needed], 1_000_000)]
    system = sf.load(robot_file(ROBOTS["panda"].file))
    model = sf.compile(system)
    t = np.linspace(0.0, _SECONDS, 301)
    swing = 0.5 * np.sin(t[:, None] * (1.0 + 0.1 * np.arange(model.nv)))
    q = np.array([model.integrate(model.neutral(), row) for row in swing])
    with tempfile.TemporaryDirectory() as folder:
        replay = sf.record(system, (t, q), Path(folder) / "panda.html").read_bytes()
    return [*rows, _size(f"replay of a Panda, {_SECONDS:g} s with its meshes", [replay], 1_000_000)]


def _size(what: str, contents: list[bytes], most: int) -> dict[str, Any]:
    """Sizes; `most`: of the page as it is sent, of a replay, which is a file, as it stands."""
    return {
        "what": what,
        "bytes": sum(map(len, contents)),
        "sent": sum(len(gzip.compress(content, mtime=0)) for content in contents),
        "is_file": len(contents) == 1,
        "most": most,
    }


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
