"""Entries -> index.html (one self-contained page), summary.md, and the summary's main lines in the README."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from pathlib import Path

from symofros.tools import write_atomically

from ..program import PROGRAM
from ..reporting import html, markdown
from ..reporting.evidence import revision, standing_text
from ..reporting.figures import Figure
from ..reporting.record import Block, Bullets, Report, Section, Table, Text, verdict
from .gather import Entry

BEGIN, END = "<!-- reports/summary.md begins -->", "<!-- reports/summary.md ends -->"

# Reports whose lines the README quotes.
QUOTED = ("check", "oracle", "mutants", "engines", "accuracy", "stability", "timing")

# Verdict of an entry -> whether what was asked for is met.
_VERDICTS = {"good": True, "missed": False, "measured": None, "absent": None}
# Reports whose decisions the index shows, in this order: first the sentences of some, then all of the others.
_INTRODUCTIONS = {"check": "The opinions on our C, engine by engine:", "engines": "What each engine is to mend first:"}
_SHOWN = ("pareto", "timing")


class QuoteError(ValueError):
    """A file has no place for the summary."""


def write_index(entries: Mapping[str, Entry], folder: Path, date: str) -> Path:
    """Write index.html, which is returned, and summary.md.

    Raises:
        OSError: The folder can't be written to.
    """
    report = index(entries)
    closing = f"Gathered {date} by `{PROGRAM} dashboard`; `{PROGRAM} all` makes reports anew."
    page = html.page(report, closing=closing, listed=False)
    source = f" of revision {revision()[:9]}" if revision() else ""
    said = f"**{report.summary}** (gathered {date}{source})", markdown.table(summary_table(entries)), origins(entries)
    write_atomically(folder / "index.html", page)
    write_atomically(folder / "summary.md", "\n\n".join(said) + "\n")
    return folder / "index.html"


def index(entries: Mapping[str, Entry]) -> Report:
    """The report over all reports: a line each, then what each says in short."""
    reports = {name: entry.report for name, entry in entries.items() if entry.report}
    return Report(
        "What the harness found",
        headline(entries),
        all(entry.verdict != "missed" for entry in entries.values()),
        (summary_table(entries, linked=True),),
        tuple(_section(name, entry) for name, entry in entries.items()),
        decisions=_decisions(reports),
        missed=tuple(f"[{name}](#{name}): {line}" for name, report in reports.items() for line in report.missed),
    )


def _decisions(reports: Mapping[str, Report]) -> tuple[Block, ...]:
    """Sentences that a table would hide; then sentences with their tables; then the tables of the former."""
    said = {name: reports[name].decisions for name in _INTRODUCTIONS if name in reports and reports[name].decisions}
    shown = [block for name in _SHOWN if name in reports for block in reports[name].decisions]
    tables = [block for name, group in said.items() if group[1:] for block in (_INTRODUCTIONS[name], *group[1:])]
    return (*(group[0] for group in said.values()), *shown, *tables)


def headline(entries: Mapping[str, Entry]) -> str:
    """One sentence that counts the reports by verdict and by age of their sources."""
    named = {word: [n for n, e in entries.items() if e.verdict == word] for word in _VERDICTS}
    good, missed, measured, absent = named.values()
    said = [f"{len(good)} of {len(good) + len(missed)} reports with a verdict are good"]
    said += [f"missed: {', '.join(missed)}"] if missed else []
    said += [f"{len(measured)} measure without one"] if measured else []
    said += [f"absent: {', '.join(absent)}"] if absent else []
    aged = Counter(entry.standing for entry in entries.values() if entry.standing)
    said += [f"{number} {standing}" for standing, number in aged.items()]
    return "; ".join(said) + "."


def summary_table(entries: Mapping[str, Entry], linked: bool = False) -> Table:
    """A line a report; `linked`: its name leads to what the page says of it, and a miss is marked."""
    rows = (
        (
            f"[{name}](#{name})" if linked else name,
            entry.said,
            verdict(entry.verdict, not linked or entry.verdict != "missed"),
            "; ".join(filter(None, (entry.provenance.date.removesuffix(" UTC") or "-", entry.standing))),
        )
        for name, entry in entries.items()
    )
    return Table.of("report | what it found | verdict | made (UTC)", rows)


def origins(entries: Mapping[str, Entry]) -> str:
    """The machines that numbers come from, and the versions."""
    stated = [entry.provenance for entry in entries.values()]
    machines = dict.fromkeys(origin.machine for origin in stated if origin.machine)
    versions = {name: version for origin in stated for name, version in origin.versions.items()}
    return ";\n".join([*machines, ", ".join(f"{name} {version}" for name, version in sorted(versions.items()))]) + "."


def _section(name: str, entry: Entry) -> Section:
    blocks: list[Block] = []
    if entry.report is not None:
        facts = tuple(f"**{fact.value}** {fact.label}" for fact in entry.report.facts)
        blocks += [f"**{entry.report.summary}**", Bullets(facts), Figure("", entry.report.first_chart)]
    for remark in entry.remarks:
        doubtful = remark == standing_text(entry.standing) or any(word in remark for word in ("can't", "layout"))
        blocks.append(Text(f"This report {remark}.", "bad" if doubtful else "soft"))
    whole = f"[The whole report]({entry.page}). " if entry.page else ""
    origin = "; ".join(f"{what} {value}" for what, value in entry.provenance.rows)
    blocks.append(Text(f"{whole}Written by `{entry.topic.command}`{': ' if origin else ''}{origin}.", "soft"))
    title = f"{entry.topic.group}: {entry.topic.question}"
    return Section(title, tuple(blocks), name, _VERDICTS[entry.verdict], badge=entry.verdict)


def brief(summary: str) -> str:
    """The headline of summary.md and, of its table, the lines of the main reports."""
    headline, _, rest = summary.partition("\n")
    rows = [line for line in rest.splitlines() if line.startswith(("| report", "|---"))]
    rows += [line for name in QUOTED for line in rest.splitlines() if line.startswith(f"| {name} |")]
    return "\n".join([headline, "", *rows, ""])


def quote(readme: Path, summary: str) -> bool:
    """Put the main lines of summary.md between the marks of a README; whether there is such a file.

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
    write_atomically(readme, f"{before}{BEGIN}\n{brief(summary)}{END}{after}")
    return True
