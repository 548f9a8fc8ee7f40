"""`python -m validation campaign run | resume | show`."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer

from symofros.commands.grammar import program

from ..inputs.cases import standard_set
from ..program import PROGRAM
from ..reporting.command import AsJson, Exit, code, write
from ..reporting.terminal import show as show_report
from .errors import PlanError, Unfinished
from .plan import make, read
from .report import TOPIC

STATES = 100_000

app = program(no_args_is_help=True, help="Long campaigns: checkpointed, resumable, over processes or a cluster.")

Workers = Annotated[int, typer.Option(min=1, max=256, help="Processes of this machine.")]
Scheduler = Annotated[str, typer.Option(help="Address of a dask scheduler, tcp://host:port; none: this machine.")]
Dashboard = Annotated[
    int | None, typer.Option(min=0, max=65535, help="Port on 127.0.0.1 for dask's pages; none by default.")
]
Report = Annotated[
    Path | None, typer.Option("--report", help="Also write campaign.md and campaign.json into this folder.")
]


@app.command("run")
def run_command(
    plan: Annotated[Path | None, typer.Argument(help="A plan (TOML); see docs/campaigns.md.")] = None,
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder of this campaign.")] = Path("campaign"),
    models: Annotated[
        str | None, typer.Option(help="Instead of a plan: models, by commas; all: the standard set.")
    ] = None,
    states: Annotated[int, typer.Option(min=1, help="With --models: states in all.")] = STATES,
    batch: Annotated[int, typer.Option(min=1, help="With --models: states a batch.")] = 500,
    seed: Annotated[int, typer.Option(min=0, help="With --models: of the states.")] = 0,
    engines: Annotated[str | None, typer.Option(help="With --models: engines, by commas; none: all.")] = None,
    workers: Workers = 2,
    scheduler: Scheduler = "",
    dashboard: Dashboard = None,
    report: Report = None,
    as_json: AsJson = False,
) -> None:
    """Begin a campaign, or go on with the same one.

    Exit code: 0 all agree, 1 something disagrees or failed, 2 bad input, 130 interrupted.
    """
    if (plan is None) == (models is None):
        raise typer.BadParameter("give a plan, or --models", param_hint="PLAN")
    with _refusing():
        if plan is not None:
            asked = read(plan)
        else:
            names = [case.label for case in standard_set()] if models == "all" else (models or "").split(",")
            given = {"kind": "check", "models": names, "states": states, "batch": batch, "seed": seed}
            asked = make(given | ({"engines": engines.split(",")} if engines else {}), "the command line")
        from .runner import Pool  # dask is an extra.
        from .session import begin  # As the runner: dask is an extra.

        _tell(begin(asked, output, Pool(workers, scheduler, dashboard)), output, report, as_json)


@app.command()
def resume(
    folder: Annotated[Path, typer.Argument(help="Of the campaign.")],
    workers: Workers = 2,
    scheduler: Scheduler = "",
    dashboard: Dashboard = None,
    report: Report = None,
    as_json: AsJson = False,
) -> None:
    """Go on with a campaign: only the batches that are not finished are done."""
    with _refusing():
        from .runner import Pool  # dask is an extra.
        from .session import continue_campaign  # As the runner: dask is an extra.

        _tell(continue_campaign(folder, Pool(workers, scheduler, dashboard)), folder, report, as_json)


@app.command()
def show(folder: Annotated[Path, typer.Argument(help="Of the campaign.")], as_json: AsJson = False) -> None:
    """Say what a campaign found, or how far it is."""
    with _refusing():
        from .session import standing  # As the runner: dask is an extra.

        data = standing(folder)
        if "finished" not in data:
            _tell(data, folder, None, as_json)
        elif as_json:
            typer.echo(json.dumps(data))
        else:
            share = f"{data['finished']} of {data['size']} done, {data['batches']} of {data['of']} batches"
            typer.echo(f"{share}; to go on: {PROGRAM} campaign resume {folder}")


def _tell(data: dict[str, Any], folder: Path, report: Path | None, as_json: bool) -> None:
    """Write the summary beside the results, and where else it is wanted, and print it."""
    for place in filter(None, (folder, report)):
        made = write(TOPIC, data, place)
    if as_json:
        typer.echo(json.dumps(data, allow_nan=False))
    else:
        show_report(made)
    raise typer.Exit(code(made))


@contextmanager
def _refusing() -> Iterator[None]:
    """Bad input, and work that is left, end in words.

    Arrow and dask load inside, when a campaign is asked for: together they take a second, and they are an extra.
    """
    try:
        yield
    except (PlanError, OSError, TimeoutError) as error:
        typer.echo(f"campaign: {error}", err=True)
        raise typer.Exit(Exit.BAD_INPUT) from None
    except ImportError as error:
        typer.echo(f"campaign: {error}; pip install 'symofros[campaign]'", err=True)
        raise typer.Exit(Exit.BAD_INPUT) from None
    except Unfinished as error:
        typer.echo(str(error), err=True)
        raise typer.Exit(Exit.INTERRUPTED if error.interrupted else Exit.MISSED) from None


def register(parent: typer.Typer) -> None:
    """Add the commands to the command line."""
    parent.add_typer(app, name="campaign")
