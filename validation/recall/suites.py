"""Any other test suite, scored as ours is: a command that is run for each release, and says what is red.

In the command, {python} stands for the interpreter of the release's environment, {engine} and {version} for its names.
What it prints is read line by line: "ok NAME" or "PASSED NAME" for what holds, "not ok NAME", "FAILED NAME" or "ERROR
NAME" for what does not (the words of the Test Anything Protocol, and those of `pytest -rA`); a number and a dash after
"ok", and what follows " - " after a name, are left out. Its exit code says nothing.
"""

from __future__ import annotations

import re
import shlex
import subprocess
from collections.abc import Iterator, Sequence
from pathlib import Path

import symofros as sf

from ..engines.causes.grouping import Group
from ..engines.verdicts import Cell
from ..faults.environment import NotAskedError, own_variables

SECONDS = 1800
_LINE = re.compile(r"^(ok|PASSED|not ok|FAILED|ERROR)\s+(?:\d+\s+)?(?:- )?(.+?)(?: - .*)?$")
_HOLDS = ("ok", "PASSED")


def asked(command: str, python: Path, engine: str, version: str) -> list[Cell]:
    """What a suite says of a release: a cell for each line of its verdicts.

    Raises:
        NotAskedError: It says nothing, or does not end.
    """
    given = {"python": str(python), "engine": engine, "version": version}
    arguments = [_filled(part, given) for part in shlex.split(command)]
    words = f"no end in {SECONDS} s"
    try:
        done = subprocess.run(arguments, capture_output=True, text=True, timeout=SECONDS, env=own_variables())
        if cells := list(read(done.stdout, engine)):
            return cells
        words = f"exit code {done.returncode}, {(done.stderr or done.stdout).strip()[-200:]!r}"
    except (OSError, subprocess.TimeoutExpired) as error:
        words = str(error) if isinstance(error, OSError) else words
    rule, remedy = "it prints 'ok NAME' or 'not ok NAME' for each check", "python -m pytest -rA does, too"
    raise NotAskedError(str(sf.Problem(f"run {command!r} on {engine} {version}", words, rule, remedy)))


def _filled(part: str, given: dict[str, str]) -> str:
    """A part of a command with its placeholders filled; other braces stay."""
    for name, value in given.items():
        part = part.replace(f"{{{name}}}", value)
    return part


def read(text: str, engine: str) -> Iterator[Cell]:
    """The cells that a suite's output states; the name of a check stands for its function."""
    for line in text.splitlines():
        match = _LINE.match(line.strip())
        if match:
            yield Cell(engine, "", match[2].strip(), "right" if match[1] in _HOLDS else "wrong")


def apart(cells: Sequence[Cell]) -> list[Group]:
    """Each check of a suite is a group of its own."""
    return [Group(cell.engine, None, (cell,)) for cell in cells]
