"""A report as data: what it says, found and shows. `html`, `markdown` and `terminal` render it.

Texts may hold `code`, **bold** and [links](#anchor), as in Markdown, and nothing else of it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass
from typing import Any, Literal

from ..program import PROGRAM
from .figures import Chart, Drawing, Figure

MISSED = "**missed** "
# Marks a cell of a target that is not reached, where nothing is wrong.
SHORT = "**short of it** "
_BAR = re.compile(r"\s*(?<!\S)\|(?!\S)\s*")
_NUMBER = re.compile(r"([<>] )?[-+−]?\d([-+−\d.,: ]|e[-+]?\d| of \d)*( ?[%×]| [a-zA-Zµ]{1,3})?( \(\w+\))?|NaN|-?")


def verdict(text: object, ok: bool | None) -> str:
    """The text of a table cell, marked as missed if `ok` is False."""
    return f"{MISSED if ok is False else ''}{text}"


@dataclass(frozen=True)
class Text:
    """A paragraph that is not plain: a remark, a warning, a doubt that is no fault, advice."""

    text: str
    tone: Literal["plain", "soft", "bad", "short", "advice"] = "plain"


@dataclass(frozen=True)
class Code:
    """Text of a program, or what one printed, as it stands."""

    text: str


@dataclass(frozen=True)
class Bullets:
    """A list."""

    items: tuple[str, ...]


@dataclass(frozen=True)
class Cell:
    """A text in a table with a background of some depth, 0 to 1, and a hint for the pointer that rests on it."""

    text: str
    shade: float = 0.0
    hint: str = ""


@dataclass(frozen=True)
class Table:
    """Cells under the names of their columns.

    Attributes:
        grouped: Whether the first cell of a row is of the rows after it, too, where theirs are empty: a page has it
            above them, over all columns.
    """

    head: tuple[str, ...]
    rows: tuple[tuple[str | Cell, ...], ...]
    grouped: bool = False

    def __post_init__(self) -> None:
        for row in self.rows:
            if len(row) != len(self.head):
                raise ValueError(f"a row of {len(row)} cells, {row}, under {len(self.head)} names, {self.head}")

    @classmethod
    def of(cls, head: str, rows: Iterable[str | Sequence[str | Cell]], grouped: bool = False) -> Table:
        """A table as in Markdown: names and cells between " | "; texts from outside come as sequences of cells."""
        cells = (_BAR.split(row) if isinstance(row, str) else row for row in rows)
        return cls(tuple(_BAR.split(head)), tuple(map(tuple, cells)), grouped)

    @classmethod
    def by_group(cls, head: tuple[str, ...], rows: Iterable[tuple[str | Cell, ...]]) -> Table:
        """A grouped table of rows that all state their group in the first cell: it stays in the first row of each."""
        lines: list[tuple[str | Cell, ...]] = []
        group: str | Cell | None = None
        for first, *others in rows:
            lines.append(("" if first == group else first, *others))
            group = first
        return cls(head, tuple(lines), grouped=True)

    def without_empty(self) -> Table:
        """The table without the columns in which nothing is stated."""
        kept = [k for k in range(len(self.head)) if any(row[k] not in ("", "-") for row in self.rows)]
        rows = tuple(tuple(row[k] for k in kept) for row in self.rows)
        return Table(tuple(self.head[k] for k in kept), rows, self.grouped)

    @property
    def numeric(self) -> list[bool]:
        """Which columns hold numbers only."""
        texts = [[one.text if isinstance(one, Cell) else one for one in row] for row in self.rows]
        plain = [[one.removeprefix(MISSED).strip("*") for one in row] for row in texts]
        return [all(map(_NUMBER.fullmatch, column)) for column in zip(*plain, strict=True)] or [False] * len(self.head)


@dataclass(frozen=True)
class Search:
    """A table with a field above it that shows the rows with all words of what is typed; on pages only.

    Attributes:
        examples: Words that one may look for.
    """

    table: Table
    examples: tuple[str, ...]


@dataclass(frozen=True)
class Section:
    """Blocks under a heading; within a section, under a line that opens and shuts them.

    Attributes:
        title: The heading.
        blocks: Content.
        anchor: Name for links; "" for none.
        ok: Verdict; None where nothing was asked. What misses it is open.
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
        """Whether anything is in it: words alone, or beside them a table with rows, a figure with charts, a list."""
        shown = [block for block in self.blocks if not isinstance(block, str | Text)]
        return any(map(is_filled, shown)) if shown else bool(self.blocks)


Block = str | Text | Code | Bullets | Table | Search | Figure | Section


def is_filled(block: Block) -> bool:
    """Whether a block has any content."""
    match block:
        case Table(_, content) | Figure(_, content) | Bullets(content):
            return bool(content)
        case Search(table):
            return bool(table.rows)
        case Section():
            return block.shows
    return True


@dataclass(frozen=True)
class Fact:
    """One key number as shown; its label, with unit and bound; its verdict, None where nothing was asked."""

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
        sections: Parts under headings; those in which nothing is shown are left out.
        facts: Key numbers, for the top of the page and for the index of reports.
        digest: Blocks that a terminal shows; by default the tables and lists of the summary.
        unfinished: Names of parts that an interrupt cut.
        refused: Inputs that could not be read, where nothing else is wrong.
        decisions: What readers decide by, first on the page and on the index of reports.
        missed: What is missed, a line each, with its numbers; by default the key numbers that miss something.
        aims: Whether what it misses is a target that we set ourselves; otherwise something is wrong.
    """

    title: str
    summary: str
    ok: bool | None
    blocks: tuple[Block, ...]
    sections: tuple[Section, ...] = ()
    _: KW_ONLY
    facts: tuple[Fact, ...] = ()
    digest: tuple[Block, ...] = ()
    unfinished: tuple[str, ...] = ()
    refused: tuple[str, ...] = ()
    decisions: tuple[Block, ...] = ()
    missed: tuple[str, ...] = ()
    aims: bool = False

    def __post_init__(self) -> None:
        missed = tuple(f"{fact.value} {fact.label}" for fact in self.facts if fact.ok is False)
        sections = tuple(section for section in self.sections if section.shows)
        stated = (block for section in sections if not section.page_only for block in section.blocks)
        digest = self.digest or tuple(block for block in stated if isinstance(block, Table | Bullets))
        for name, value in {"missed": self.missed or missed, "sections": sections, "digest": digest}.items():
            object.__setattr__(self, name, value)

    @property
    def verdict(self) -> str:
        """The verdict in a word."""
        return {True: "good", False: "missed" if self.aims else "wrong", None: "measured"}[self.ok]

    @property
    def first_chart(self) -> tuple[Chart | Drawing, ...]:
        """The first chart, for the index of reports."""
        figures = (block for section in self.sections for block in section.blocks if isinstance(block, Figure))
        return next((figure.charts[:1] for figure in figures if figure.charts), ())


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
        measure: Run, and the options of the command -> JSON; None for a report whose commands are its own.
        arguments: Arguments after `python -m validation`, or its name elsewhere, that write it; the name if None.
        printed: Names in the JSON that --json prints; none: all.
        folder: Folder of the harness that measures it; by default that of `measure`, or else of `compose`.
        beside: Folders beside the harness that its numbers rest on, too.
    """

    name: str
    group: str
    question: str
    compose: Compose
    measure: Callable[..., Data] | None = None
    arguments: str | None = None
    printed: tuple[str, ...] = ()
    folder: str = ""
    beside: tuple[str, ...] = ()

    @property
    def home(self) -> str:
        """Folder of the harness that its numbers come from."""
        package = __name__.removesuffix("reporting.record")
        return self.folder or (self.measure or self.compose).__module__.removeprefix(package).partition(".")[0]

    @property
    def command(self) -> str:
        """Command that writes the report."""
        return f"{PROGRAM} {self.name if self.arguments is None else self.arguments}".strip()
