"""Entries -> index.html and trust.html (self-contained pages), summary.md, and its main lines in the README."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Mapping
from pathlib import Path

from symofros.tools import write_atomically

from ..program import PROGRAM
from ..reporting import html, markdown
from ..reporting.evidence import revision, standing_text
from ..reporting.figures import Figure
from ..reporting.record import MISSED, SHORT, Block, Bullets, Report, Section, Table, Text
from .asked import asked_first
from .gather import Entry
from .trust import TITLE, trust

BEGIN, END = "<!-- reports/summary.md begins -->", "<!-- reports/summary.md ends -->"

# Reports whose lines the README quotes.
QUOTED = ("check", "oracle", "mutants", "engines", "accuracy", "stability", "timing")

# Verdict of an entry -> whether what was asked for is met.
_VERDICTS = {"good": True, "wrong": False, "missed": False, "measured": None, "absent": None}
# Verdict of an entry -> mark of its cell: red is for what is wrong, and for nothing else.
_MARKS = {"wrong": MISSED, "missed": SHORT}
# Reports whose decisions the index has under a line that opens them.
_DECIDING = {
    "pareto": "Which method for my scene?",
    "timing": "How fast is it beside which engine, on which model?",
    "engines": "Which engine is wrong, and why?",
    "check": "Which engine has which opinion of our C?",
    "accuracy": "How far may a beam bend, how many functions does it need?",
}


# Where the first sentence of a summary ends.
_CLAUSE = re.compile(r"(?<=[.?!])\s+(?=[A-Z0-9])|;\s+")
# The page that answers whether one may trust all this.
TRUST = "trust.html"


class QuoteError(ValueError):
    """A file has no place for the summary."""


def write_index(entries: Mapping[str, Entry], folder: Path, date: str) -> Path:
    """Write index.html, which is returned, trust.html and summary.md.

    Raises:
        OSError: The folder can't be written to.
    """
    report = index(entries)
    closing = f"Gathered {date} by `{PROGRAM} dashboard`; `{PROGRAM} all` makes reports anew."
    page = html.page(report, closing=closing, listed=False)
    own = html.page(trust(entries), closing=f"{closing} All reports: [the index](index.html).", listed=False)
    source = f" of revision {revision()[:9]}" if revision() else ""
    said = (
        f"**{headline(entries)}** (gathered {date}{source})",
        markdown.table(summary_table(entries)),
        origins(entries),
    )
    write_atomically(folder / "index.html", page)
    write_atomically(folder / TRUST, own)
    write_atomically(folder / "summary.md", "\n\n".join(said) + "\n")
    return folder / "index.html"


def index(entries: Mapping[str, Entry]) -> Report:
    """The report over all reports: a line each; what people decide by; then what each says in short, folded."""
    groups = dict.fromkeys(entry.topic.group for entry in entries.values())
    wrong = [(name, entry.report) for name, entry in entries.items() if entry.report and entry.verdict == "wrong"]
    verdicts = {entry.verdict for entry in entries.values()}
    return Report(
        "What the harness found",
        _found(entries),
        not verdicts & {"wrong", "missed"},
        (
            _LEAD,
            asked_first(entries),
            summary_table(entries, linked=True),
            *(Text(f"Of the reports, {aged}.", "soft") for aged in [", ".join(_aged(entries))] if aged),
            *_decisions(entries),
            *_short_of(entries),
        ),
        tuple(_group(group, {n: e for n, e in entries.items() if e.topic.group == group}) for group in groups),
        missed=tuple(f"[{name}](#{name}): {line}" for name, report in wrong for line in report.missed),
        aims="wrong" not in verdicts,
    )


_LEAD = f"**[{TITLE}]({TRUST})** says in a minute what is covered, who agrees, how fast it is, where it fails."


def _decisions(entries: Mapping[str, Entry]) -> Iterator[Section]:
    """What people decide by, folded under the question that it answers."""
    for name, asked in _DECIDING.items():
        report = entries[name].report if name in entries else None
        if report is not None and report.decisions:
            yield Section(asked, report.decisions)


def _short_of(entries: Mapping[str, Entry]) -> Iterator[Section]:
    """Targets of ours that are missed, folded."""
    reports = {name: entry.report for name, entry in entries.items() if entry.report and entry.verdict == "missed"}
    lines = tuple(f"[{name}](#{name}): {line}" for name, report in reports.items() for line in report.missed)
    if lines:
        yield Section(f"Which targets of ours are missed? {len(lines)}", (Bullets(lines),))


def _group(title: str, entries: Mapping[str, Entry]) -> Section:
    return Section(title, tuple(_section(name, entry) for name, entry in entries.items()))


def headline(entries: Mapping[str, Entry]) -> str:
    """One sentence that says what is wrong, counts the reports by verdict and by age of their sources."""
    return "; ".join([_found(entries).removesuffix("."), *_aged(entries)]) + "."


def _found(entries: Mapping[str, Entry]) -> str:
    named = {word: [n for n, e in entries.items() if e.verdict == word] for word in _VERDICTS}
    good, wrong, missed, _, absent = named.values()
    said = [f"Something is wrong in {', '.join(wrong)}" if wrong else "No report finds anything wrong"]
    said += [f"{len(good)} of {len(good) + len(wrong) + len(missed)} with a verdict are good"]
    said += [f"{', '.join(missed)} miss{'es' * (len(missed) == 1)} targets of ours"] if missed else []
    said += [f"absent: {', '.join(absent)}"] if absent else []
    return "; ".join(said) + "."


def _aged(entries: Mapping[str, Entry]) -> list[str]:
    """How many reports judge nothing, and how many are of which age."""
    aged = Counter(entry.standing for entry in entries.values() if entry.standing)
    measured = sum(entry.verdict == "measured" for entry in entries.values())
    said = [f"{measured} measure{'s' * (measured == 1)} without a verdict"] if measured else []
    return said + [f"{number} {standing}" for standing, number in aged.items()]


def summary_table(entries: Mapping[str, Entry], linked: bool = False) -> Table:
    """A line a report; `linked`: for the page, where its question leads to it, its name to what the page says of it."""
    rows: list[tuple[str, ...]] = []
    for name, entry in entries.items():
        made = "; ".join(filter(None, (entry.provenance.date.removesuffix(" UTC") or "-", entry.standing)))
        if linked:
            asked = entry.topic.question
            said = f"[{asked}]({entry.page})" if entry.page else asked
            marked = f"{_MARKS.get(entry.verdict, '')}[{entry.verdict}](#{name})"
            rows.append((said, _first(entry.said), marked))
        else:
            rows.append((name, entry.said, entry.verdict, made))
    head = "question | answer | verdict" if linked else "report | what it found | verdict | made (UTC)"
    return Table.of(head, rows)


def _first(said: str) -> str:
    """The first sentence of a summary, or what of it comes before a semicolon."""
    return f"{_CLAUSE.split(said)[0].rstrip('.')}."


def origins(entries: Mapping[str, Entry]) -> str:
    """The machines that numbers come from, and the versions."""
    stated = [entry.provenance for entry in entries.values()]
    machines = dict.fromkeys(origin.machine for origin in stated if origin.machine)
    versions = {name: version for origin in stated for name, version in origin.versions.items()}
    return ";\n".join([*machines, ", ".join(f"{name} {version}" for name, version in sorted(versions.items()))]) + "."


def _section(name: str, entry: Entry) -> Section:
    """What the index says of a report, folded."""
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
    aged = f", {entry.standing}" if entry.standing else ""
    title = f"{entry.topic.question} {name}: {entry.verdict}{aged}"
    return Section(title, tuple(blocks), name, None)


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
