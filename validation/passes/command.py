"""`python -m validation passes`: measure, write reports/passes.md and passes.json."""

from __future__ import annotations

import json
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from symofros.atomic import write_atomically
from symofros.runtime.toolchain import DEFAULT_FLAGS, find_toolchain
from validation.passes.measure import ALL, APART, MODELS, Measured, as_data, measure
from validation.passes.switches import PASSES
from validation.reporting.page import render, versions
from validation.reporting.record import machine

_REPEATS = 101
_APART = "M, h and Q are one function with one set of kinematics; without: three functions."


def register(app: typer.Typer) -> None:
    """Add the command to the command line."""
    app.command("passes")(passes)


def passes(
    models: Annotated[list[str] | None, typer.Option("--model", help=f"Only this one: {', '.join(MODELS)}.")] = None,
    repeats: Annotated[int, typer.Option(min=3, help="Interleaved repeats.")] = _REPEATS,
    report: Annotated[Path, typer.Option(help="Folder for passes.md and passes.json.")] = Path("reports"),
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON, nothing else.")] = False,
) -> None:
    """Measure what each pass of the generator gains: the same models with one of them left out."""
    unknown = [name for name in models or () if name not in MODELS]
    if unknown:
        raise typer.BadParameter(f"no model '{unknown[0]}'; there are {', '.join(MODELS)}", param_hint="--model")
    rows: list[Measured] = []
    columns = (SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("")
        for label in models or MODELS:
            bar.update(task, description=label)
            rows += measure(label, repeats, lambda words: bar.update(task, description=words))
    page = write_report(rows, report)
    typer.echo(json.dumps(as_data(rows)) if as_json else page.read_text(encoding="utf-8").partition("\n## Machine")[0])


def write_report(rows: Sequence[Measured], folder: Path) -> Path:
    """Write passes.md and passes.json.

    Raises:
        OSError: The folder can't be written to.
    """
    folder.mkdir(parents=True, exist_ok=True)
    toolchain = find_toolchain()
    facts = {
        **machine(),
        "versions": versions(),
        "compiler": toolchain.identity if toolchain else "none",
        "flags": " ".join(DEFAULT_FLAGS),
        "date": time.strftime("%Y-%m-%d %H:%M UTC", time.gmtime()),
    }
    data = {"facts": facts, "rows": as_data(list(rows))}
    write_atomically(folder / "passes.json", json.dumps(data, indent=1) + "\n")
    tables = [
        table(label, [row for row in rows if row.model == label]) for label in dict.fromkeys(r.model for r in rows)
    ]
    what = {item.name: item.what for item in PASSES} | {APART: _APART}
    text = render("passes.md.j2", {}, tables=tables, what=what, facts=facts)
    write_atomically(folder / "passes.md", text)
    return folder / "passes.md"


def table(label: str, rows: Sequence[Measured]) -> dict[str, object]:
    """One model: title and rows of cells; gains are what leaving a pass out costs."""
    base = next(row for row in rows if row.without == ALL)
    cells = []
    for row in rows:
        gain = "" if row is base else f"{row.median / base.median - 1.0:+.0%}"
        more = "" if row is base else f"{row.operations / base.operations - 1.0:+.1%}"
        cells.append(
            (
                row.without,
                f"{row.operations}",
                more,
                f"{row.minimum:.0f}, {row.median:.0f}",
                gain,
                f"{row.text / 1024:.0f}",
                f"{row.compilation:.2f}",
            )
        )
    return {"title": f"{label}, {base.nv} degrees of freedom", "rows": cells}
