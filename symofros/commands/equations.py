"""symofros equations: a model's equations of motion to read."""

from __future__ import annotations

from typing import Annotated

import typer

import symofros as sf
from symofros.commands.reading import ReadingOptions, reads_models
from symofros.commands.shared import ModelPath, load, refuse
from symofros.commands.terminal import err


@reads_models
def equations(
    model: ModelPath,
    *,
    reading: ReadingOptions,
    latex: Annotated[bool, typer.Option("--latex", help="As LaTeX.")] = False,
    numpy: Annotated[bool, typer.Option("--numpy", help="As a Python function of NumPy arrays.")] = False,
    recursion: Annotated[
        bool, typer.Option("--recursion", help="The recursive form as LaTeX, for models of any size.")
    ] = False,
) -> None:
    """Write M, h, Q and G of a small model for people, with its own names; as text by default."""
    if latex + numpy + recursion > 1:
        err.print("equations: one form at a time\n  rule:   one of --latex, --numpy, --recursion", markup=False)
        raise typer.Exit(2)
    readable = sf.equations(load(model, reading))
    try:
        if recursion:
            text = readable.recursion()
        elif numpy:
            text = readable.numpy_source()
        else:
            text = readable.latex() if latex else readable.text()
    except sf.SymofrosError as error:
        raise refuse(error) from None
    print(text, end="")
