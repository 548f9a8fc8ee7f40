"""`python -m validation dashboard`: one page over all reports, and the summary that the README quotes."""

from __future__ import annotations

import datetime
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from validation.dashboard.gather import Entry, gather
from validation.dashboard.page import QuoteError, headline, quote, write_dashboard
from validation.dashboard.regenerate import Outcome, commands, regenerate
from validation.reporting import provenance

# Distribution -> the names that reports have for it.
_ALIASES = {"pin": ("pinocchio", "pinocchio-urdf"), "mujoco": ("mujoco-urdf",)}


def register(app: typer.Typer) -> None:
    """Add the command to the command line."""
    app.command("dashboard")(dashboard)


def dashboard(
    report: Annotated[Path, typer.Option(help="Folder of the reports; index.html and summary.md go there.")] = Path(
        "reports"
    ),
    readme: Annotated[Path, typer.Option(help="Gets the summary between its marks, if it is there.")] = Path(
        "README.md"
    ),
    anew: Annotated[bool, typer.Option("--regenerate", help="Write all reports anew before; hours.")] = False,
) -> None:
    """Gather the reports on one page.

    Exit code: 0 no report is bad, 1 one is, 2 bad input, 130 interrupted while reports were written anew.
    """
    if not report.is_dir():
        raise typer.BadParameter(f"no folder {report}; `--regenerate` fills one that is there", param_hint="--report")
    interrupted = anew and not _all_anew(report)
    entries = gather(report, installed(), datetime.date.today())
    page = write_dashboard(entries, report, provenance.now())
    try:
        quote(readme, (report / "summary.md").read_text(encoding="utf-8"))
    except QuoteError as error:
        raise typer.BadParameter(str(error), param_hint="--readme") from None
    _show(entries)
    typer.echo(f"{headline(entries)} Page: {page}")
    bad = any(entry.verdict == "bad" for entry in entries)
    raise typer.Exit(130 if interrupted else 1 if bad else 0)


def installed() -> dict[str, str]:
    """Versions of now, under the names that reports use."""
    found = provenance.versions()
    return found | {alias: found[name] for name, aliases in _ALIASES.items() if name in found for alias in aliases}


def _all_anew(folder: Path) -> bool:
    """Every report; whether none was left out by Ctrl-C. Those finished before are kept."""
    console = Console(stderr=True)
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("", total=len(commands()))

        def done(outcome: Outcome) -> None:
            words = {0: "written", 1: "written; something in it is wrong"}.get(outcome.code, f"failed ({outcome.code})")
            console.print(f"{outcome.name}: {words}, {outcome.seconds:.0f} s", markup=False)
            if outcome.said:
                console.print(outcome.said, markup=False)
            bar.update(task, advance=1)

        try:
            regenerate(folder, lambda name: bar.update(task, description=name), done)
        except KeyboardInterrupt:
            console.print("interrupted; the reports that were finished are kept", markup=False)
            return False
    return True


def _show(entries: list[Entry]) -> None:
    for entry in entries:
        said = entry.card.headline if entry.card else "; ".join(entry.remarks)
        typer.echo(f"{entry.name:11}{entry.verdict:10}{said}")
