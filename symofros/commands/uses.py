"""symofros advise, symofros export, symofros edit: what else is done with a model."""

from __future__ import annotations

import json
from functools import partial
from pathlib import Path
from typing import Annotated, Any, cast

import typer

import symofros as sf
from symofros.commands.reading import ReadingOptions, reads_models
from symofros.commands.shared import (
    NOT_FOR_DIAGRAMS,
    AsJson,
    FilePath,
    ModelPath,
    assignments,
    load,
    names_of,
    number,
    refuse,
)
from symofros.commands.terminal import out
from symofros.description import YAML_SUFFIXES
from symofros.diagrams.files.kind import is_diagram
from symofros.exports.exporting import TARGETS
from symofros.studio.advice.report import table_of


@reads_models
def advise(
    model: ModelPath,
    scene: Annotated[Path, typer.Option(help="The scene, a YAML file (docs/advise.md).", show_default=False)],
    *,
    reading: ReadingOptions,
    tolerance: Annotated[
        list[str], typer.Option(help="NUMBER for every output, or OUTPUT=NUMBER; in place of the scene's.")
    ] = [],  # noqa: B006
    output: Annotated[Path | None, typer.Option("--output", "-o", help="Write the reduced model: .yaml.")] = None,
    as_json: AsJson = False,
) -> None:
    """Find the cheapest model that keeps a scene's tolerance, each choice verified by simulation."""
    system = load(model, reading)
    try:
        advice = sf.advise(system, sf.load_scene(scene), _tolerances(tolerance))
        if output:
            advice.write(output)
    except sf.SymofrosError as error:
        raise refuse(error) from None
    if as_json:
        print(json.dumps(advice.to_json(), indent=1))
    else:
        out.print(table_of(advice))
        if output:
            out.print(f"wrote {output}", markup=False)
    if not advice.ok:
        raise typer.Exit(1)


def _tolerances(given: list[str]) -> float | dict[str, float] | None:
    """Tolerances stated by --tolerance: one number, or numbers by name; None if there are none."""
    if len(given) == 1 and "=" not in given[0]:
        return number("--tolerance", given[0])
    return {name: number(name, text) for name, text in assignments(given, "--tolerance").items()} or None


@reads_models
def export_command(
    model: FilePath,
    target: Annotated[str, typer.Option("--target", "-t", help=", ".join(TARGETS))],
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder: new, empty, or of an earlier export.")],
    *,
    reading: ReadingOptions,
    name: Annotated[str | None, typer.Option(help="Of files and functions; made of the model's by default.")] = None,
    frames: Annotated[str | None, typer.Option(help="Frames of kinematics, comma-separated; all by default.")] = None,
    functions: Annotated[
        str | None,
        typer.Option(help="Further functions of WebAssembly; those of a C package, in place of all; comma-separated."),
    ] = None,
    outputs: Annotated[
        str | None, typer.Option(help="Frames whose positions an FMU gives, or signals of a diagram; comma-separated.")
    ] = None,
    given: Annotated[list[str], typer.Option("--set", help="NAME=NUMBER: a first coordinate or speed (dNAME).")] = [],  # noqa: B006
    method: Annotated[
        str | None, typer.Option(help="How it steps by itself; rk4, or what a diagram states, by default.")
    ] = None,
    dt: Annotated[float | None, typer.Option(help="Step [s]; 1e-3, or what a diagram states, by default.")] = None,
    as_json: AsJson = False,
) -> None:
    """Write a model for C, Matlab, Octave, Simulink, FMI, WebAssembly, or as URDF or MJCF; a diagram as a C program."""
    start = {key: number(key, text) for key, text in assignments(given, "--set").items()}
    try:
        if is_diagram(model):
            reading.require_none(NOT_FOR_DIAGRAMS)
        described = sf.load_diagram(model) if is_diagram(model) else load(model, reading)
        done = sf.export(
            described,
            cast(Any, target),
            output,
            name=name,
            frames=names_of(frames),
            functions=names_of(functions) or (),
            outputs=names_of(outputs),
            start=start,
            method=method,
            dt=dt,
        )
    except sf.SymofrosError as error:
        raise refuse(error) from None
    if as_json:
        print(
            json.dumps(
                {
                    "target": done.target,
                    "name": done.name,
                    "files": [str(file) for file in done.files],
                    "notes": list(done.notes),
                },
                indent=1,
            )
        )
        return
    for file in done.files:
        out.print(f"wrote {file}", markup=False, highlight=False, soft_wrap=True)
    for note in done.notes:
        out.print(f"note: {note}", markup=False, highlight=False, soft_wrap=True)


@reads_models
def edit(
    model: Annotated[Path | None, typer.Argument(help="A model; a new one if not given.")] = None,
    *,
    reading: ReadingOptions,
    port: Annotated[int, typer.Option(help="Of the local page; any free one by default.")] = 0,
    browser: Annotated[bool, typer.Option("--browser/--no-browser", help="Open the page.")] = True,
    token: Annotated[str | None, typer.Option(help="A fixed one, for tests; drawn at random by default.")] = None,
) -> None:
    """Draw, edit, check, compile and simulate a model in the browser."""
    try:
        from symofros.studio.editor.command import serve  # The editor's server is an extra.
    except ModuleNotFoundError as error:
        if error.name not in ("starlette", "uvicorn", "anyio"):
            raise
        missing = f"no module {error.name}", "the editor is an extra", "gui"
        raise refuse(sf.SymofrosError.of_extra("edit: a package is not installed", *missing)) from None
    try:
        if model is None or model.suffix.lower() in YAML_SUFFIXES:
            reading.require_none("a native file is opened as it stands")
        show = partial(out.print, markup=False, highlight=False, soft_wrap=True)
        serve(model, port, token, browser, show, reading.keywords)
    except (sf.SymofrosError, OSError) as error:
        raise refuse(error) from None
