"""`python -m validation diff FILE --as ENGINE`: what an engine's own reader makes of a file, beside what ours does."""

from __future__ import annotations

import json
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer

import symofros as sf
from symofros.commands.grammar import BAD_INPUT

from .. import adapters

# Engine -> suffixes of the files that it reads by itself.
READERS = {"pinocchio": (".urdf", ".xml"), "mujoco": (".urdf", ".xml")}
# Engine -> tolerance. MuJoCo writes what it read with six digits, and inertias along axes of as many.
TOLERANCES = {"pinocchio": 1e-9, "mujoco": 3e-5}


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("diff")(diff)


def diff(
    file: Annotated[Path, typer.Argument(help="A model: .urdf or .xml (MJCF).", show_default=False)],
    engine: Annotated[str, typer.Option("--as", help=f"Engine: {', '.join(READERS)}.", show_default=False)],
    floating_base: Annotated[bool, typer.Option("--floating-base", help="Put the root onto a free joint.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Machine-readable output.")] = False,
) -> None:
    """Compare what an engine's own reader makes of a file with what ours does, as `symofros diff` compares files.

    Exit code: 0 the same mechanism; 1 another one; 2 bad input.
    """
    try:
        found = as_read(file, engine, floating_base)
    except sf.SymofrosError as error:
        typer.echo(str(error), err=True)
        raise typer.Exit(BAD_INPUT) from None
    stated = {"ok": found.same, "comparisons": [found.to_json()]}
    typer.echo(json.dumps(stated, indent=1) if as_json else str(found))
    raise typer.Exit(0 if found.same else 1)


def as_read(file: Path, engine: str, floating_base: bool = False) -> sf.MechanismDiff:
    """The comparison of a file as we read it with what an engine makes of it; MuJoCo couples joints that mimic.

    Raises:
        SymofrosError: There is no such engine, or it or we refuse the file.
    """
    if engine not in READERS or file.suffix.lower() not in READERS[engine]:
        rule = "; ".join(f"{name} reads {', '.join(suffixes)}" for name, suffixes in READERS.items())
        what = f"no reader of {file.suffix or file.name} as '{engine}'"
        raise sf.SymofrosError(what, engine, rule, "name one of these engines")
    ours = _ours(file, floating_base, engine == "mujoco" and file.suffix.lower() == ".urdf")
    module = import_module(f"{adapters.__name__}.{engine}.as_read")
    try:
        theirs: sf.System = module.description(file, floating_base)
    except (ValueError, RuntimeError) as error:
        rule, remedy = "what an engine refuses can't be compared", "compare it as another engine"
        raise sf.SymofrosError(f"{file.name}: {engine} refuses it", str(error), rule, remedy) from None
    return sf.diff(ours, theirs, tolerance=TOLERANCES[engine])


def _ours(file: Path, floating_base: bool, mimic: bool) -> sf.System:
    """The file as we read it; joints that can't mimic as the file says are independent."""
    asked: dict[str, Any] = {"floating_base": floating_base, "dissipation": "all", "waive": ("massless_tip",)}
    if not mimic:
        return sf.load(file, **asked)
    try:
        return sf.load(file, **asked, mimic=True)
    except sf.DescriptionError:
        return sf.load(file, **asked)
