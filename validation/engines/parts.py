"""The matrix measured in parts, some engines at a time: of stored parts is taken over what still answers what is asked.

Cells and identities are stored as nested tables, which say names once: a fifth of the text of rows that repeat them.
What an interrupted run has finished is a part, too.
"""

from __future__ import annotations

import json
import pickle
import shutil
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from importlib.metadata import distributions
from pathlib import Path
from typing import Any

from symofros import SymofrosError
from symofros.tools import cache_folder, create_cache_folder, write_atomically

from ..reporting.record import Data
from .digests import digest
from .matrix import Judged
from .verdicts import Cell
from .workers import Crashed

Row = dict[str, Any]
# What rows of a stored table are found by, in its nesting, and what is kept of each.
CELLS = ("engine", "function", "model"), ("verdict", "error", "tolerance", "words")
IDENTITIES = ("engine", "identity", "model"), ("error", "ok")
# What the cells of an engine on a tree are answers to (`digests`), and where that was measured: the place in "origins"
# of a report; "" for the report's own run.
ASKED = ("engine", "model"), ("digest", "origin")
TABLES = {"cells": CELLS, "corrected": CELLS, "identities": IDENTITIES, "asked": ASKED}
# Whoever measured says when, of which source, and by which versions.
ORIGIN = ("revision", "date", "versions", "digest")
# Engine and tree -> what its cells are answers to.
Digests = Mapping[tuple[str, str], str]
# The most that an interrupted run leaves [bytes].
_LEFT = 1_000_000_000


class NoPart(ValueError):
    """A file is no stored report."""


def nested(rows: Iterable[Row], layout: tuple[Sequence[str], Sequence[str]]) -> Data:
    """Rows as a nested table; empty text at the end of a row is left out."""
    keys, kept = layout
    table: Row = {}
    for row in rows:
        place = table
        for key in keys[:-1]:
            place = place.setdefault(row[key], {})
        values = [row[name] for name in kept]
        place[row[keys[-1]]] = values[:-1] if values[-1] == "" else values
    return table


def unnested(table: Data, layout: tuple[Sequence[str], Sequence[str]]) -> list[Row]:
    """The rows of a nested table."""
    keys, kept = layout
    places: list[tuple[tuple[str, ...], Any]] = [((), table)]
    for _ in keys:
        places = [((*names, name), inner) for names, outer in places for name, inner in outer.items()]
    return [
        dict(zip(keys, names, strict=True)) | dict.fromkeys(kept, "") | dict(zip(kept, values, strict=False))
        for names, values in places
    ]


def cells(data: Data, table: str = "cells") -> list[Cell]:
    """The cells of a report's table; none where it has no such table."""
    return [Cell(**row) for row in unnested(data.get(table, {}), CELLS)]


def load(paths: Iterable[Path]) -> list[Data]:
    """Stored reports.

    Raises:
        NoPart: A file is none.
    """
    parts: list[Data] = []
    for path in paths:
        try:
            part = json.loads(path.read_text(encoding="utf-8"))
            engines_of([part]), part["cells"], part["proofs"]
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise NoPart(f"{path} is no stored engines.json: {type(error).__name__}: {error}") from None
        parts.append(part)
    return parts


def engines_of(parts: Iterable[Data]) -> dict[str, str]:
    """The engines of stored parts, with their releases."""
    return {engine["name"]: engine["version"] for part in parts for engine in part["engines"]}


def places(data: Data) -> list[tuple[str, str]]:
    """The engines and trees that a report has cells of."""
    return [(row["engine"], row["model"]) for row in unnested(data.get("asked", {}), ASKED)]


def taken_over(parts: Iterable[Data], asked: Digests) -> list[Data]:
    """What stored parts have that is an answer to what is asked; of several that have it, the first.

    Args:
        parts: Stored parts; one that does not say what it answers has nothing.
        asked: What is asked.
    """
    left, result = dict(asked), []
    for part in parts:
        rows = unnested(part.get("asked", {}), ASKED)
        kept = {place for row in rows if left.get(place := (row["engine"], row["model"])) == row["digest"]}
        left = {place: one for place, one in left.items() if place not in kept}
        result.append(only(part, kept))
    return result


def only(part: Data, kept: Collection[tuple[str, str]]) -> Data:
    """What a part has of some engines and trees."""
    engines = {engine for engine, _ in kept}

    def own(rows: Iterable[Row]) -> Iterator[Row]:
        return (row for row in rows if (row["engine"], row["model"]) in kept)

    tables = {name: nested(own(unnested(part.get(name, {}), layout)), layout) for name, layout in TABLES.items()}
    listed = {
        "engines": [one for one in part["engines"] if one["name"] in engines],
        "proofs": list(own(part["proofs"])),
        "ours": [name for name in part.get("ours", ()) if name in engines],
    }
    return dict(part) | tables | listed


def merged(own: Data, parts: Sequence[Data]) -> Data:
    """What was measured now with what stored parts have; what they have bears its origin.

    Args:
        own: What was measured now; its proofs are those of all.
        parts: What is taken over (`taken_over`): no two have the same.
    """
    result: dict[str, Any] = dict(own)
    rows = {name: unnested(own.get(name, {}), layout) for name, layout in TABLES.items()}
    origins: list[Data] = []
    for part in parts:
        there = [{name: part[name] for name in ORIGIN if name in part}, *part.get("origins", ())]
        stored = {name: unnested(part.get(name, {}), layout) for name, layout in TABLES.items()}
        for row in stored["asked"]:
            origin = there[0 if row["origin"] == "" else row["origin"] + 1]
            origins += [origin] if origin not in origins else []
            row["origin"] = origins.index(origin)
        for name, more in stored.items():
            rows[name] += more
        known = engines_of([result])
        result["engines"] = [*result["engines"], *(one for one in part["engines"] if one["name"] not in known)]
        result["functions"] = result["functions"] | part["functions"] | own["functions"]
        result["ours"] = list(dict.fromkeys([*result.get("ours", ()), *part.get("ours", ())]))
    # What no engine offers any more is left out.
    offered = {name for engine in result["engines"] for name in engine["functions"]}
    kept = {name: text for name, text in result["functions"].items() if name in offered or name in own["functions"]}
    absent = {name: why for name, why in own["absent"].items() if name not in engines_of([result])}
    result |= {"functions": kept, "absent": absent}
    return {**_in_order(result, rows), **({"origins": origins} if origins else {})}


def _in_order(report: Data, rows: Mapping[str, list[Row]]) -> Data:
    """A report with the rows of its tables in the order of its engines, functions and trees."""
    listed = {"engine": engines_of([report]), "function": report["functions"], "model": report["models"]}
    order = {name: {one: k for k, one in enumerate(names)} for name, names in listed.items()}

    def rank(row: Row) -> list[int]:
        return [place.get(row[key], -1) for key, place in order.items() if key in row]

    return {**report, **{name: nested(sorted(rows[name], key=rank), layout) for name, layout in TABLES.items()}}


def write_scripts(proofs: Iterable[Mapping[str, Any]], folder: Path) -> None:
    """The scripts of proofs in a folder, and no others."""
    folder.mkdir(parents=True, exist_ok=True)
    texts = {Path(proof["file"]).name: proof["text"] for proof in proofs if proof["text"]}
    for path in folder.glob("*.py"):
        if path.name not in texts:
            path.unlink()
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")


class Finished:
    """What a run has finished, question by question and engine by engine, for the next one if it is interrupted.

    The files lie in the cache folder, which is this user's alone; those of other packages are removed.

    Args:
        keeps: Whether anything is kept.
    """

    def __init__(self, keeps: bool = True) -> None:
        self._folder: Path | None = None
        self._size = 0
        if not keeps:
            return
        key = digest(*sorted(f"{one.name}=={one.version}" for one in distributions()))
        with suppress(OSError, SymofrosError):
            above = cache_folder() / "asked"
            create_cache_folder(above / key)
            for path in above.iterdir():
                if path.name != key:
                    shutil.rmtree(path, ignore_errors=True)
            self._folder = above / key
            self._size = sum(path.stat().st_size for path in self._folder.iterdir())

    def of(self, name: str, asked: Mapping[str, str]) -> dict[str, list[Judged]]:
        """The cells of engines on a question that were finished and answer what is asked (engine -> digest)."""
        if self._folder is None:
            return {}
        try:
            stored, answered = pickle.loads(self._path(self._folder, name).read_bytes())
            found = {engine: cells for engine, (of, cells) in answered.items() if of == asked.get(engine)}
        except Exception:  # No file, or one that is damaged, which may raise whatever it likes.
            return {}
        return found if stored == name else {}

    def keep(self, name: str, asked: Mapping[str, str], cells: Sequence[Judged]) -> None:
        """Keep the cells of a question, but for engines that crashed: on a busy machine one may have been too slow."""
        if self._folder is None:
            return
        crashed = {one.cell.engine for one in cells if isinstance(one.answer.value, Crashed)}
        own = {name: [one for one in cells if one.cell.engine == name] for name in asked if name not in crashed}
        content = pickle.dumps((name, {engine: (asked[engine], found) for engine, found in own.items()}))
        if self._size + len(content) > _LEFT:
            return
        with suppress(OSError):
            write_atomically(self._path(self._folder, name), content)
            self._size += len(content)

    def forget(self) -> None:
        """Remove all: the report has it."""
        if self._folder is not None:
            shutil.rmtree(self._folder, ignore_errors=True)

    @staticmethod
    def _path(folder: Path, name: str) -> Path:
        return folder / f"{digest(name)}.pickle"
