"""Report -> Markdown: texts and tables; figures are on the page."""

from __future__ import annotations

from .evidence import standing_text
from .provenance import Provenance
from .record import Block, Bullets, Cell, Code, Report, Search, Section, Table, Text


def page(report: Report, provenance: Provenance, closing: str) -> str:
    """The summary of a report."""
    missed = ("**Missed:**", Bullets(report.missed)) if report.missed else ()
    facts = Bullets(tuple(f"{fact.value} {fact.label}" for fact in report.facts))
    aged = (Text(f"This report {standing_text(provenance.standing)}.", "short"),) if provenance.standing else ()
    blocks = [f"**{report.summary}**", *aged, *report.decisions, *missed, facts, *report.blocks]
    for section in report.sections:
        blocks += () if section.page_only else (f"## {section.title}", *section.blocks)
    origin = "; ".join(f"{name} {value}" for name, value in provenance.rows)
    return "\n\n".join(filter(None, (f"# {report.title}", *map(block, blocks), f"{origin}.", closing))) + "\n"


def block(item: Block) -> str:
    """Any block; nothing of a figure."""
    match item:
        case str():
            return " ".join(item.split())
        case Text(text, tone):
            return f"**{text}**" if tone in ("bad", "short") else text
        case Code(text):
            return f"```\n{text}\n```"
        case Table():
            return table(item)
        case Search(inner, _):
            return table(inner)
        case Bullets(items):
            return "\n".join(f"- {' '.join(one.split())}" for one in items)
        case Section(title, blocks, page_only=False):
            return "\n\n".join(filter(None, [f"{title}:", *map(block, blocks)]))
    return ""


def table(item: Table) -> str:
    """A table, in which no text ends the cell that it stands in."""
    texts = ((one.text if isinstance(one, Cell) else one for one in row) for row in item.rows)
    rows = [item.head, *((" ".join(text.replace("|", "\\|").split()) for text in row) for row in texts)]
    lines = [f"| {' | '.join(row)} |" for row in rows]
    rule = "".join("---:|" if is_number else "---|" for is_number in item.numeric)
    return "\n".join([lines[0], f"|{rule}", *lines[1:]])
