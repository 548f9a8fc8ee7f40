"""`python -m validation dashboard` and `render`: one page over all reports, and their pages anew from their JSON."""

from __future__ import annotations

import datetime
import subprocess
import time
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from symofros.harness import worker_command

from ..program import PROGRAM
from ..reporting import provenance
from ..reporting.command import REPORTS, Exit, Output, known, progress_bar
from ..reporting.command import render as render_report
from ..reporting.record import Topic
from .catalogue import TOPICS
from .gather import Entry, gather
from .index import QuoteError, headline, quote, write_index

Readme = Annotated[Path, typer.Option(help="Gets the summary between its marks, if it is there.")]


def register(app: typer.Typer) -> None:
    """Add the commands to the command line."""
    app.command("dashboard")(dashboard)
    app.command("render")(render)


def dashboard(
    output: Output = REPORTS,
    readme: Readme = Path("README.md"),
    anew: Annotated[bool, typer.Option("--regenerate", help="Write all reports anew before; hours.")] = False,
) -> None:
    """Gather the reports on one page.

    Exit code: 0 no report misses anything, 1 one does, 2 bad input, 130 interrupted while reports were written anew.
    """
    interrupted = anew and not _all_anew(_existing(output))
    entries = _gathered(output, list(TOPICS))
    page = write_index(entries, output, provenance.now())
    try:
        quote(readme, (output / "summary.md").read_text(encoding="utf-8"))
    except QuoteError as error:
        raise typer.BadParameter(str(error), param_hint="--readme") from None
    typer.echo(f"{headline(entries)} Page: {page}")
    missed = any(entry.verdict == "missed" for entry in entries.values())
    raise typer.Exit(Exit.INTERRUPTED if interrupted else Exit.MISSED if missed else Exit.GOOD)


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
        raise typer.BadParameter(f"no folder {folder}; `--regenerate` fills one that is there", param_hint="--output")
    return folder


def _gathered(folder: Path, names: list[str]) -> dict[str, Entry]:
    """What the reports in a folder say, a line each on the terminal."""
    entries = gather(_existing(folder), provenance.versions_now(), datetime.date.today(), names)
    for name, entry in entries.items():
        typer.echo(f"{name:11}{entry.verdict:10}{entry.said}")
    return entries


def _all_anew(folder: Path) -> bool:
    """Every report; whether none was left out by Ctrl-C. Those finished before are kept."""
    console, wanted = Console(stderr=True), [topic for topic in TOPICS.values() if topic.measure]
    with progress_bar(console) as bar:
        task = bar.add_task("", total=len(wanted))
        try:
            for topic in wanted:
                bar.update(task, description=topic.name)
                console.print(regenerate(topic, folder), markup=False)
                bar.advance(task)
        except KeyboardInterrupt:
            console.print("interrupted; the reports that were finished are kept", markup=False)
            return False
    return True


def regenerate(topic: Topic, folder: Path) -> str:
    """How the command of a report ended; in a process of its own, so that one that crashes takes no other with it."""
    start, ends = time.perf_counter(), {0: "written", 1: "written; something in it is missed"}
    arguments = topic.command.removeprefix(PROGRAM).split()
    command = worker_command("__main__", [*arguments, "--output", str(folder)])
    run = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False)
    end = ends.get(run.returncode, f"failed ({run.returncode})")
    # The last lines of what it complained of, if it wrote no report.
    complaint = [] if run.returncode in ends else run.stderr.strip().splitlines()[-5:]
    return "\n".join([f"{topic.name}: {end}, {time.perf_counter() - start:.0f} s", *complaint])
