"""Lines of shell on pages: those that are cheap run, the others are held against the command line's own parser."""

from __future__ import annotations

import re
import shlex
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import typer
from typer.testing import CliRunner

from symofros.__main__ import app as symofros
from tests.docs.pages import Block
from tests.late import with_utilities
from validation.__main__ import app as validation

# Commands of symofros that are cheap, unless an option asks for more.
CHEAP = {"--version", "cache", "compile", "equilibrium", "export", "info", "simulate"}
COSTLY = re.compile(r"--view|window|fmu|wasm|--record|--realtime|square\.yaml|--method|\.parquet|diagram\.yaml")
# Other programs: run, or left to others for a reason.
RUN = {"cp", "mkdir"}
LEFT = {
    "pip": "installs packages",
    "python3": "makes an environment",
    ".": "enters an environment",
    "pytest": "tests/validation/ci/test_plugin.py tries these options in another project",
    "cd": "the editor's page is built with Node by a test of tests/studio",
    "npm": "the editor's page is built with Node by a test of tests/studio",
    "gcc": "tests/exports/c builds and runs exported packages",
    "ctest": "tests/exports/c builds and runs exported packages",
    "example": "tests/exports/c builds and runs exported packages",
    **dict.fromkeys(("compensate", "controller", "plant", "whole"), "tests/docs/test_pages.py builds and runs it"),
    "node": "tests/exports/wasm runs exported modules",
    "chromium": "tests/exports/wasm opens exported pages",
    "nvcc": "tests/exports/cuda runs the example with kernels as C++",
    "sphinx": "tests/docs/test_site.py builds the site",
    "cmake": "tests/exports/c builds and runs exported packages",
}
HARNESS = ("python", "-m", "validation")


def commands(block: Block) -> list[str]:
    """The commands of a block, without comments."""
    lines = [line.partition("  #")[0].strip() for line in block.text.splitlines() if not line.startswith("#")]
    return [part.strip() for line in lines for part in line.split(" && ") if part.strip()]


def try_out(command: str, folder: Path) -> None:
    """Run a command in a folder, or see that its words are understood."""
    words = shlex.split(command)
    words[0] = words[0].rpartition("/")[2]
    if words[0] == "symofros" and words[1] in CHEAP and not COSTLY.search(command):
        result = CliRunner().invoke(symofros, words[1:])
        assert result.exit_code == 0, f"{command}\n{result.output}\n{result.exception}"
    elif words[0] == "symofros" and words[1] not in ("check", "validation"):
        understood(symofros, words[1:])
    elif words[0] == "symofros" or tuple(words[:3]) == HARNESS:
        understood(validation, words[1:] if words[1] == "check" else words[2:] if words[0] == "symofros" else words[3:])
    elif words[0] in RUN:
        subprocess.run(command, shell=True, cwd=folder, check=True, env=with_utilities())
    else:
        program = words[2] if words[:2] == ["python", "-m"] else words[0]
        assert program in LEFT, f"'{command}': run it, or say in LEFT why not"


def understood(app: typer.Typer, words: Sequence[str]) -> None:
    """Let a program parse its words, without doing what they say."""
    command: Any = typer.main.get_command(app)
    context = typer.Context(command, info_name="program")
    rest = list(words)
    while hasattr(command, "get_command"):
        name = rest.pop(0) if rest and not rest[0].startswith("-") else "check"
        command = command.get_command(context, name)
        assert command is not None, f"there is no command '{name}'"
        context = typer.Context(command, info_name=name, parent=context)
    command.make_context(command.name, rest)
