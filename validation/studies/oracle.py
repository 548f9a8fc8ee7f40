"""`python -m validation oracle`: generated equations against SymPy's, digit by digit."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.progress import Progress
from rich.table import Table
from rich.text import Text

from symofros.atomic import write_atomically
from validation.reporting.console import output
from validation.reporting.provenance import stamp, versions

if TYPE_CHECKING:
    from validation.oracle.compare import Agreement


def register(app: typer.Typer) -> None:
    """Add the command to the command line."""
    app.command("oracle")(command)


def command(
    chosen: Annotated[list[str] | None, typer.Option("--model", help="Only this model; repeatable.")] = None,
    points: Annotated[int, typer.Option(min=1, help="Rational points a model.")] = 2,
    seed: Annotated[int, typer.Option(min=0, help="Of the points.")] = 0,
    report: Annotated[Path, typer.Option(help="Folder for oracle.json, unless models are chosen.")] = Path("reports"),
    as_json: Annotated[bool, typer.Option("--json", help="Print the digits as JSON, nothing else.")] = False,
) -> None:
    """Compare with SymPy's derivations by Lagrange and by Kane, in extended precision.

    Exit code: 0 all agree, 1 something does not, 2 bad input.
    """
    # SymPy's mechanics cost a second to import; only this command pays.
    from validation.oracle.compare import check
    from validation.oracle.models import MODELS

    for name in chosen or ():
        if name not in MODELS:
            raise typer.BadParameter(f"no model '{name}'; there are {', '.join(MODELS)}", param_hint="--model")
    wanted = [(name, by) for name in chosen or MODELS for by in MODELS[name].derivations]
    console, results = Console(stderr=True), []
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("deriving", total=len(wanted))
        for name, by in wanted:
            results.append(check(name, by, points, seed))
            bar.update(task, advance=1)
    ok = all(result.ok for result in results)
    data = {
        "ok": ok,
        "points": points,
        "seed": seed,
        "comparisons": [asdict(result) for result in results],
        "versions": {**versions(), "sympy": metadata.version("sympy")},
        **stamp(),
    }
    if not chosen:
        report.mkdir(parents=True, exist_ok=True)
        write_atomically(report / "oracle.json", json.dumps(data, indent=1, allow_nan=False) + "\n")
    if as_json:
        typer.echo(json.dumps(data, allow_nan=False))
    else:
        _show(results, output())
    raise typer.Exit(0 if ok else 1)


def _show(results: Sequence[Agreement], console: Console) -> None:
    """The table, and what it comes to."""
    title = "Decimal digits that agree at the worst of the points, relative to the largest entry"
    table = Table(title=title, title_justify="left", box=SIMPLE_HEAD, padding=(0, 2, 0, 0), pad_edge=False)
    for column in ("model", "by"):
        table.add_column(column, no_wrap=True)
    for function in (*results[0].digits, "required"):
        table.add_column(function.replace("_", " "), justify="right")
    for row in results:
        cells = [Text(f"{x:.0f}", style="" if x >= row.required else "bold red") for x in row.digits.values()]
        table.add_row(row.model, row.derivation, *cells, f"{row.required:.0f}")
    console.print(table)
    failed = [f"{row.model} ({row.derivation})" for row in results if not row.ok]
    verdict = f"do not agree: {', '.join(failed)}" if failed else "all agree"
    console.print(
        Text(
            f"{len(results)} derivations of {len({row.model for row in results})} models; {verdict}.",
            style="bold red" if failed else "bold green",
        )
    )
