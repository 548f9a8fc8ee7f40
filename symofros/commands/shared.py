"""What all commands share: how they read and refuse their input.

A command that finds all it was asked for in the cache imports this: NumPy and Rich are loaded by those that need them.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import symofros as sf
from symofros.base.stored import NO_ROOM
from symofros.commands.reading import ReadingOptions, pairs

if TYPE_CHECKING:
    from symofros.description import System

ModelPath = Annotated[Path, typer.Argument(help="A model: .yaml, .urdf, .sdf, .xml (MJCF) or .usd", show_default=False)]
FilePath = Annotated[Path, typer.Argument(help="A model, or a diagram's .yaml.", show_default=False)]
Network = Annotated[bool, typer.Option("--network", help="Let a diagram's blocks reach other machines.")]
AllowNative = Annotated[
    bool, typer.Option("--allow-native", help="Let a diagram's blocks run native code of files: imported FMUs.")
]
AsJson = Annotated[bool, typer.Option("--json", help="Machine-readable output.")]
BAD_INPUT = 2
# Why options of reading are refused.
NOT_FOR_DIAGRAMS = "the file is a diagram, which states how its models are read"


def load(path: Path, reading: ReadingOptions) -> System:
    """Read a model; problems are reported, all at once, and end the command."""
    with refusing_descriptions(path):
        return sf.load(path, **reading.keywords)


@contextmanager
def refusing_descriptions(path: Path) -> Iterator[None]:
    """Problems of a description that is read here are reported, all at once, and end the command."""
    try:
        yield
    except sf.DescriptionError as error:
        count = len(error.problems)
        _complain(error.in_shell(), f"{path.name}: {count} problem{'s' * (count > 1)}")
        raise typer.Exit(BAD_INPUT) from None


def refuse(error: Exception) -> typer.Exit:
    """Report an error in the input and return the exit to raise."""
    if isinstance(error, OSError) and (error.filename is not None or error.errno in NO_ROOM):
        what = f"'{error.filename}' can't be used" if error.filename is not None else "a file can't be written"
        rule, remedy = "files and folders are there, and open to whoever runs this", "check the path, and its rights"
        if error.errno in NO_ROOM:
            rule, remedy = "there is room for what is written", "make room, write elsewhere, or raise `ulimit -f`"
        error = sf.SymofrosError(what, error.strerror or str(error), rule, remedy)
    _complain(error.in_shell() if isinstance(error, sf.SymofrosError) else str(error))
    return typer.Exit(BAD_INPUT)


def _complain(*lines: str) -> None:
    from symofros.commands.terminal import err  # Rich takes as long as a warm start: only what needs it loads it.

    for line in lines:
        err.print(line, markup=False, highlight=False, soft_wrap=True)


def assignments(given: list[str], what: str) -> dict[str, str]:
    """NAME=TEXT options as a mapping."""
    try:
        return pairs(given, what, "q1=0.5")
    except sf.SymofrosError as error:
        raise refuse(error) from None


def number(name: str, text: str) -> float:
    """A number; anything else is reported, and ends the command."""
    try:
        return float(text)
    except ValueError:
        fault = sf.Problem(f"'{name}' is given no number", f"'{text}'", "its value is a number", f"write {name}=0.5")
        raise refuse(sf.SymofrosError(fault)) from None


def numbers(name: str, text: str) -> float | list[float]:
    """One number, or some between commas."""
    parts = text.strip("[]").split(",")
    return number(name, parts[0]) if len(parts) == 1 else [number(name, part) for part in parts]


def entries_of(text: str) -> str | list[str]:
    """One formula, or some between commas that no parentheses enclose."""
    parts = re.split(r",(?![^(]*\))", text.strip("[]"))
    return parts[0] if len(parts) == 1 else parts


def shown(value: float) -> str:
    """A number in a table: six digits, and no sign before zero."""
    return f"{value + 0.0:.6g}"


def names_of(text: str | None) -> list[str] | None:
    """Names between commas."""
    return None if text is None else [name for name in text.split(",") if name]
