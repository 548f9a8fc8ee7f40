"""What a check found, as data: results, versions, machine. Reports are made from it, now or later."""

from __future__ import annotations

import datetime
import json
import math
import os
import platform
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

import symofros as sf
from validation.check import ModelResult, Settings
from validation.comparison.errors import Comparison

SCHEMA = 1


@dataclass(frozen=True)
class Record:
    """One run of the check.

    Attributes:
        settings: What was asked for.
        models: Results, in the order asked for.
        seconds: Wall time of it all.
        date: When it ended (UTC).
        versions: Package -> version.
        machine: What it ran on.
        unfinished: Models that were asked for, but the run was interrupted before.
        build: Flags and compiler of the C, revision of the source.
    """

    settings: Settings
    models: tuple[ModelResult, ...]
    seconds: float
    date: str
    versions: dict[str, str]
    machine: dict[str, str]
    unfinished: tuple[str, ...] = ()
    build: dict[str, str] = field(default_factory=dict)

    @property
    def ok(self) -> bool:
        """Whether all that was asked for was compared, and nothing disagrees or failed."""
        return bool(self.compared) and all(model.ok for model in self.models) and not self.unfinished

    @property
    def comparisons(self) -> list[Comparison]:
        """All rows."""
        return [row for model in self.models for row in model.comparisons]

    @property
    def compared(self) -> list[Comparison]:
        """The rows with a verdict on numbers."""
        return self.rows("agree", "disagree")

    def rows(self, *status: str) -> list[Comparison]:
        """The rows of these statuses."""
        return [row for row in self.comparisons if row.status in status]


def make_record(
    settings: Settings,
    models: Sequence[ModelResult],
    seconds: float,
    unfinished: Sequence[str] = (),
    build: Mapping[str, str] | None = None,
) -> Record:
    """Add to results what is needed to judge them later."""
    versions = {"symofros": sf.__version__, "python": platform.python_version(), "numpy": np.__version__}
    for model in models:
        versions |= {name: version for name, version in model.versions.items() if name not in _OURS}
    robots = _version("example-robot-data")
    if robots:
        versions["example-robot-data"] = robots
    now = datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d %H:%M UTC")
    return Record(settings, tuple(models), seconds, now, versions, machine(), tuple(unfinished), dict(build or {}))


_OURS = frozenset({"interpreted", "description"})


def _version(package: str) -> str:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return ""


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


def summary(record: Record) -> dict[str, Any]:
    """What `--json` prints: the verdict and one entry a comparison; None where there is no number."""
    return {
        "ok": record.ok,
        "comparisons": [_entry(row) for row in record.rows("agree", "disagree", "failed")],
        "unsupported": [
            {"model": row.model, "engine": row.engine, "quantity": row.quantity, "reason": row.note}
            for row in record.rows("unsupported")
        ],
    }


def _entry(row: Comparison) -> dict[str, Any]:
    entry: dict[str, Any] = {
        "model": row.model,
        "engine": row.engine,
        "quantity": row.quantity,
        "states": row.states,
        "error": row.error,
        "tolerance": row.tolerance,
        "ok": row.ok,
        "median": row.median,
        "worst_state": row.worst_state,
    }
    if row.note:
        entry["note"] = row.note
    return entry | {name: value if math.isfinite(value) else None for name, value in row.extra.items()}


def to_json(record: Record) -> str:
    """Everything, for the archive."""
    content = {
        "schema": SCHEMA,
        **summary(record),
        "unfinished": record.unfinished,
        "date": record.date,
        "seconds": round(record.seconds, 1),
        "settings": asdict(record.settings),
        "versions": record.versions,
        "machine": record.machine,
        **record.build,
        "models": [
            {
                "model": model.label,
                "hash": model.hash,
                **model.sizes,
                "frames": model.frames,
                "notes": model.notes,
                "seconds": {stage: round(seconds, 3) for stage, seconds in model.seconds.items()},
            }
            for model in record.models
        ],
    }
    return json.dumps(content, indent=1, allow_nan=False) + "\n"
