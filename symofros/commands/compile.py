"""symofros compile: a model's C, compiled and kept in the cache, or written to files."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Annotated, Any

import typer

import symofros as sf
from symofros.base.atomic import write_atomically
from symofros.base.functions import DEFAULT_FUNCTIONS
from symofros.commands.shared import AsJson, Floating, ModelPath, load, out, refuse
from symofros.compiler import Compilation
from symofros.generator.codegen.names import identifier
from symofros.generator.passes.count import count_program
from symofros.native import native_text


def compile_command(
    model: ModelPath,
    floating_base: Floating = False,
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
    system = load(model, floating_base)
    names = tuple(functions.split(",")) if functions else DEFAULT_FUNCTIONS
    compilation = Compilation(system, sf.Options(names, tuple(frames.split(",")) if frames else None))
    start = time.perf_counter()
    try:
        if functions or frames:
            compilation.model()
        else:
            sf.compile(system).prepare(*names)
        done = time.perf_counter()
        text = compilation.source() if output is not None else ""
    except sf.SymofrosError as error:
        raise refuse(error) from None
    result: dict[str, Any] = {"name": system.name, "functions": names, "seconds": done - start}
    if output is not None:
        output.mkdir(parents=True, exist_ok=True)
        name = identifier(system.name)
        write_atomically(output / f"{name}.c", text)
        write_atomically(output / "symofros_model.h", native_text("model/symofros_model.h"))
        counts = count_program(compilation.program)
        result["operations"] = sum(count.total for key, count in counts.items() if key[0] != "init")
        result["bytes"] = len(text)
        result["files"] = [str(output / f"{name}.c"), str(output / "symofros_model.h")]
    if as_json:
        print(json.dumps(result, indent=1))
        return
    out.print(
        f"{system.name}: {len(names)} function{'s' * (len(names) != 1)} generated and compiled, or found in the cache,"
        f" in {result['seconds']:.2f} s",
        markup=False,
    )
    if output is not None:
        out.print(f"{result['operations']} operations, {len(text) / 1024:.0f} KiB of C", markup=False)
    for file in result.get("files", ()):
        out.print(f"wrote {file}", markup=False)
