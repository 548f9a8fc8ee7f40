"""Report -> terminal: its digest in colours, and its summary."""

from __future__ import annotations

import re
import sys

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table as RichTable
from rich.text import Text as RichText

from validation.reporting import markdown
from validation.reporting.record import Block, Cell, Report, Table, Text

# Wide enough for every column when the output is not a terminal, which has a width of its own.
PLAIN_WIDTH = 140

_STYLE = {True: "bold green", False: "bold red", None: "bold"}
_TONE = {"plain": "", "soft": "yellow", "bad": "red", "advice": ""}


def output() -> Console:
    """Where results go."""
    return Console(width=None if sys.stdout.isatty() else PLAIN_WIDTH, highlight=False)


def show(report: Report) -> None:
    """Print the digest and the summary."""
    console = output()
    for block in report.brief:
        _print(block, console)
    console.print(RichText(report.summary, style=_STYLE[report.ok]), soft_wrap=True)


def _print(block: Block, console: Console) -> None:
    if isinstance(block, Table):
        console.print(_table(block))
    elif isinstance(block, Text):
        console.print(RichText(block.text, style=_TONE[block.tone]), soft_wrap=True)
    else:
        console.print(RichText(markdown.block(block)))


def _table(table: Table) -> RichTable:
    shown = RichTable(box=SIMPLE_HEAD, padding=(0, 2, 0, 0), pad_edge=False)
    for k, name in enumerate(table.head):
        number = name.startswith("#")
        shown.add_column(name.removeprefix("#"), justify="right" if number else "left", no_wrap=k == 0 or number)
    for row in table.rows:
        shown.add_row(*map(_cell, row))
    return shown


def _cell(item: str | Cell) -> RichText:
    if isinstance(item, str):
        return RichText(_plain(item))
    return RichText(_plain(item.text), style="bold red" if item.ok is False else "")


def _plain(text: str) -> str:
    """Without the signs of links and of bold letters."""
    return re.sub(r"\[([^\]]+)\]\(#[^)]*\)", r"\1", text).replace("**", "")
