"""Entries -> index.html (one self-contained page), summary.md, and the same summary in the README."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from pathlib import Path

from symofros.tools import write_atomically
from validation.dashboard.gather import Entry
from validation.reporting import html, markdown
from validation.reporting.figures import Figure
from validation.reporting.record import Block, Bullets, Cell, Report, Section, Table, Text

BEGIN, END = "<!-- reports/summary.md begins -->", "<!-- reports/summary.md ends -->"


class QuoteError(ValueError):
    """A file has no place for the summary."""


def write_index(entries: Mapping[str, Entry], folder: Path, date: str) -> Path:
    """Write index.html and summary.md.

    Returns:
        The page.

    Raises:
        OSError: The folder can't be written to.
    """
    report = index(entries)
    closing = f"Gathered {date} by `python -m validation dashboard`; `--regenerate` writes the reports anew before."
    write_atomically(folder / "index.html", html.page(report, closing=closing, listed=False))
    said = [f"**{report.summary}** (gathered {date})", markdown.table(summary_table(entries)), origins(entries)]
    write_atomically(folder / "summary.md", "\n\n".join(said) + "\n")
    return folder / "index.html"


def index(entries: Mapping[str, Entry]) -> Report:
    """The report over all reports: a line each, then what each says in short."""
    ok = all(entry.verdict != "missed" for entry in entries.values())
    table = summary_table(entries, linked=True)
    sections = tuple(_section(name, entry) for name, entry in entries.items())
    return Report("What the harness found", headline(entries), ok, (table,), sections)


def headline(entries: Mapping[str, Entry]) -> str:
    """How the reports stand."""
    stands = Counter(entry.verdict for entry in entries.values())
    said = [f"{stands['good']} of {stands['good'] + stands['missed']} reports with a verdict are good"]
    missed = [name for name, entry in entries.items() if entry.verdict == "missed"]
    said += [f"missed: {', '.join(missed)}"] if missed else []
    said += [f"{stands['measured']} measure without one"] if stands["measured"] else []
    absent = [name for name, entry in entries.items() if entry.verdict == "absent"]
    said += [f"absent: {', '.join(absent)}"] if absent else []
    return "; ".join(said) + "."


def summary_table(entries: Mapping[str, Entry], linked: bool = False) -> Table:
    """A line a report."""
    rows = tuple(
        (
            f"[{name}](#{name})" if linked else name,
            entry.said,
            Cell(entry.verdict, False if linked and entry.verdict == "missed" else None),
            entry.provenance.date.removesuffix(" UTC") or "-",
        )
        for name, entry in entries.items()
    )
    return Table(("report", "what it found", "verdict", "made (UTC)"), rows)


def origins(entries: Mapping[str, Entry]) -> str:
    """The machines that numbers come from, and the versions."""
    machines = dict.fromkeys(entry.provenance.machine for entry in entries.values() if entry.provenance.machine)
    versions: dict[str, str] = {}
    for entry in entries.values():
        versions |= entry.provenance.versions
    return ";\n".join([*machines, ", ".join(f"{name} {version}" for name, version in sorted(versions.items()))]) + "."


def _section(name: str, entry: Entry) -> Section:
    blocks: list[Block] = []
    if entry.report is not None:
        blocks.append(f"**{entry.report.summary}**")
        blocks += [Bullets(tuple(f"**{fact.value}** {fact.label}" for fact in entry.report.facts))]
        blocks += [Figure("", entry.report.highlights)] if entry.report.highlights else []
    doubtful = ("stale", "can't", "layout")
    blocks += [
        Text(f"This report {remark}.", "bad" if any(word in remark for word in doubtful) else "soft")
        for remark in entry.remarks
    ]
    whole = f"[The whole report]({entry.page}). " if entry.page else ""
    origin = "; ".join(f"{what} {value}" for what, value in entry.provenance.rows)
    blocks.append(Text(f"{whole}Written by `{entry.topic.command}`{': ' if origin else ''}{origin}.", "soft"))
    ok = {"good": True, "missed": False}.get(entry.verdict)
    return Section(f"{entry.topic.group}: {entry.topic.question}", tuple(blocks), name, ok, badge=entry.verdict)


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
