"""`python -m validation`: do independent engines agree with the generated code?"""

from __future__ import annotations

import contextlib
import json
import os
import time
from enum import IntEnum
from pathlib import Path
from typing import Annotated

import typer

from symofros.atomic import write_atomically
from validation.accuracy.catalogue import TOPIC as ACCURACY
from validation.adapters import ROUTES
from validation.campaigns import command as campaign
from validation.check import ModelResult, Settings
from validation.dashboard import command as dashboard
from validation.diagrams.catalogue import TOPIC as DIAGRAMS
from validation.inputs.cases import Case, named, standard_set
from validation.inputs.sampling import DEFAULT_STATES
from validation.pareto import command as pareto
from validation.passes import command as passes
from validation.questions import command as questions
from validation.reporting.console import output, progress, show
from validation.reporting.files import write_report
from validation.reporting.junit import to_junit
from validation.reporting.provenance import build
from validation.reporting.record import Record, make_record, summary
from validation.stability import command as stability
from validation.studies import (
    exports_report,
    fuzz_report,
    mutation_report,
    oracle,
    realtime_report,
    rollouts_report,
    simulation_report,
)
from validation.timing import command as timing
from validation.worker_pool import run


class Exit(IntEnum):
    """Exit codes."""

    AGREE = 0
    DISAGREE = 1
    BAD_INPUT = 2
    INTERRUPTED = 130


app = typer.Typer(add_completion=False, no_args_is_help=False, pretty_exceptions_enable=False)

States = Annotated[int, typer.Option(min=1, help="Random states a model.")]
Seed = Annotated[int, typer.Option(min=0, help="Of the random states.")]
Engines = Annotated[
    list[str] | None, typer.Option("--engine", help=f"Compare with this engine only; repeatable. {', '.join(ROUTES)}.")
]
AsJson = Annotated[bool, typer.Option("--json", help="Print the verdict and every comparison as JSON, nothing else.")]
Junit = Annotated[Path | None, typer.Option(help="Also write a JUnit file.")]
ReportFolder = Annotated[Path, typer.Option("--report", help="Folder for check.html, check.md, check.json.")]
Workers = Annotated[int, typer.Option(min=1, help="Models checked at the same time.")]
FloatingBase = Annotated[bool, typer.Option("--floating-base", help="Put a free joint under the root of URDF files.")]

_WORKERS = min(os.cpu_count() or 1, 4)
_REPORTS = Path("reports")


@app.callback(invoke_without_command=True)
def standard(
    context: typer.Context,
    states: States = DEFAULT_STATES,
    seed: Seed = 0,
    engine: Engines = None,
    as_json: AsJson = False,
    junit: Junit = None,
    report: ReportFolder = _REPORTS,
    workers: Workers = _WORKERS,
) -> None:
    """Cross-check the generated code. Without a command: the standard set of robots and reference models."""
    if context.invoked_subcommand is None:
        _run([], False, Settings(states, seed, _chosen(engine)), as_json, junit, report, workers)


@app.command()
def check(
    models: Annotated[
        list[str] | None,
        typer.Argument(help="URDF, MJCF or YAML files, or names of the standard set; none: all of it."),
    ] = None,
    floating_base: FloatingBase = False,
    states: States = DEFAULT_STATES,
    seed: Seed = 0,
    engine: Engines = None,
    as_json: AsJson = False,
    junit: Junit = None,
    report: ReportFolder = _REPORTS,
    workers: Workers = _WORKERS,
) -> None:
    """Compare our C of each MODEL with every engine that can represent it.

    Exit code: 0 all agree, 1 something disagrees, 2 bad input.
    """
    settings = Settings(states, seed, _chosen(engine))
    _run(models or [], floating_base, settings, as_json, junit, report, workers)


def _chosen(engines: list[str] | None) -> tuple[str, ...] | None:
    for name in engines or ():
        if name not in ROUTES:
            raise typer.BadParameter(f"no engine '{name}'; there are {', '.join(ROUTES)}", param_hint="--engine")
    return tuple(engines) if engines else None


def _run(
    models: list[str],
    floating_base: bool,
    settings: Settings,
    as_json: bool,
    junit: Path | None,
    report: Path,
    workers: int,
) -> None:
    try:
        cases = named(models, floating_base) if models else standard_set()
    except (LookupError, FileNotFoundError) as error:
        raise typer.BadParameter(str(error.args[0]), param_hint="MODEL") from None
    record = _checked(cases, settings, workers)
    if as_json:
        typer.echo(json.dumps(summary(record), allow_nan=False))
    else:
        show(record, output())
    if junit is not None:
        junit.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(junit, to_junit(record))
    written = write_report(record, report)
    if not as_json:
        typer.echo(f"Report: {written}")
    raise typer.Exit(verdict(record))


def _checked(cases: list[Case], settings: Settings, workers: int) -> Record:
    """Whatever was finished; Ctrl-C cuts the rest."""
    start = time.perf_counter()
    results: dict[str, ModelResult] = {}
    with progress(len(cases)) as show_done:

        def done(result: ModelResult) -> None:
            results[result.label] = result
            show_done(result)

        with contextlib.suppress(KeyboardInterrupt):
            run(cases, settings, workers, done)
    finished = [results[case.label] for case in cases if case.label in results]
    unfinished = [case.label for case in cases if case.label not in results]
    return make_record(settings, finished, time.perf_counter() - start, unfinished, build())


def verdict(record: Record) -> Exit:
    """What the run comes to: a disagreement weighs more than a model that could not be read."""
    if record.rows("disagree") or any(row.quantity not in ("load", "compile") for row in record.rows("failed")):
        return Exit.DISAGREE
    if record.unfinished:
        return Exit.INTERRUPTED
    return Exit.AGREE if record.ok else Exit.BAD_INPUT


questions.register(app, ACCURACY)
questions.register(app, DIAGRAMS)
campaign.register(app)
dashboard.register(app)
exports_report.register(app)
fuzz_report.register(app)
mutation_report.register(app)
oracle.register(app)
pareto.register(app)
passes.register(app)
stability.register(app)
timing.register(app)
simulation_report.register(app)
rollouts_report.register(app)
realtime_report.register(app)

if __name__ == "__main__":
    app()
