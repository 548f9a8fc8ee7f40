"""A topic's command: its questions answered, as a report with figures."""

import json
import time
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

import symofros as sf
from validation.evidence.findings import Study
from validation.questions.report import Answers, as_data, write_report
from validation.questions.topic import Topic


def register(app: typer.Typer, topic: Topic) -> None:
    """Add a topic's command to the command line."""

    def command(
        chosen: Annotated[
            list[str] | None, typer.Option("--study", help=f"Only this; of {', '.join(topic.studies)}.")
        ] = None,
        quick: Annotated[bool, typer.Option("--quick", help="Fewer points and shorter motions.")] = False,
        report: Annotated[Path, typer.Option(help=f"Folder for {topic.name}.html, .md and .json.")] = Path("reports"),
        as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON, nothing else.")] = False,
    ) -> None:
        for name in chosen or ():
            if name not in topic.studies:
                known = ", ".join(topic.studies)
                raise typer.BadParameter(f"no study '{name}'; there are {known}", param_hint="--study")
        run = answered(topic, chosen or list(topic.studies), quick)
        page = write_report(run, report)
        if as_json:
            typer.echo(json.dumps(as_data(run), allow_nan=False))
        else:
            _show(run)
            typer.echo(f"{run.headline} {run.seconds:.0f} s. Report: {page}")
        raise typer.Exit(0 if run.ok else 1)

    codes = "Exit code: 0 every number is within its bounds, 1 one is not, 2 bad input."
    app.command(topic.name, help=f"{topic.help}\n\n{codes}")(command)


def answered(topic: Topic, names: list[str], quick: bool) -> Answers:
    """The answers to these questions; one that fails does not keep the others from being asked."""
    start = time.perf_counter()
    studies: dict[str, Study] = {}
    failures: dict[str, str] = {}
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task(topic.name, total=len(names))
        for name in names:
            bar.update(task, description=name)
            try:
                studies[name] = topic.studies[name](quick)
            except (sf.SymofrosError, ArithmeticError, ValueError) as error:
                failures[name] = f"{type(error).__name__}: {error}"
            bar.update(task, advance=1)
    return Answers(topic, studies, failures, quick, time.perf_counter() - start)


def _show(run: Answers) -> None:
    table = Table("study", "number", "found", "bounds", "")
    for name, study in run.studies.items():
        for check in study.checks:
            bounds = f"{check.low:.6g} … {check.high:.6g}"
            verdict = "[green]ok[/]" if check.ok else "[bold red]missed[/]"
            table.add_row(name, check.what, f"{check.found:.6g}", bounds, verdict)
    for name, reason in run.failures.items():
        table.add_row(name, reason, "", "", "[bold red]failed[/]")
    Console().print(table)
