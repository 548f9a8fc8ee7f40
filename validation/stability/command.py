"""`python -m validation stability`: where simulations fail, as maps with verdicts."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import Progress
from rich.table import Table

import symofros as sf
from validation.stability.catalogue import SCENES
from validation.stability.report import Atlas, Page, as_data, write_report
from validation.stability.scene import Scene, survey


def register(app: typer.Typer) -> None:
    """Add the command to the command line."""
    app.command("stability")(stability)


def stability(
    chosen: Annotated[list[str] | None, typer.Option("--scene", help=f"Only this; of {', '.join(SCENES)}.")] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Coarse grids.")] = False,
    report: Annotated[
        Path, typer.Option(help="Folder for stability.html, .md, .json; with --scene, of its folder stability.")
    ] = Path("reports"),
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON, nothing else.")] = False,
) -> None:
    """Map where simulations fail, against closed forms and other engines.

    Exit code: 0 every claim is within its bounds, 1 one is not, 2 bad input, 130 interrupted.
    """
    for name in chosen or ():
        if name not in SCENES:
            raise typer.BadParameter(f"no scene '{name}'; there are {', '.join(SCENES)}", param_hint="--scene")
    atlas = drawn(chosen or list(SCENES), quick)
    # One scene must not overwrite the atlas of all of them.
    page = write_report(atlas, report / "stability" if chosen else report)
    if as_json:
        typer.echo(json.dumps(as_data(atlas), allow_nan=False))
    else:
        _show(atlas)
        typer.echo(f"{atlas.headline} {atlas.seconds:.0f} s. Report: {page}")
    raise typer.Exit(130 if atlas.unfinished else 0 if atlas.ok else 1)


def drawn(names: list[str], quick: bool) -> Atlas:
    """The scenes that are done; one that fails does not keep the others from being asked, Ctrl-C ends them."""
    start = time.perf_counter()
    pages: dict[str, Page] = {}
    failures: dict[str, str] = {}
    unfinished: tuple[str, ...] = ()
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("stability", total=sum(SCENES[name].runs(quick) for name in names))
        for position, name in enumerate(names):
            bar.update(task, description=name)
            try:
                pages[name] = draw(SCENES[name], quick, lambda: bar.update(task, advance=1))
            except (sf.SymofrosError, ArithmeticError, ValueError) as error:
                failures[name] = f"{type(error).__name__}: {error}"
            except KeyboardInterrupt:
                unfinished = tuple(names[position:])
                break
    return Atlas(pages, failures, quick, unfinished, time.perf_counter() - start)


def draw(scene: Scene, quick: bool, done: Callable[[], None] = lambda: None) -> Page:
    """Run one scene and judge it."""
    start = time.perf_counter()
    maps = survey(scene, quick, done)
    verdict = scene.judge(maps)
    return Page(scene, maps, verdict, time.perf_counter() - start)


def _show(atlas: Atlas) -> None:
    table = Table("scene", "claim", "found", "bounds", "")
    for name, page in atlas.pages.items():
        for check in page.verdict.checks:
            bounds = f"{check.low:.6g} … {check.high:.6g}"
            verdict = "[green]ok[/]" if check.ok else "[bold red]missed[/]"
            table.add_row(name, check.what, f"{check.found:.6g}", bounds, verdict)
    for name, reason in atlas.failures.items():
        table.add_row(name, reason, "", "", "[bold red]failed[/]")
    Console().print(table)
