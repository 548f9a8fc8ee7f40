"""Where numbers come from: versions, machine, flags, source, date."""

from __future__ import annotations

import datetime
import platform
import subprocess
from importlib import metadata
from pathlib import Path
from typing import Any

import symofros as sf
from symofros.runtime.toolchain import DEFAULT_FLAGS, find_toolchain
from validation.reporting.record import machine

# Whatever of these is installed has a say in the numbers.
_NUMBERS = ("numpy", "scipy", "pin", "mujoco", "exudyn", "casadi", "example-robot-data")


def versions(*tools: str) -> dict[str, str]:
    """Ours, Python's, and those of the packages that results depend on; of further ones if named."""
    found = {"symofros": sf.__version__, "python": platform.python_version()}
    for name in (*_NUMBERS, *tools):
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return found


def stamp() -> dict[str, Any]:
    """What every report states besides versions: machine, how C is compiled, revision of the source, date."""
    return {"machine": machine(), **build(), "date": now()}


def build() -> dict[str, str]:
    """Flags and compiler of the generated C, and the revision of the source that makes it."""
    toolchain = find_toolchain()
    compiler = toolchain.identity.partition(" ")[2] if toolchain else "none"
    return {"flags": " ".join(DEFAULT_FLAGS), "compiler": compiler, "revision": revision()}


def now() -> str:
    """The date (UTC)."""
    return datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d %H:%M UTC")


def revision(folder: Path = Path(sf.__file__).parent) -> str:
    """The source's revision, "+" where files differ from it; empty where there is no repository."""
    try:
        said = [
            subprocess.run(["git", "-C", str(folder), *words], capture_output=True, text=True, timeout=10, check=True)
            for words in (["rev-parse", "HEAD"], ["status", "--porcelain", "--untracked-files=no", "--", "."])
        ]
    except (OSError, subprocess.SubprocessError):
        return ""
    return said[0].stdout.strip() + ("+" if said[1].stdout.strip() else "")
