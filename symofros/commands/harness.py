"""symofros check, symofros validation: the harness, from anywhere, in an interpreter of its own."""

from __future__ import annotations

import subprocess
from collections.abc import Sequence

import typer

from symofros.harness import command_line


def check(context: typer.Context) -> None:
    """Cross-check models against independent engines; `symofros check --help` for its options."""
    raise typer.Exit(_run(["check", *context.args]))


def validation(context: typer.Context) -> None:
    """The harness: check, accuracy, timing, ...; `symofros validation --help` lists its commands."""
    raise typer.Exit(_run(context.args))


def _run(arguments: Sequence[str]) -> int:
    """The harness with these arguments; its exit code."""
    process = subprocess.Popen(command_line(arguments))
    while True:
        try:
            return process.wait()
        except KeyboardInterrupt:  # The harness has had it, too: it reports what was finished, then it ends.
            continue
