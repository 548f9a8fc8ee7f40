"""Report -> terminal: its digest as Markdown in colours, and its summary."""

from __future__ import annotations

import re
import sys

from rich.console import Console
from rich.markdown import Markdown
from rich.text import Text

from validation.reporting import markdown
from validation.reporting.record import Report

# Wide enough for every column when the output is not a terminal, which has a width of its own.
PLAIN_WIDTH = 140
# A tag outside of `code` would be taken for HTML, and left out.
_TAG = re.compile("(`[^`]*`)|<")


def show(report: Report) -> None:
    """Print the digest and the summary."""
    console = Console(width=None if sys.stdout.isatty() else PLAIN_WIDTH, highlight=False)
    for block in report.digest:
        console.print(Markdown(_TAG.sub(lambda part: part[1] or "\\<", markdown.block(block)), hyperlinks=False))
    style = {True: "bold green", False: "bold red", None: "bold"}[report.ok]
    console.print(Text(report.summary, style=style), soft_wrap=True)
