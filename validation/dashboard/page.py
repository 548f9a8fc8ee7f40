"""Entries -> index.html (one self-contained page), summary.md, and the same summary in the README."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from markupsafe import Markup

from symofros.atomic import write_atomically
from validation.dashboard.gather import Entry
from validation.evidence.charts import svg
from validation.evidence.findings import Chart
from validation.reporting.page import render

BEGIN, END = "<!-- reports/summary.md begins -->", "<!-- reports/summary.md ends -->"


class QuoteError(ValueError):
    """A file has no place for the summary."""


def write_dashboard(entries: Sequence[Entry], folder: Path, date: str) -> Path:
    """Write index.html and summary.md.

    Returns:
        The page.

    Raises:
        OSError: The folder can't be written to.
    """
    groups: dict[str, list[Entry]] = {}
    for entry in entries:
        groups.setdefault(entry.topic.group, []).append(entry)
    values = {
        "groups": groups,
        "headline": headline(entries),
        "ok": all(entry.verdict != "bad" for entry in entries),
        "date": date,
        "origins": origins(entries),
    }
    for template, name in (("index.html.j2", "index.html"), ("summary.md.j2", "summary.md")):
        write_atomically(folder / name, render(template, {"svg": _svg, "cell": _cell}, **values))
    return folder / "index.html"


def headline(entries: Sequence[Entry]) -> str:
    """How the reports stand."""
    found = Counter(entry.verdict for entry in entries)
    said = [f"{found['good']} of {len(entries) - found['absent'] - found['measured']} reports with a verdict are good"]
    bad = [entry.name for entry in entries if entry.verdict == "bad"]
    said += [f"{', '.join(bad)}: not"] if bad else []
    said += [f"{found['measured']} measure without one"] if found["measured"] else []
    absent = [entry.name for entry in entries if entry.card is None]
    said += [f"absent: {', '.join(absent)}"] if absent else []
    return "; ".join(said) + "."


def origins(entries: Sequence[Entry]) -> list[str]:
    """The machines that numbers come from, and the versions."""
    machines = list(dict.fromkeys(entry.origin.machine for entry in entries if entry.origin.machine))
    versions: dict[str, str] = {}
    for entry in entries:
        versions |= entry.origin.versions
    return [*machines, ", ".join(f"{name} {version}" for name, version in sorted(versions.items()))]


def quote(readme: Path, summary: str) -> bool:
    """Put the summary between the marks of a README.

    Returns:
        Whether there is such a file.

    Raises:
        QuoteError: It has no marks, or they are out of order.
    """
    if not readme.is_file():
        return False
    text = readme.read_text(encoding="utf-8")
    before, begin, rest = text.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise QuoteError(f"{readme.name}: no '{BEGIN}' with '{END}' after it, between which the summary would go")
    write_atomically(readme, f"{before}{BEGIN}\n{summary}{END}{after}")
    return True


def quoted(readme: Path) -> str:
    """What stands between the marks."""
    return readme.read_text(encoding="utf-8").partition(f"{BEGIN}\n")[2].partition(END)[0]


def _svg(chart: Chart) -> Markup:
    return Markup(svg(chart))


def _cell(text: str) -> str:
    """A text that can't end the cell it stands in."""
    return " ".join(text.replace("|", "\\|").split())
