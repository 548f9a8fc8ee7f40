"""Where numbers come from: versions, machine, flags, source, date; written with a report, and read back from it."""

from __future__ import annotations

import datetime
import os
import platform
import subprocess
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

import symofros as sf
from symofros.tools import DEFAULT_FLAGS, find_toolchain

# Packages that have a say in the numbers of one report or another.
_PACKAGES = ("numpy", "scipy", "pin", "mujoco", "exudyn", "casadi", "example-robot-data")
# Distribution -> further names that reports have for it.
_ALIASES = {"pin": ("pinocchio", "pinocchio-urdf"), "mujoco": ("mujoco-urdf",)}


@dataclass(frozen=True)
class Provenance:
    """The origin of a report's numbers; empty where it does not say.

    Attributes:
        date: Time when it was made (UTC).
        machine: Processor, cores, system.
        flags: Flags of the generated C.
        compiler: Compiler of the generated C.
        revision: Revision of the source.
        versions: Package -> version.
        seconds: Wall time.
    """

    date: str
    machine: str
    flags: str
    compiler: str
    revision: str
    versions: dict[str, str]
    seconds: float | None

    @classmethod
    def of(cls, data: Any) -> Provenance:
        """From wherever a report says it: at the top, with the machine, or among its facts."""
        levels = [data] if isinstance(data, dict) else []
        levels += [data[key] for level in levels for key in ("machine", "facts") if isinstance(level.get(key), dict)]

        def stated(key: str, default: Any) -> Any:
            return next((level[key] for level in levels if level.get(key)), default)

        flags, versions = stated("flags", ""), stated("versions", {})
        if isinstance(flags, dict):
            flags = "; ".join(f"{name} {value}" for name, value in flags.items())
        flags = flags if isinstance(flags, str) else " ".join(map(str, flags))
        machine = [
            str(value) for value in (stated("processor", ""), stated("cores", ""), stated("system", "")) if value
        ]
        if len(machine) > 1:
            machine[1] += " cores"
        compiler = stated("compiler", "") or "; ".join(stated("compilers", []))
        versions = {str(name): str(value) for name, value in versions.items()} if isinstance(versions, dict) else {}
        seconds = stated("seconds", None)
        return cls(
            str(stated("date", "")),
            ", ".join(machine),
            flags,
            str(compiler),
            str(stated("revision", "")),
            versions,
            float(seconds) if isinstance(seconds, int | float) else None,
        )

    def rows(self) -> list[tuple[str, str]]:
        """What it says, for people."""
        versions = ", ".join(f"{name} {version}" for name, version in self.versions.items())
        took = "" if self.seconds is None else f"{self.seconds:.0f} s"
        pairs = {
            "made": self.date,
            "took": took,
            "machine": self.machine,
            "versions": versions,
            "compiler": self.compiler,
            "flags": self.flags,
            "revision": self.revision,
        }
        return [(name, value) for name, value in pairs.items() if value]


def stamp(*tools: str) -> dict[str, Any]:
    """What every report states: versions, of further packages if named, machine, compilation of C, source, date."""
    return {"versions": versions(*tools), "machine": machine(), **build(), "date": now()}


def versions(*tools: str) -> dict[str, str]:
    """Ours, Python's, and those of the packages that results depend on; of further ones if named."""
    installed = {"symofros": sf.__version__, "python": platform.python_version()}
    for name in (*_PACKAGES, *tools):
        try:
            installed[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return installed


def versions_now() -> dict[str, str]:
    """Versions of now, under every name that a report uses."""
    installed = versions()
    return installed | {
        alias: installed[name] for name, aliases in _ALIASES.items() if name in installed for alias in aliases
    }


def machine() -> dict[str, str]:
    """The processor and the system; no name of host or user."""
    return {
        "processor": _processor(),
        "cores": str(os.cpu_count()),
        "system": " ".join(filter(None, [platform.system(), platform.machine(), *platform.libc_ver()])),
    }


def _processor() -> str:
    cpuinfo = Path("/proc/cpuinfo")  # Linux: `platform.processor` is empty there.
    if cpuinfo.is_file():
        for line in cpuinfo.read_text(errors="replace").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()


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
