"""Which cells of the matrix changed between two runs, such as those of two releases."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..reporting.numbers import counted
from ..reporting.record import Data, Section, Table
from . import parts

_NOT_OFFERED = "not offered"
# What is said of an engine's release beside its name.
_VERSION = "version"
_SHOWN = ("function", "model", "before", "after")


def load(path: Path | None) -> Data | None:
    """A stored engines.json to compare with; None for none.

    Raises:
        ValueError: It is no such file.
    """
    if path is None:
        return None
    try:
        stored: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        parts.unnested(stored["cells"], parts.CELLS), stored["engines"]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise ValueError(f"{path} is no stored engines.json: {type(error).__name__}: {error}") from None
    return stored


def between(before: Data, after: Data) -> list[dict[str, str]]:
    """Cells whose verdict is another, of the engines that both have; a tree or function that one lacks is no change.

    Args:
        before: JSON of the earlier run.
        after: JSON of the later one.
    """
    old, new = _verdicts(before), _verdicts(after)
    releases = [{one["name"]: one[_VERSION] for one in data["engines"]} for data in (before, after)]
    shared = releases[0].keys() & releases[1].keys()
    models, functions = (set(before[name]) & set(after[name]) for name in ("models", "functions"))
    rows = []
    for place in sorted(old.keys() | new.keys()):
        engine, function, model = place
        was, now = old.get(place, _NOT_OFFERED), new.get(place, _NOT_OFFERED)
        if engine in shared and model in models and function in functions and was != now:
            stated = {"engine": engine, "function": function, "model": model, "before": was, "after": now}
            rows.append(stated | {"from": releases[0][engine], "to": releases[1][engine]})
    return rows


def _verdicts(data: Data) -> Mapping[tuple[str, str, str], str]:
    rows = parts.unnested(data["cells"], parts.CELLS)
    return {(row["engine"], row["function"], row["model"]): row["verdict"] for row in rows}


def shown(data: Data) -> tuple[Section, ...]:
    """The section of a report on what changed; none where there was nothing to compare with."""
    if "changed" not in data:
        return ()
    rows = data["changed"]
    versions = {row["engine"]: f"{row['engine']} {row['from']} to {row['to']}" for row in rows}
    head = "engine | function | tree | before | now"
    lines = ((versions[row["engine"]], *(row[name] for name in _SHOWN)) for row in rows)
    said = f"{counted(len(rows), 'cell')} changed" if rows else "No cell changed"
    return (Section("What changed", (f"{said} against the stored run.", Table.of(head, lines)), "changed", not rows),)
