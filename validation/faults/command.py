"""`python -m validation faults`: list real faults of engines' releases, or reproduce some."""

from __future__ import annotations

from typing import Annotated

import typer

from ..reporting.command import Exit, known
from .entry import Fault, Side, faults, frozen
from .environment import NotAskedError, default_folder, kept, printed


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("faults")(show)


def show(
    names: Annotated[list[str] | None, typer.Argument(help="Faults to reproduce; none: list them.")] = None,
    at: Annotated[Side, typer.Option("--at", help="Which release: the wrong or the right one.")] = "wrong",
) -> None:
    """List real faults of public releases of engines, or reproduce some, each in an environment of its own.

    Exit code: 0 listed, or each answer was as recorded; 1 another answer, or a release that can't be asked; 2 bad
    input.
    """
    if not names:
        listing()
        raise typer.Exit(Exit.GOOD)
    chosen = [faults()[name] for name in known(names, faults(), "NAME", "fault")]
    raise typer.Exit(Exit.GOOD if all([reproduce(fault, at) for fault in chosen]) else Exit.MISSED)


def listing() -> None:
    """Print a line for each fault, and how many there are."""
    held = frozen()
    for fault in faults().values():
        mark = "frozen" if fault.name in held else ""
        right = fault.right or "none yet"
        typer.echo(f"{fault.name:45} {fault.engine:23} {fault.wrong:8} {right:9} {fault.kind:15} {mark}".rstrip())
    engines = {fault.engine for fault in faults().values()}
    typer.echo(f"{len(faults())} faults of {len(engines)} engines, {len(held)} frozen")


def reproduce(fault: Fault, side: Side) -> bool:
    """Ask a release, print what it answers, and say whether that is as recorded: wrong there, right here."""
    if fault.release(side) is None:
        typer.echo(f"{fault.name}: no release is right yet")
        return True
    try:
        value = printed(kept(default_folder(), fault.requirements(side)), fault.script)
    except NotAskedError as error:
        typer.echo(f"{fault.name}:\n{error}")
        return False
    is_right = fault.is_right(value)
    verdict = "right" if is_right else "wrong"
    release = f"{fault.engine} {fault.release(side)}"
    typer.echo(f"{fault.name}: {release} says {value!r}, right is {fault.expected!r}: {verdict}")
    return is_right == (side == "right")
