"""Where numbers come from: versions, machine, flags, source, date; written with a report, and read back from it."""

from __future__ import annotations

import datetime
import os
import platform
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from importlib import metadata
from pathlib import Path
from typing import Any

import symofros as sf
from symofros.tools import find_toolchain

from .evidence import revision, standing
from .numbers import named

# Packages that have a say in the numbers of one report or another.
_PACKAGES = (
    *"numpy scipy sympy pydantic ruamel.yaml pyarrow distributed".split(),
    *"pin mujoco exudyn drake casadi example-robot-data".split(),
)
# Further names that reports have for a distribution.
_ALIASES = {"pinocchio": "pin", "pinocchio-urdf": "pin", "mujoco-urdf": "mujoco"}


@dataclass(frozen=True)
class Provenance:
    """The origin of a report's numbers; empty where it does not say.

    Attributes:
        date: When it was made.
        machine: On which machine.
        versions: With which versions.
        rows: Everything for people, in pairs.
        standing: What a reader must know of its age; "" where its sources are those of now (`evidence.standing`).
    """

    date: str = ""
    machine: str = ""
    versions: dict[str, str] = field(default_factory=dict)
    rows: tuple[tuple[str, str], ...] = ()
    standing: str = ""

    @classmethod
    def of(cls, data: Any, present: str = "") -> Provenance:
        """Provenance from the top of a report, and from what it says of the machine, which may be of several compilers.

        Args:
            data: JSON of the report.
            present: Digest of the sources as they are; "" if it is not known.
        """
        stated = {**data, **data.get("machine", {})}
        flags, cores = stated.get("flags", ""), stated.get("cores", "")
        parts = stated.get("processor"), cores and f"{cores} cores", stated.get("system")
        machine = ", ".join(filter(None, parts))
        pairs = {
            "made": stated.get("date", ""),
            "took": f"{stated['seconds']:.0f} s" if "seconds" in stated else "",
            "machine": machine,
            "versions": named(stated.get("versions", {}), ", "),
            "compiler": "; ".join(stated.get("compilers", ())) or stated.get("compiler", ""),
            "flags": named(flags, "; ") if isinstance(flags, dict) else flags,
            "revision": stated.get("revision", "").replace("+", ", with changes that are not committed"),
            "sources": _digest(stated, present),
        }
        rows = tuple((what, value) for what, value in pairs.items() if value)
        return cls(pairs["made"], machine, stated.get("versions", {}), rows, standing(data, present))


def by_origin(origins: Iterable[Mapping[str, Any]]) -> list[tuple[str, str, int]]:
    """Dates, revisions and numbers of rows that were measured together, by the origin of each row."""
    counts = Counter((one.get("date", ""), one.get("revision", "")[:8]) for one in origins)
    return [(date, revision, number) for (date, revision), number in counts.items()]


def _digest(data: Any, present: str) -> str:
    """The digest of the sources, and whether it is that of now."""
    stated = data.get("digest", "")
    if not stated:
        return ""
    return f"digest {stated}" + (f", {standing(data, present) or 'as they are'}" if present else "")


def stamp() -> dict[str, Any]:
    """Provenance stated in every report: versions, machine, compilation of C, source, date."""
    toolchain = find_toolchain()
    return {
        "versions": versions(),
        "machine": machine(),
        "flags": " ".join(toolchain.default_flags) if toolchain else "none",
        "compiler": toolchain.identity.partition(" ")[2] if toolchain else "none",
        "revision": revision(),
        "date": now(),
    }


def versions() -> dict[str, str]:
    """Versions of this package, of Python, and of the packages that results depend on."""
    installed = {"symofros": sf.__version__, "python": platform.python_version()}
    for name in _PACKAGES:
        try:
            installed[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return installed


def current_versions() -> dict[str, str]:
    """Versions of now, under every name that a report uses."""
    installed = versions()
    return installed | {alias: installed[name] for alias, name in _ALIASES.items() if name in installed}


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


def now() -> str:
    """The date (UTC)."""
    return datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d %H:%M UTC")
