"""`python -m validation timing`: what to measure, in parts if wanted, and the report."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Collection, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from validation.timing.flexible.race import LABEL, run_flexible
from validation.timing.models import FUNCTIONS, SCENES
from validation.timing.record import Record, as_data, read
from validation.timing.report import write_report
from validation.timing.run import facts, jobs, load, prepare, run_job
from validation.timing.sections import headline
from validation.timing.sides.programs import BuildError
from validation.timing.targets import verdicts
from validation.timing.task import STATES
from validation.timing.worker import PEERS, Job

# Four times through the copies of a library.
REPEATS = 24


def register(app: typer.Typer) -> None:
    """Add the command to the command line."""
    app.command("timing")(timing)


def timing(
    models: Annotated[list[str] | None, typer.Option("--model", help="Only this model; repeatable.")] = None,
    peers: Annotated[list[str] | None, typer.Option("--peer", help=f"Only this peer: {', '.join(PEERS)}.")] = None,
    functions: Annotated[list[str] | None, typer.Option("--function", help="Only this function; repeatable.")] = None,
    repeats: Annotated[int, typer.Option(min=3, help="Interleaved repeats.")] = REPEATS,
    states: Annotated[int, typer.Option(min=64, help="Random states.")] = STATES,
    report: Annotated[Path, typer.Option(help="Folder for timing.html, .md and .json.")] = Path("reports"),
    resume: Annotated[bool, typer.Option("--resume", help="Leave out what the report has figures of.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON, nothing else.")] = False,
) -> None:
    """Time generated C against Pinocchio's C++, MuJoCo's C, C by CasADi and by SymPy, and Exudyn's flexible robot.

    A part that is chosen replaces that part of the report's figures; the whole starts afresh. Ctrl-C keeps what was
    measured. Exit code: 0 everything was timed, 1 something failed, 2 bad input, 130 interrupted.
    """
    _known(models, [*SCENES, LABEL], "--model")
    _known(peers, PEERS, "--peer")
    _known(functions, FUNCTIONS, "--function")
    in_parts = bool(models or peers or functions or resume)
    record = read(report / "timing.json") if in_parts else Record()
    todo = jobs(
        [name for name in models or SCENES if name in SCENES],
        tuple(peers or PEERS),
        functions or FUNCTIONS,
        repeats,
        states,
        record if resume else None,
    )
    flexible = LABEL in models if models else not (peers or functions) and not (resume and record.flexible)
    measures = bool(todo) or flexible
    before, limits, interrupted = load(), facts() if measures else {}, False

    def save() -> Path:
        """After each model, so that even a kill leaves what was measured."""
        now = time.strftime("%Y-%m-%d %H:%M UTC", time.gmtime())
        if measures:
            record.machine = {
                **limits,
                "load before and after": [*before, *load()],
                "date": now,
                "states": states,
                "repeats": repeats,
            }
        return write_report(record, report)

    try:
        _measure(record, todo, flexible, repeats, save)
    except KeyboardInterrupt:
        interrupted = True
    page = save()
    if as_json:
        typer.echo(json.dumps(as_data(record)))
    else:
        _show(record)
        typer.echo(f"{headline(record)} Report: {page}")
    raise typer.Exit(130 if interrupted else 1 if record.failed else 0)


def _known(chosen: Sequence[str] | None, names: Collection[str], option: str) -> None:
    for name in chosen or ():
        if name not in names:
            raise typer.BadParameter(f"no '{name}'; there are {', '.join(names)}", param_hint=option)


def _measure(record: Record, todo: Sequence[Job], flexible: bool, repeats: int, save: Callable[[], object]) -> None:
    """Everything, with a bar."""
    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn("{task.completed}/{task.total}"),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        shown = bar.add_task("compiling the engines", total=sum(len(job.functions) for job in todo) + int(flexible))
        for failure in prepare({peer for job in todo for peer in job.peers}):
            console.print(failure, style="bold red", markup=False)
        for job in todo:
            said, failed = len(record.skipped), len(record.failed)

            def done(model: str, function: str) -> None:
                bar.update(shown, description=f"{model}: {FUNCTIONS[function]}", advance=1)
                if not console.is_terminal:
                    console.print(f"{model}: {FUNCTIONS[function]}", markup=False)

            run_job(job, record, done)
            for notes, style in ((record.skipped[said:], "yellow"), (record.failed[failed:], "bold red")):
                for model, function, peer, why in notes:
                    console.print(f"not timed: {model}, {function}, {peer}: {why}", style=style, markup=False)
            save()
        if flexible:
            bar.update(shown, description=LABEL, advance=1)
            try:
                record.flexible = [asdict(row) for row in run_flexible(repeats)]
            except BuildError as error:
                record.failed.append((LABEL, "M + h", "exudyn", str(error)))
                console.print(f"not timed: {error}", style="bold red", markup=False)


def _show(record: Record) -> None:
    table = Table("model", "function", "ours", "against", "ratio", "target", "verdict", title="Targets")
    for verdict in verdicts(record):
        target = verdict.target
        style = "green" if verdict.met else "red" if verdict.entry else ""
        table.add_row(
            SCENES[target.model].title,
            FUNCTIONS[target.function],
            target.how,
            f"{target.peer} {target.family}".strip(),
            f"{verdict.ratio:.2f}",
            f"{target.least:g}",
            f"[{style}]{verdict.words}[/]" if style else verdict.words,
        )
    Console().print(table)
