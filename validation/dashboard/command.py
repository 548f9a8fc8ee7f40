"""`python -m validation dashboard`, `render`, `all`: one page over all reports; their pages, or all of them, anew."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..program import PROGRAM
from ..reporting import provenance
from ..reporting.command import REPORTS, Exit, Output, known
from ..reporting.command import render as render_report
from .catalogue import TOPICS
from .everything import make_all
from .gather import Entry, gather
from .index import QuoteError, headline, quote, write_index

Readme = Annotated[Path, typer.Option(help="Gets the summary between its marks, if it is there.")]


def register(app: typer.Typer) -> None:
    """Add the commands to the command line."""
    app.command("dashboard")(dashboard)
    app.command("render")(render)
    app.command("all")(make_all)


def dashboard(
    output: Output = REPORTS,
    readme: Readme = Path("README.md"),
) -> None:
    """Gather the reports on one page.

    Exit code: 0 no report misses anything, 1 one does, 2 bad input.
    """
    entries = _gathered(output, list(TOPICS))
    page = write_index(entries, output, provenance.now())
    try:
        quote(readme, (output / "summary.md").read_text(encoding="utf-8"))
    except QuoteError as error:
        raise typer.BadParameter(str(error), param_hint="--readme") from None
    typer.echo(f"{headline(entries)} Page: {page}")
    missed = any(entry.verdict in ("wrong", "missed") for entry in entries.values())
    raise typer.Exit(Exit.MISSED if missed else Exit.GOOD)


def render(
    names: Annotated[list[str] | None, typer.Argument(help=f"Reports: {', '.join(TOPICS)}; none: all.")] = None,
    output: Output = REPORTS,
) -> None:
    """Write the HTML and Markdown of reports anew from their JSON, without measuring anything.

    Exit code: 0 all could be read, 1 one could not, 2 bad input.
    """
    entries = _gathered(output, known(names, TOPICS, "NAME", "report"))
    for name, entry in entries.items():
        if entry.report is not None:
            render_report(TOPICS[name], entry.data, output, entry.report)
    raise typer.Exit(Exit.GOOD if all(entry.report for entry in entries.values()) else Exit.MISSED)


def _existing(folder: Path) -> Path:
    if not folder.is_dir():
        raise typer.BadParameter(f"no folder {folder}; `{PROGRAM} all` fills one", param_hint="--output")
    return folder


def _gathered(folder: Path, names: list[str]) -> dict[str, Entry]:
    """Entries of the reports in a folder, whose verdicts are printed, a line each."""
    entries = gather(_existing(folder), provenance.current_versions(), names=names)
    for name, entry in entries.items():
        typer.echo(f"{name:11}{entry.verdict:10}{entry.said}")
    return entries
