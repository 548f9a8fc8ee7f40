"""symofros check, symofros validation: the harness, from anywhere.

It runs in an interpreter of its own: a file `validation.py` in the folder of the call would take its package's place.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import typer

import symofros as sf


def check(context: typer.Context) -> None:
    """Cross-check models against independent engines; `symofros check --help` for its options."""
    raise typer.Exit(_run(["check", *context.args]))


def validation(context: typer.Context) -> None:
    """The harness: check, accuracy, timing, ...; `symofros validation --help` lists its commands."""
    raise typer.Exit(_run(context.args))


def _run(arguments: list[str]) -> int:
    """The harness with these arguments; its exit code."""
    root = Path(sf.__file__).parents[1]
    start = f"import sys; sys.path.insert(0, {str(root)!r}); from validation.__main__ import app; "
    start += "app(prog_name='symofros validation')"
    # -P: the folder of the call is not searched for modules.
    process = subprocess.Popen([sys.executable, "-P", "-c", start, *arguments])
    while True:
        try:
            return process.wait()
        except KeyboardInterrupt:  # The harness has had it, too: it reports what was finished, then it ends.
            continue
