"""An environment of its own for one release of an engine, and a script run in it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import venv
from pathlib import Path

import symofros as sf

INSTALL_SECONDS = 900
SCRIPT_SECONDS = 120


class NotAskedError(RuntimeError):
    """A release could not be asked; the words are a problem in four parts."""


def make(folder: Path, requirements: list[str]) -> Path:
    """Make a virtual environment of wheels alone, by uv where it is installed.

    Args:
        folder: Where; it must not exist.
        requirements: As pip takes them.

    Returns:
        Its Python.

    Raises:
        NotAskedError: The requirements can't be installed here, with the installer's last words.
    """
    uv = shutil.which("uv")
    venv.create(folder, with_pip=uv is None)
    python = folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")
    installer = [uv, "pip", "install", "--python", str(python)] if uv else [str(python), "-m", "pip", "install"]
    command = [*installer, "--quiet", "--only-binary", ":all:", *requirements]
    done = subprocess.run(command, capture_output=True, text=True, timeout=INSTALL_SECONDS)
    if done.returncode:
        rule = f"a release has wheels for Python {sys.version_info.major}.{sys.version_info.minor} and this system"
        asked, remedy = f"install {' '.join(requirements)}", "run it where the release can be installed"
        raise NotAskedError(str(sf.Problem(asked, _last_words(done.stderr), rule, remedy)))
    return python


def printed(python: Path, script: str) -> float:
    """The number that a script prints last.

    Args:
        python: Python of the environment.
        script: The script.

    Raises:
        NotAskedError: It ended without a number, with its last words.
    """
    words, command = f"no end in {SCRIPT_SECONDS} s", [str(python), "-c", script]
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=SCRIPT_SECONDS, env=environment)
        words = _last_words(done.stderr or done.stdout)
        return float(done.stdout.strip().splitlines()[-1])
    except (IndexError, ValueError, subprocess.TimeoutExpired):
        remedy = "pin, in 'requires' of the entry, the packages that the release needs"
        problem = sf.Problem("run the script of a fault", words, "a script prints its value last", remedy)
        raise NotAskedError(str(problem)) from None


def _last_words(text: str) -> str:
    return "".join(text.strip().splitlines()[-1:])
