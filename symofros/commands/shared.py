"""What all commands share: where they write, how they read and refuse their input."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

import symofros as sf
from symofros.description.system import System

out = Console()
err = Console(stderr=True)

ModelPath = Annotated[Path, typer.Argument(help="A model: .yaml, .urdf or .xml (MJCF)", show_default=False)]
FilePath = Annotated[Path, typer.Argument(help="A model, or a diagram's .yaml.", show_default=False)]
Network = Annotated[bool, typer.Option("--network", help="Let a diagram's blocks reach other machines.")]
Floating = Annotated[bool, typer.Option("--floating-base", help="Put a free joint under a URDF's root link.")]
AsJson = Annotated[bool, typer.Option("--json", help="Machine-readable output.")]
BAD_INPUT = 2


def load(path: Path, floating_base: bool) -> System:
    """Read a model; problems are reported, all at once, and end the command."""
    try:
        return sf.load(path, floating_base=floating_base)
    except sf.DescriptionError as error:
        count = len(error.problems)
        err.print(str(error), markup=False, highlight=False, soft_wrap=True)
        err.print(f"{path.name}: {count} problem{'s' * (count > 1)}", markup=False, highlight=False, soft_wrap=True)
        raise typer.Exit(BAD_INPUT) from None


def refuse(error: Exception) -> typer.Exit:
    """Say what is wrong with the input."""
    err.print(str(error), markup=False, highlight=False, soft_wrap=True)
    return typer.Exit(BAD_INPUT)


def assignments(given: list[str], what: str) -> dict[str, str]:
    """NAME=TEXT options as a mapping."""
    assigned = {}
    for item in given:
        name, sign, text = item.partition("=")
        if not sign or not name or not text:
            err.print(f"{what} '{item}'\n  rule:   NAME=VALUE\n  remedy: for example q1=0.5", markup=False)
            raise typer.Exit(BAD_INPUT)
        assigned[name.strip()] = text.strip()
    return assigned


def number(name: str, text: str) -> float:
    """A number; anything else is reported, and ends the command."""
    try:
        return float(text)
    except ValueError:
        err.print(f"'{name}': '{text}' is not a number", markup=False)
        raise typer.Exit(BAD_INPUT) from None


def numbers(name: str, text: str) -> float | list[float]:
    """One number, or some between commas."""
    parts = text.strip("[]").split(",")
    return number(name, parts[0]) if len(parts) == 1 else [number(name, part) for part in parts]


def names_of(text: str | None) -> list[str] | None:
    """Names between commas."""
    return None if text is None else [name for name in text.split(",") if name]
