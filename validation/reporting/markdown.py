"""Report -> Markdown: texts and tables; figures are on the page."""

from __future__ import annotations

from validation.reporting.figures import Figure
from validation.reporting.provenance import Provenance
from validation.reporting.record import Block, Bullets, Cell, Code, Fold, Report, Table, Text


def page(report: Report, provenance: Provenance, closing: str) -> str:
    """The summary of a report."""
    parts = [f"# {report.title}", f"**{report.summary}**", *map(block, report.decisions)]
    if report.shortfalls:
        parts += ["**Missed:**", block(Bullets(report.shortfalls))]
    if report.facts:
        parts.append(block(Bullets(tuple(f"{fact.value} {fact.label}" for fact in report.facts))))
    parts += map(block, report.blocks)
    for section in report.shown:
        if not section.page_only:
            parts += [f"## {section.title}", *map(block, section.blocks)]
    told = "; ".join(f"{name} {value}" for name, value in provenance.rows)
    parts += [f"{told}.", closing]
    return "\n\n".join(filter(None, parts)) + "\n"


def block(item: Block) -> str:
    """Any block; nothing of a figure."""
    match item:
        case str():
            return item
        case Text(text, tone):
            return f"**{text}**" if tone == "bad" else text
        case Code(text):
            return f"```\n{text}\n```"
        case Table():
            return table(item)
        case Bullets(items):
            return "\n".join(f"- {' '.join(one.split())}" for one in items)
        case Figure():
            return ""
        case Fold(summary, blocks, _, page_only, _):
            return "" if page_only else "\n\n".join(filter(None, [f"{summary}:", *map(block, blocks)]))


def table(item: Table) -> str:
    """A table."""
    head = "| " + " | ".join(name.removeprefix("#") for name in item.head) + " |"
    rule = "|" + "|".join("---:" if name.startswith("#") else "---" for name in item.head) + "|"
    return "\n".join([head, rule, *("| " + " | ".join(map(cell, row)) + " |" for row in item.rows)])


def cell(item: str | Cell) -> str:
    """A text that can't end the cell it stands in; what is wrong says so."""
    text = item.text if isinstance(item, Cell) else item
    wrong = "**missed** " if isinstance(item, Cell) and item.ok is False else ""
    return wrong + " ".join(text.replace("|", "\\|").split())
