"""A report as data: what it says, found and shows. `html`, `markdown` and `terminal` render it.

Texts may hold `code`, **bold** and [links](#anchor), as in Markdown, and nothing else of it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from validation.reporting.figures import Chart, Drawing, Figure
from validation.reporting.findings import Finding
from validation.reporting.numbers import counted, short

Tone = Literal["plain", "soft", "bad", "advice"]


@dataclass(frozen=True)
class Text:
    """A paragraph that is not plain: a remark, a warning, advice."""

    text: str
    tone: Tone = "plain"


@dataclass(frozen=True)
class Cell:
    """A cell of a table.

    Attributes:
        text: Content.
        ok: Verdict; None where nothing was asked.
        shade: Depth of its background, 0 to 1.
        hint: Text shown when the pointer rests on it.
    """

    text: str
    ok: bool | None = None
    shade: float = 0.0
    hint: str = ""


# What stands in a column: a format such as "{error:.1e}", or a function of the row.
Column = str | Callable[[Any], str | Cell]


@dataclass(frozen=True)
class Table:
    """A table.

    Attributes:
        head: Names of the columns; those that begin with "#" hold numbers.
        rows: Cells.
    """

    head: tuple[str, ...]
    rows: tuple[tuple[str | Cell, ...], ...]

    @classmethod
    def of(cls, rows: Iterable[Any], columns: Mapping[str, Column]) -> Table:
        """A line for each row, a mapping or a record; a column formats its fields, or is a function of it."""

        def cell(row: Any, column: Column) -> str | Cell:
            if callable(column):
                return column(row)
            return column.format_map(row if isinstance(row, Mapping) else vars(row))

        lines = tuple(tuple(cell(row, column) for column in columns.values()) for row in rows)
        return cls(tuple(columns), lines)

    def without_empty(self) -> Table:
        """The table without the columns in which nothing is stated."""
        kept = [k for k in range(len(self.head)) if any(row[k] not in ("", "-") for row in self.rows)]
        return Table(tuple(self.head[k] for k in kept), tuple(tuple(row[k] for k in kept) for row in self.rows))


@dataclass(frozen=True)
class Bullets:
    """A list."""

    items: tuple[str, ...]


@dataclass(frozen=True)
class Fold:
    """Blocks under a line that opens and shuts them.

    Attributes:
        summary: The line.
        blocks: Blocks that are folded.
        opened: Whether it is open at first.
        page_only: Whether the Markdown summary leaves it out.
    """

    summary: str
    blocks: tuple[Block, ...]
    opened: bool = False
    page_only: bool = False


Block = str | Text | Table | Bullets | Figure | Fold


@dataclass(frozen=True)
class Section:
    """Blocks under a heading.

    Attributes:
        title: The heading.
        blocks: Content.
        anchor: Name for links; "" for none.
        ok: Verdict; None where nothing was asked.
        page_only: Whether the Markdown summary leaves it out.
        badge: The verdict in a word, beside the heading.
    """

    title: str
    blocks: tuple[Block, ...]
    anchor: str = ""
    ok: bool | None = None
    page_only: bool = False
    badge: str = ""

    @property
    def shows(self) -> bool:
        """Whether it has more than words: a table with rows, a figure with charts, a list, or a fold."""
        return any(
            block.rows if isinstance(block, Table) else block.charts if isinstance(block, Figure) else True
            for block in self.blocks
            if not isinstance(block, str | Text)
        )


@dataclass(frozen=True)
class Fact:
    """One key number with its meaning.

    Attributes:
        value: Value as shown.
        label: Label, with unit and bound.
        ok: Verdict; None where nothing was asked.
    """

    value: str
    label: str
    ok: bool | None = None


@dataclass(frozen=True)
class Report:
    """One report.

    Attributes:
        title: Heading.
        summary: Result in one sentence.
        ok: Verdict; None for a measurement of which nothing was asked.
        blocks: Blocks before the first section.
        sections: Parts under headings.
        facts: Key numbers, for the top of the page and for the index of reports.
        highlights: Most telling charts, for the index of reports.
        digest: Lines that a terminal shows.
        unfinished: Names of parts that an interrupt cut.
        refused: Inputs that could not be read, where nothing else is wrong.
    """

    title: str
    summary: str
    ok: bool | None
    blocks: tuple[Block, ...]
    sections: tuple[Section, ...] = ()
    facts: tuple[Fact, ...] = ()
    highlights: tuple[Chart | Drawing, ...] = ()
    digest: tuple[Block, ...] = ()
    unfinished: tuple[str, ...] = ()
    refused: tuple[str, ...] = ()

    @property
    def verdict(self) -> str:
        """The verdict in a word."""
        return {True: "good", False: "missed", None: "measured"}[self.ok]


# The JSON of a report, and what makes a report of it.
Data = Mapping[str, Any]
Compose = Callable[[Data], Report]


@dataclass(frozen=True)
class Topic:
    """A report that can be asked for.

    Attributes:
        name: Name of its command and its files.
        group: Heading that it stands under in the index.
        question: Question that it answers.
        compose: JSON of the report -> report.
        arguments: Arguments after `python -m validation` that write it; the name if None.
        everyday: Whether `dashboard --regenerate` writes it; one that takes a plan of one's own is left to hand.
    """

    name: str
    group: str
    question: str
    compose: Compose
    arguments: tuple[str, ...] | None = None
    everyday: bool = True

    @property
    def command(self) -> str:
        """What writes it."""
        return " ".join(("python -m validation", *((self.name,) if self.arguments is None else self.arguments)))


def findings_table(findings: Sequence[Finding]) -> Table:
    """Numbers beside their bounds."""
    rows = tuple((f.quantity, Cell(short(f.value), f.ok), short(f.low), short(f.high), f.reason) for f in findings)
    return Table(("number", "#found", "#at least", "#at most", "reason of the bound"), rows)


def findings_fold(findings: Sequence[Finding], noun: str) -> Fold:
    """The numbers, open where one misses its bounds."""
    missed = sum(not f.ok for f in findings)
    said = f"{counted(len(findings), noun)} and their bounds" + (f": **{missed} missed**" if missed else "")
    return Fold(said, (findings_table(findings),), opened=bool(missed))


def findings_digest(groups: Mapping[str, Sequence[Finding]], failures: Mapping[str, str], noun: str) -> Table:
    """The numbers of several parts, for a terminal."""
    rows: list[tuple[str | Cell, ...]] = [
        (name, f.quantity, Cell(short(f.value), f.ok), f"{short(f.low)} … {short(f.high)}", verdict_word(f.ok))
        for name, findings in groups.items()
        for f in findings
    ]
    rows += [(name, Cell(reason, False), "", "", "failed") for name, reason in failures.items()]
    return Table((noun, "number", "#found", "bounds", "verdict"), tuple(rows))


def failure_texts(failures: Mapping[str, str]) -> tuple[Text, ...]:
    """The parts that could not be done, with their reasons."""
    return tuple(Text(f"{name} could not be done: {reason}", "bad") for name, reason in failures.items())


def verdict_word(ok: bool) -> str:
    """For a column of verdicts."""
    return "ok" if ok else "missed"


def bounds_kept(findings: Sequence[Finding]) -> str:
    """What findings come to, in words."""
    missed = sum(not f.ok for f in findings)
    return f"{missed} miss their bounds" if missed else "all within their bounds"
