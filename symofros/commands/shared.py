"""What all commands share: where they write, how they read and refuse their input."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import Console

import symofros as sf
from symofros.description.system import System
from symofros.errors import did_you_mean
from symofros.runtime.calls.kernel import Array

out = Console()
err = Console(stderr=True)

ModelPath = Annotated[Path, typer.Argument(help="A model: .yaml, .urdf, .sdf, .xml (MJCF) or .usd", show_default=False)]
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
    if isinstance(error, OSError) and error.filename is not None:
        what, rule = f"'{error.filename}' can't be used", "files and folders are there, and open to whoever runs this"
        error = sf.SymofrosError(sf.Problem(what, error.strerror or str(error), rule, "check the path, and its rights"))
    err.print(str(error), markup=False, highlight=False, soft_wrap=True)
    return typer.Exit(BAD_INPUT)


def assignments(given: list[str], what: str) -> dict[str, str]:
    """NAME=TEXT options as a mapping."""
    assigned = {}
    for item in given:
        name, sign, text = item.partition("=")
        if not sign or not name or not text:
            fault = sf.Problem(f"{what} '{item}'", "no name and value", f"{what} NAME=VALUE", "for example q1=0.5")
            raise refuse(sf.SymofrosError(fault))
        assigned[name.strip()] = text.strip()
    return assigned


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


def stated_state(model: sf.Model, given: Mapping[str, str]) -> tuple[sf.Model, Array, Array]:
    """The model at its stated run-time parameters, and the neutral state (nq), (nv) with what is stated of it.

    A name of a coordinate or a speed comes before that of a parameter; another one is reported, and ends the command.
    """
    stated = {name: number(name, text) for name, text in given.items()}
    states = (*model.names.q, *model.names.v)
    parameters = {name: value for name, value in stated.items() if name in model.names.par and name not in states}
    model = model.with_parameters(**parameters)
    q, v = model.neutral(), np.zeros(model.nv)
    for name in stated.keys() - parameters.keys():
        if name in model.names.q:
            q[model.names.q.index(name)] = stated[name]
        elif name.removeprefix("d") in model.names.v:
            v[model.names.v.index(name.removeprefix("d"))] = stated[name]
        elif name in model.names.v:
            v[model.names.v.index(name)] = stated[name]
        else:
            known = (*model.names.q, *(f"d{speed}" for speed in model.names.v), *model.names.par)
            missing = f"--set: no coordinate, speed or run-time parameter '{name}'"
            listed = ", ".join(known[:12]) + (", …" if len(known) > 12 else "")
            rule = "--set gives first coordinates, speeds (dNAME) and run-time parameters"
            raise refuse(sf.UnknownNameError(sf.Problem(missing, listed, rule, did_you_mean(name, known))))
    return model, q, v


def shown(value: float) -> str:
    """A number in a table: six digits, and no sign before zero."""
    return f"{value + 0.0:.6g}"


def names_of(text: str | None) -> list[str] | None:
    """Names between commas."""
    return None if text is None else [name for name in text.split(",") if name]
