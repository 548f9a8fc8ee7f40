"""A report as data: what it says, found and shows. `html`, `markdown` and `terminal` render it.

Texts may hold `code`, **bold** and [links](#anchor), as in Markdown, and nothing else of it.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import KW_ONLY, dataclass
from functools import partial
from typing import Any, Literal

from validation.reporting.figures import Chart, Drawing, Figure
from validation.reporting.numbers import Form

Tone = Literal["plain", "soft", "bad", "advice"]


@dataclass(frozen=True)
class Text:
    """A paragraph that is not plain: a remark, a warning, advice."""

    text: str
    tone: Tone = "plain"


@dataclass(frozen=True)
class Code:
    """Text of a program, or what one printed, as it stands."""

    text: str


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


_FORM = Form()
# What stands in a column: a function of the row.
Column = Callable[[Any], str | Cell]
Columns = Mapping[str, Column]
_COLUMN = re.compile(r"(?P<title>.+?)(?: = (?P<text>.+?))?(?: \? (?P<no>no )?(?P<verdict>\w+))?")


def columns(stated: str, **computed: Column) -> dict[str, Column]:
    """Columns as "model; #error [m] = {error:.1e} ? ok; place = place()" states them.

    Args:
        stated: Titles, each with its text, in which fields of the row are formatted (`Form`); a title alone is the
            name of its field. Behind "?" stands the field that is the verdict on the cell ("no" turns it round).
        computed: Functions of the row, which texts name with "()".
    """

    def column(part: re.Match[str]) -> Column:
        text, verdict = part["text"] or f"{{{part['title'].removeprefix('#')}}}", part["verdict"]
        cell = computed[text.removesuffix("()")] if text.endswith("()") else partial(_FORM.of, text)
        if verdict is None:
            return cell
        return lambda row: Cell(str(cell(row)), bool(_FORM.field(row, verdict)) is not bool(part["no"]))

    parts = filter(None, map(_COLUMN.fullmatch, " ".join(stated.split()).split("; ")))
    return {part["title"]: column(part) for part in parts}


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
    def of(cls, rows: Iterable[Any], stated: Columns | str, **computed: Column) -> Table:
        """A line for each row; columns as in `columns`."""
        named = columns(stated, **computed) if isinstance(stated, str) else stated
        return cls(tuple(named), tuple(tuple(column(row) for column in named.values()) for row in rows))

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
        anchor: Name for links, which open it; "" for none.
    """

    summary: str
    blocks: tuple[Block, ...]
    opened: bool = False
    page_only: bool = False
    anchor: str = ""


Block = str | Text | Code | Table | Bullets | Figure | Fold


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
        """Whether anything is in it: words alone, or beside them a table with rows, a figure with charts, a list."""
        shown = [block for block in self.blocks if not isinstance(block, str | Text)]
        return any(map(is_filled, shown)) if shown else bool(self.blocks)


def is_filled(block: Block) -> bool:
    """Whether a block has any content."""
    match block:
        case Table(_, content) | Figure(_, content) | Bullets(content):
            return bool(content)
        case Fold():
            return any(map(is_filled, block.blocks))
    return True


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
        digest: Blocks that a terminal shows; by default the tables and lists of the summary.
        unfinished: Names of parts that an interrupt cut.
        refused: Inputs that could not be read, where nothing else is wrong.
        decisions: What readers decide by, first on the page and on the index of reports.
        missed: What is missed, a line each, with its numbers.
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

    @property
    def verdict(self) -> str:
        """The verdict in a word."""
        return {True: "good", False: "missed", None: "measured"}[self.ok]

    @property
    def shortfalls(self) -> tuple[str, ...]:
        """What is missed: as stated, or the key numbers that miss something."""
        return self.missed or tuple(f"{fact.value} {fact.label}" for fact in self.facts if fact.ok is False)

    @property
    def shown(self) -> tuple[Section, ...]:
        """Sections that have something to show."""
        return tuple(section for section in self.sections if section.shows)

    @property
    def telling(self) -> tuple[Chart | Drawing, ...]:
        """The first chart, for the index of reports."""
        figures = (block for section in self.sections for block in section.blocks if isinstance(block, Figure))
        return next((figure.charts[:1] for figure in figures if figure.charts), ())

    @property
    def brief(self) -> tuple[Block, ...]:
        """Blocks that a terminal shows."""
        stated = (block for section in self.shown if not section.page_only for block in section.blocks)
        return self.digest or tuple(block for block in stated if isinstance(block, Table | Bullets))


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
        measure: Run, and the options of the command -> JSON; None for a report whose commands are its own, which
            `dashboard --regenerate` leaves to hand.
        arguments: Arguments after `python -m validation` that write it; the name if None.
        printed: Names in the JSON that --json prints; none: all.
    """

    name: str
    group: str
    question: str
    compose: Compose
    measure: Callable[..., Data] | None = None
    arguments: tuple[str, ...] | None = None
    printed: tuple[str, ...] = ()

    @property
    def words(self) -> tuple[str, ...]:
        """What writes it, after `python -m`."""
        return ("validation", *((self.name,) if self.arguments is None else self.arguments))

    @property
    def command(self) -> str:
        """What writes it."""
        return " ".join(("python -m", *self.words))
