"""Report -> terminal: its digest as Markdown in colours, and its summary."""

from __future__ import annotations

import re
import sys

from rich.console import Console
from rich.markdown import Markdown
from rich.text import Text

from . import markdown
from .record import Report, Table

# Where the output is no terminal, which has a width of its own: lines of text, and of tables, whose rows stay whole.
PLAIN_WIDTH = 100
TABLE_WIDTH = 140
# A tag outside of `code` would be taken for HTML, and left out.
_TAG = re.compile("(`[^`]*`)|<")


def show(report: Report) -> None:
    """Print the digest and the summary."""
    terminal = sys.stdout.isatty()
    console = Console(width=None if terminal else TABLE_WIDTH, highlight=False)
    for block in report.digest:
        text = Markdown(_TAG.sub(lambda part: part[1] or "\\<", markdown.block(block)), hyperlinks=False)
        if terminal:
            console.print(text)
            continue
        with console.capture() as captured:
            console.print(text, width=TABLE_WIDTH if isinstance(block, Table) else PLAIN_WIDTH)
        console.out("\n".join(line.rstrip() for line in captured.get().splitlines()))
    style = {True: "bold green", False: "bold red", None: "bold"}[report.ok]
    console.print(Text(report.summary, style=style), soft_wrap=True)
