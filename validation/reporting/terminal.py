"""Report -> terminal: its digest as Markdown in colours, and its summary."""

from __future__ import annotations

import re
import sys
from io import StringIO

from rich.console import Console
from rich.markdown import Markdown
from rich.text import Text

from . import markdown
from .record import Block, Report, Table

# Where the output is no terminal, which has a width of its own: lines of text, and of tables, whose rows stay whole.
PLAIN_WIDTH = 100
TABLE_WIDTH = 140
# A tag outside of `code` would be taken for HTML, and left out.
_TAG = re.compile("(`[^`]*`)|<")


def show(report: Report) -> None:
    """Print the digest and the summary."""
    if not sys.stdout.isatty():
        print(plain(report))
        return
    console = Console(highlight=False)
    for block in report.digest:
        console.print(_markdown(block))
    style = {True: "bold green", False: "bold red", None: "bold"}[report.ok]
    console.print(Text(report.summary, style=style), soft_wrap=True)


def plain(report: Report) -> str:
    """The digest and the summary as text without colours."""
    return "\n".join([*map(_plain_block, report.digest), report.summary])


def _plain_block(block: Block) -> str:
    console = Console(file=StringIO(), width=TABLE_WIDTH, highlight=False)
    with console.capture() as captured:
        console.print(_markdown(block), width=TABLE_WIDTH if isinstance(block, Table) else PLAIN_WIDTH)
    return "\n".join(line.rstrip() for line in captured.get().splitlines())


def _markdown(block: Block) -> Markdown:
    return Markdown(_TAG.sub(lambda part: part[1] or "\\<", markdown.block(block)), hyperlinks=False)
