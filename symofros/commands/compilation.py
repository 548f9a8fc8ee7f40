"""What `symofros compile` does where the cache does not know the description: read, generate, compile, take note."""

from __future__ import annotations

import time
from contextlib import suppress
from pathlib import Path
from typing import Any

from symofros.base.functions import DEFAULT_FUNCTIONS
from symofros.base.names import identifier
from symofros.base.options import Options
from symofros.base.stored import write_atomically
from symofros.commands.reading import ReadingOptions
from symofros.commands.shared import refuse, refusing_descriptions
from symofros.compiler import Compilation, inconsistencies
from symofros.errors import SymofrosError
from symofros.expr import collect_rarely
from symofros.loading import Source, load_with_sources
from symofros.native import native_text
from symofros.runtime.build import find_toolchain, note_prepared


def compile_description(
    model: Path,
    reading: ReadingOptions,
    functions: tuple[str, ...] | None,
    frames: str,
    request: str,
    output: Path | None,
) -> dict[str, Any]:
    """Compile a description, and write its C where that is asked for.

    Args:
        model: The description.
        reading: How the description is read.
        functions: Functions of one library; None: the default ones, each in its own.
        frames: Frames of frame functions, comma-separated; all by default.
        request: All that was asked for, as `recall_prepared` has it.
        output: Folder of C; None: none is written.

    Returns:
        What the command tells: name, seconds, whether it was compiled; of C that is written operations, bytes, files.

    Raises:
        typer.Exit: The description or the request is refused, which is said.
    """
    with refusing_descriptions(model):
        system, sources = load_with_sources(model, **reading.keywords)
    collect_rarely()
    options = Options(functions or DEFAULT_FUNCTIONS, tuple(frames.split(",")) if frames else None)
    start = time.perf_counter()
    try:
        compilation = Compilation(system, options)
        compiled = (compilation if functions else Compilation(system)).model()
        if not functions:
            compiled.prepare(*DEFAULT_FUNCTIONS)
        seconds = time.perf_counter() - start
        if not any(inconsistencies(system)):  # Warnings are repeated each time.
            _take_note(model, request, system.name, sources, compiled.libraries)
        text = compilation.source() if output is not None else ""
    except SymofrosError as error:
        raise refuse(error) from None
    result = {"name": system.name, "seconds": seconds, "compiled": bool(compiled.libraries)}
    return result if output is None else result | _write(compilation, text, output)


def _take_note(model: Path, request: str, name: str, sources: tuple[Source, ...], libraries: frozenset[Path]) -> None:
    toolchain = find_toolchain()
    # Of the fallback the user is warned each time; an interpreted model has no libraries.
    if toolchain is None or toolchain.is_fallback or not sources or not libraries:
        return
    with suppress(OSError):  # A cache that is only read.
        note_prepared(model, request, toolchain, name, sources, libraries)


def _write(compilation: Compilation, text: str, output: Path) -> dict[str, Any]:
    """Write NAME.c and its header."""
    output.mkdir(parents=True, exist_ok=True)
    files = [output / f"{identifier(compilation.system.name)}.c", output / "symofros_model.h"]
    for file, content in zip(files, (text, native_text("model/symofros_model.h")), strict=True):
        write_atomically(file, content)
    operations = sum(count.total for key, count in compilation.operations.items() if key[0] != "init")
    return {"operations": operations, "bytes": len(text), "files": list(map(str, files))}
