"""Environments of their own for releases of engines: made of wheels alone, kept for the next run, and asked."""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
import venv
from collections.abc import Sequence
from datetime import date, timedelta
from importlib.util import find_spec
from pathlib import Path

import symofros as sf
from symofros.tools import cache_folder, create_cache_folder

INSTALL_SECONDS = 900
SCRIPT_SECONDS = 120
# Written last into a folder of an environment: without it, an installation was cut off.
_WHOLE = "installed.txt"


class NotAskedError(RuntimeError):
    """A release could not be asked; the words are a problem in four parts."""


def default_folder() -> Path:
    """Where environments are kept unless another place is stated: in the cache folder, which is this user's alone.

    Raises:
        SymofrosError: The cache folder can't be trusted.
    """
    return cache_folder() / "releases"


def kept(folder: Path, requirements: Sequence[str], until: str = "") -> Path:
    """The Python of an environment that is kept in a folder, made where it is not there yet.

    Args:
        folder: Folder of environments; what is missing of it is made for this user alone.
        requirements: As pip takes them.
        until: See `make`.

    Raises:
        NotAskedError: The requirements can't be installed here, with the installer's last words.
    """
    create_cache_folder(folder)
    stated = "\n".join([*sorted(requirements), *filter(None, [until]), sys.version])
    name = "".join(letter if letter.isalnum() or letter in ".-" else "-" for letter in requirements[0])
    place = folder / f"{name}-{hashlib.sha256(stated.encode()).hexdigest()[:12]}"
    if not (place / _WHOLE).is_file():
        # Made beside and then renamed: of processes that make it at once, the first has it.
        with tempfile.TemporaryDirectory(dir=folder, prefix=".making-") as made:
            make(Path(made) / "environment", list(requirements), until)
            (Path(made) / "environment" / _WHOLE).write_text(stated, encoding="utf-8")
            if place.exists() and not (place / _WHOLE).is_file():
                shutil.rmtree(place)
            if not place.exists():
                os.rename(Path(made) / "environment", place)
    return python_of(place)


def python_of(environment: Path) -> Path:
    """The interpreter of a virtual environment."""
    return environment / ("Scripts/python.exe" if os.name == "nt" else "bin/python")


def make(folder: Path, requirements: list[str], until: str = "") -> Path:
    """Make a virtual environment of wheels alone, by uv or the pip of this environment where they are installed.

    Args:
        folder: Where; it must not exist.
        requirements: As pip takes them.
        until: Day, as 2025-12-31, after which nothing that uv installs was published; "" for what is newest.

    Returns:
        Its Python.

    Raises:
        NotAskedError: The requirements can't be installed here, with the installer's last words.
    """
    uv, has_pip = shutil.which("uv"), find_spec("pip") is not None
    venv.create(folder, with_pip=not (uv or has_pip))
    python = python_of(folder)
    if uv:
        installer = [uv, "pip", "install", "--python", str(python)]
    elif has_pip:
        installer = [sys.executable, "-m", "pip", "--python", str(python), "install"]
    else:
        installer = [str(python), "-m", "pip", "install"]
    dated = [f"--exclude-newer={until}"] if uv and until else []
    command = [*installer, "--quiet", "--only-binary", ":all:", *dated, *requirements]
    done = subprocess.run(command, capture_output=True, text=True, timeout=INSTALL_SECONDS)
    if done.returncode:
        rule = f"a release has wheels for Python {sys.version_info.major}.{sys.version_info.minor} and this system"
        asked, remedy = f"install {' '.join(requirements)}", "run it where the release can be installed"
        raise NotAskedError(str(sf.Problem(asked, _last_words(done.stderr), rule, remedy)))
    return python


def published(package: str) -> list[str]:
    """The releases of a package that have wheels for this Python and system, the oldest first, by the index of pip.

    Raises:
        NotAskedError: pip can't say.
    """
    command = [sys.executable, "-m", "pip", "index", "versions", package, "--only-binary", ":all:"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=INSTALL_SECONDS)
    listed = next((line for line in done.stdout.splitlines() if line.startswith("Available versions:")), "")
    if not listed:
        rule, remedy = "pip lists the releases of a package", "install pip into this environment, or state a release"
        raise NotAskedError(str(sf.Problem(f"releases of {package}", _last_words(done.stderr), rule, remedy)))
    return [one.strip() for one in listed.partition(":")[2].split(",")][::-1]


def day_of(requirement: str) -> str:
    """The day after a release was published, by the lock file that uv writes; "" where it is unknown."""
    uv = shutil.which("uv")
    if not uv:
        return ""
    command = [uv, "pip", "compile", "--format=pylock.toml", "--no-deps", "--only-binary=:all:", "-"]
    done = subprocess.run(command, input=requirement, capture_output=True, text=True, timeout=INSTALL_SECONDS)
    days = re.findall(r"upload-time = (\d+-\d+-\d+)", done.stdout)
    return str(date.fromisoformat(max(days)) + timedelta(days=1)) if days else ""


def printed(python: Path, script: str) -> float:
    """The number that a script prints last.

    Raises:
        NotAskedError: It ended without a number, with its last words.
    """
    words, command = f"no end in {SCRIPT_SECONDS} s", [str(python), "-c", script]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=SCRIPT_SECONDS, env=own_variables())
        words = _last_words(done.stderr or done.stdout)
        return float(done.stdout.strip().splitlines()[-1])
    except (IndexError, ValueError, subprocess.TimeoutExpired):
        remedy = "pin, in 'requires' of the entry, the packages that the release needs"
        problem = sf.Problem("run the script of a fault", words, "a script prints its value last", remedy)
        raise NotAskedError(str(problem)) from None


def own_variables() -> dict[str, str]:
    """The variables of this process without those by which an interpreter finds packages of another environment."""
    return {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "PYTHONHOME")}


def size_of(python: Path) -> float:
    """What the environment of an interpreter takes [MB]."""
    files = (path.lstat() for path in python.parents[1].rglob("*"))
    return sum(status.st_size for status in files) / 1e6


def _last_words(text: str) -> str:
    """The last line, of an installer the last that it calls an error."""
    lines = text.strip().splitlines()
    return "".join(([line for line in lines if line.startswith("ERROR")] or lines)[-1:])
