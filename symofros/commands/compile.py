"""symofros compile: a model's C, compiled and kept in the cache, or written to files."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Annotated, Any

import typer

from symofros.base.functions import DEFAULT_FUNCTIONS
from symofros.commands.reading import ReadingOptions, reads_models
from symofros.commands.shared import AsJson, ModelPath
from symofros.errors import SymofrosError
from symofros.runtime.build import find_toolchain, recall_prepared


@reads_models
def compile_command(
    model: ModelPath,
    *,
    reading: ReadingOptions,
    output: Annotated[
        Path | None, typer.Option("--output", "-o", help="Also write NAME.c and symofros_model.h to this folder.")
    ] = None,
    functions: Annotated[
        str,
        typer.Option(
            help="Functions of one library, comma-separated, as Options(functions=...) has them. By default all of"
            " first order without reverse mode, each in a library of its own, as a model calls them in Python."
        ),
    ] = "",
    frames: Annotated[str, typer.Option(help="Frames of frame functions, comma-separated; all by default.")] = "",
    as_json: AsJson = False,
) -> None:
    """Generate and compile a model; it is then in the cache."""
    names = tuple(functions.split(",")) if functions else DEFAULT_FUNCTIONS
    request = repr((reading, functions, frames))
    start = time.perf_counter()
    name = _known_name(model, request) if output is None else None
    result: dict[str, Any] = {
        "name": name,
        "functions": names,
        "seconds": time.perf_counter() - start,
        "compiled": True,
    }
    if name is None:
        from symofros.commands.compilation import compile_description  # The generator takes longer than all above.

        chosen = names if functions or frames else None
        result |= compile_description(model, reading, chosen, frames, request, output)
    if as_json:
        print(json.dumps(result, indent=1))
        return
    done = "and compiled, or found in the cache" if result["compiled"] else "and not compiled, as no compiler was found"
    functions_made = f"{len(names)} function{'s' * (len(names) != 1)} generated"
    typer.echo(f"{result['name']}: {functions_made} {done}, in {result['seconds']:.2f} s")
    if output is not None:
        typer.echo(f"{result['operations']} operations, {result['bytes'] / 1024:.0f} KiB of C")
    for file in result.get("files", ()):
        typer.echo(f"wrote {file}")


def _known_name(model: Path, request: str) -> str | None:
    """Name of the system of a description whose libraries are all in the cache; None where that is not known."""
    try:
        toolchain = find_toolchain()
        known = recall_prepared(model, request, toolchain) if toolchain is not None else None
    except SymofrosError:  # It is reported where the compiler is needed, after what is wrong with the description.
        return None
    return None if known is None else known.name
