"""`python -m validation pareto`: speed against accuracy, as charts with verdicts."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

import symofros as sf
from validation.pareto import words
from validation.pareto.catalogue import SCENES
from validation.pareto.race import race
from validation.pareto.report import Comparison, as_data, now, read, write_report


def register(app: typer.Typer) -> None:
    """Add the command to the command line."""
    app.command("pareto")(pareto)


def pareto(
    chosen: Annotated[list[str] | None, typer.Option("--scene", help=f"Only this; of {', '.join(SCENES)}.")] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Few contestants; report in pareto_quick.")] = False,
    resume: Annotated[bool, typer.Option("--resume", help="Leave out scenes that pareto.json has.")] = False,
    report: Annotated[Path, typer.Option(help="Folder for pareto.html, .md, .json.")] = Path("reports"),
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON, nothing else.")] = False,
) -> None:
    """Compare speed at equal accuracy: our models and methods, and engines with their own integrators.

    Scenes that are not run again keep the results that pareto.json has of them.

    Exit code: 0 all targets are met, 1 one is not, 2 bad input, 130 interrupted.
    """
    for name in chosen or ():
        if name not in SCENES:
            raise typer.BadParameter(f"no scene '{name}'; there are {', '.join(SCENES)}", param_hint="--scene")
    folder = report / "pareto_quick" if quick else report
    comparison = compared(chosen or list(SCENES), quick, resume, folder)
    page = write_report(comparison, folder)
    if as_json:
        typer.echo(json.dumps(as_data(comparison), allow_nan=False))
    else:
        _show(comparison)
        typer.echo(f"{comparison.headline} Report: {page}")
    raise typer.Exit(130 if comparison.unfinished else 0 if comparison.ok else 1)


def compared(names: list[str], quick: bool, resume: bool, folder: Path) -> Comparison:
    """The scenes that are done; each is kept as soon as it is, one that fails does not keep others from running."""
    results, dates = read(folder, quick)
    failures: dict[str, str] = {}
    unfinished: tuple[str, ...] = ()
    names = [name for name in names if not (resume and name in results)]
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        for position, name in enumerate(names):
            task = bar.add_task(f"{name}: references", total=None)

            def begun(count: int, task: int = task, name: str = name) -> None:
                bar.update(task, total=count, description=name)  # type: ignore[arg-type]

            def done(task: int = task) -> None:
                bar.update(task, advance=1)  # type: ignore[arg-type]

            try:
                results[name] = race(SCENES[name], quick, begun, done)
                dates[name] = now()
                write_report(Comparison(results, failures, quick, tuple(names[position + 1 :]), dates), folder)
            except (sf.SymofrosError, ArithmeticError, ValueError, RuntimeError) as error:
                failures[name] = f"{type(error).__name__}: {error}"
            except KeyboardInterrupt:
                unfinished = tuple(names[position:])
                break
            bar.remove_task(task)
    return Comparison(results, failures, quick, unfinished, dates)


def _show(comparison: Comparison) -> None:
    table = Table("scene", "at", "against", "ours", "theirs", "ratio", "asked", "")
    for name, page in comparison.pages.items():
        for v in page.verdicts:
            verdict = "[green]met[/]" if v.ok else "[bold red]missed[/]"
            table.add_row(
                name,
                page.scene.shown(v.target.error),
                v.target.engine,
                words.duration(v.ours),
                words.duration(v.theirs),
                f"{v.found:.3g}",
                f"{v.target.ratio:g}",
                verdict,
            )
    for name, reason in comparison.failures.items():
        table.add_row(name, reason, "", "", "", "", "", "[bold red]failed[/]")
    Console().print(table)
