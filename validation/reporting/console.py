"""The terminal: progress while it runs, a table when it is done."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table
from rich.text import Text

from validation.check import ModelResult
from validation.reporting.record import Record
from validation.reporting.tables import BRIEF, Cell, Line, by_engine, by_model, failures, headline, unsupported
from validation.worker_pool import Report

# Wide enough for every column when the output is not a terminal, which has a width of its own.
PLAIN_WIDTH = 120

# Up to so many models, each engine has a line of its own.
DETAILED = 2

_STYLES = {"agree": "green", "disagree": "bold red", "failed": "bold red", "unsupported": "yellow"}


def output() -> Console:
    """Where results go."""
    return Console(width=None if sys.stdout.isatty() else PLAIN_WIDTH, highlight=False)


@contextmanager
def progress(total: int) -> Iterator[Report]:
    """A bar on the error stream, so that the output stays clean; gives what to call with each result."""
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    console = Console(stderr=True)
    # The bar is for eyes: a file or a pipe gets nothing.
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("cross-checking", total=total)

        def done(result: ModelResult) -> None:
            bar.update(task, advance=1, description=f"{escape(result.label)}: {'agrees' if result.ok else 'DISAGREES'}")

        yield done


def show(record: Record, console: Console) -> None:
    """Print the table, what is wrong, and what could not be compared."""
    detailed = len(record.models) <= DETAILED
    if record.models:
        console.print(_table(by_engine(record, BRIEF) if detailed else by_model(record, BRIEF), detailed))
    for remark in unsupported(record):
        console.print(Text(f"not compared: {remark.model}, {remark.engine}: {remark.text}", style="yellow"))
    for remark in failures(record):
        console.print(Text(f"{remark.model}, {remark.engine}: {remark.text}", style="red"))
    style = "bold green" if record.ok else "bold red"
    console.print(Text(f"{headline(record)} {record.seconds:.0f} s.", style=style))


def _table(lines: list[Line], detailed: bool) -> Table:
    title = "Largest error over all states" + ("" if detailed else " and engines") + ", relative to the largest entry"
    table = Table(title=title, title_justify="left", box=SIMPLE_HEAD, padding=(0, 2, 0, 0), pad_edge=False)
    table.add_column("model", no_wrap=True)
    table.add_column("nv", justify="right")
    table.add_column("engine" if detailed else "engines", justify="left" if detailed else "right", no_wrap=True)
    used = [k for k in range(len(BRIEF)) if any(line.cells[k].row for line in lines)]
    for k in used:
        table.add_column(BRIEF[k].title, justify="right", no_wrap=True)
    table.add_column("verdict", no_wrap=True)
    for line in lines:
        who = line.engine if detailed else str(line.engines)
        cells = [_shown(line.cells[k]) for k in used]
        nv = "" if line.nv is None else str(line.nv)
        table.add_row(escape(line.model), nv, who, *cells, Text(line.status, style=_STYLES[line.status]))
    return table


def _shown(cell: Cell) -> Text:
    if cell.row is None:
        return Text("")
    number = "NaN" if cell.row.error is None else f"{cell.row.error:.0e}"
    return Text("0" if cell.row.error == 0.0 else number, style="" if cell.row.ok else "bold red")
