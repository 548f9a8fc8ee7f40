"""The matrix measured in parts, some engines at a time: stored parts are taken over if they answer the same question.

Cells and identities are stored as nested tables, which say names once: a fifth of the text of rows that repeat them.
What an interrupted run has finished is a part, too: the next one of the same sources and packages takes it over.
"""

from __future__ import annotations

import hashlib
import json
import pickle
import shutil
from collections.abc import Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from functools import cache
from importlib.metadata import distributions
from pathlib import Path
from typing import Any

from symofros import SymofrosError
from symofros.tools import cache_folder, create_cache_folder, write_atomically

from ..reporting.record import Data
from .matrix import Judged
from .verdicts import Cell
from .workers import Crashed

Row = dict[str, Any]
# What rows of a stored table are found by, in its nesting, and what is kept of each.
CELLS = ("engine", "function", "model"), ("verdict", "error", "tolerance", "words")
IDENTITIES = ("engine", "identity", "model"), ("error", "ok")
# Nested tables, of engines first.
TABLES = "cells", "corrected", "identities"
# Whoever measured says when, of which source, and by which versions.
ORIGIN = ("revision", "date", "versions", "digest")
# What an answer is held to: trees, truths, tolerances. Parts by other plug-ins or proofs answer the same question.
_ASKED = tuple("functions/*.py identities.py matrix.py scales.py states.py verdicts.py models/*.py truth/*.py".split())
# The most that an interrupted run leaves [bytes].
_LEFT = 1_000_000_000


class PartsDisagree(ValueError):
    """Stored parts can't be one report."""


@cache
def question() -> str:
    """Digest of what engines are asked and held to."""
    return _digest(*_ASKED)


def _digest(*patterns: str) -> str:
    """Digest of files of this folder."""
    folder = Path(__file__).parent
    digest = hashlib.sha256()
    for path in sorted(path for pattern in patterns for path in folder.glob(pattern)):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


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
    """Stored parts, none of which has an engine of another.

    Raises:
        PartsDisagree: A file is no part, was asked something else, or has an engine that another has, too.
    """
    parts: list[Data] = []
    owners: dict[str, Path] = {}
    for path in paths:
        try:
            part = json.loads(path.read_text(encoding="utf-8"))
            names = [engine["name"] for engine in part["engines"]]
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise PartsDisagree(f"{path} is no stored engines.json: {type(error).__name__}: {error}") from None
        if part.get("question") != question():
            stated = f"question {part['question']}" if "question" in part else "no question: it is of an older version"
            raise PartsDisagree(f"{path} was held to other trees or truths: it states {stated}, now it is {question()}")
        for name in names:
            if name in owners:
                raise PartsDisagree(f"engine '{name}' is in {owners[name]} and in {path}: leave one out")
            owners[name] = path
        parts.append(part)
    return parts


def others(path: Path, engines: Collection[str], versions: Mapping[str, str]) -> Data:
    """What a stored report has of other engines than those that are asked anew.

    Args:
        path: The report.
        engines: Names of those that are asked anew.
        versions: Versions of all engines that are here.

    Raises:
        PartsDisagree: It is no such report, was asked something else, or an engine of it has another version here.
    """
    (part,) = load([path])
    for one in part["engines"]:
        name, here = one["name"], versions.get(one["name"])
        if name not in engines and here is not None and here != one["version"]:
            raise PartsDisagree(
                f"{path} has {name} {one['version']}, here it is {here}: ask it anew, too, by --engine {name}"
            )
    kept = {name for name in engines_of([part]) if name not in engines}
    left = {table: {name: rows for name, rows in part[table].items() if name in kept} for table in TABLES}
    # Numbers that it took over bear their own origin already.
    return (
        dict(part)
        | left
        | {
            "engines": [one for one in part["engines"] if one["name"] in kept],
            "proofs": [one for one in part["proofs"] if one["engine"] in kept],
            "ours": [name for name in part.get("ours", ()) if name in kept],
        }
    )


def engines_of(parts: Iterable[Data]) -> set[str]:
    """Names of the engines of stored parts."""
    return {engine["name"] for part in parts for engine in part["engines"]}


def merged(own: Data, parts: Sequence[Data]) -> Data:
    """What was measured now with what stored parts have; each engine of theirs bears the origin of its numbers.

    Args:
        own: What was measured now.
        parts: Stored parts (`load`).

    Raises:
        PartsDisagree: A part was asked about other trees than the others.
    """
    models = [own["models"]] if own["engines"] else []
    models += [part["models"] for part in parts]
    if any(set(one) != set(models[0]) for one in models):
        raise PartsDisagree("the parts were asked about different trees: --kinds must be the same for all")
    result = dict(own) | {"models": models[0]}
    for part in parts:
        origin = {name: part[name] for name in ORIGIN if name in part}
        result["engines"] = [*result["engines"], *({"measured": origin} | engine for engine in part["engines"])]
        result["functions"] = part["functions"] | result["functions"]
        result["absent"] = result["absent"] | part["absent"]
        result["ours"] = [*result.get("ours", ()), *part.get("ours", ())]
        result["proofs"] = [*result["proofs"], *part["proofs"]]
        for table in TABLES:
            result[table] = result[table] | part[table]
    # Each part's sources are to be those of now.
    result["digests"] = sorted({one for part in parts for one in (part.get("digest", ""), *part.get("digests", ()))})
    present = {engine["name"] for engine in result["engines"]}
    result["absent"] = {name: why for name, why in result["absent"].items() if name not in present}
    return result


def write_scripts(proofs: Iterable[Mapping[str, Any]], folder: Path) -> None:
    """The scripts of stored proofs, beside those that were written now."""
    folder.mkdir(parents=True, exist_ok=True)
    for proof in (one for one in proofs if one["text"]):
        (folder / Path(proof["file"]).name).write_text(proof["text"], encoding="utf-8")


class Finished:
    """What a run has finished, question by question, for the next one if it is interrupted.

    The files lie in the cache folder, which is this user's alone; those of another key are removed.

    Args:
        key: What the answers depend on (`finished_key`); "" to keep nothing.
    """

    def __init__(self, key: str) -> None:
        self._folder: Path | None = None
        self._size = 0
        if not key:
            return
        with suppress(OSError, SymofrosError):
            above = cache_folder() / "asked"
            create_cache_folder(above / key)
            for path in above.iterdir():
                if path.name != key:
                    shutil.rmtree(path, ignore_errors=True)
            self._folder = above / key
            self._size = sum(path.stat().st_size for path in self._folder.iterdir())

    def of(self, name: str) -> list[Judged] | None:
        """The cells of a question; None where it was not finished."""
        if self._folder is None:
            return None
        try:
            stored, cells = pickle.loads(self._path(self._folder, name).read_bytes())
        except Exception:  # No file, or one that is damaged, which may raise whatever it likes.
            return None
        return cells if stored == name else None

    def keep(self, name: str, cells: list[Judged]) -> None:
        """Keep the cells of a question, unless an engine crashed: on a busy machine one may have been too slow."""
        if self._folder is None or any(isinstance(one.answer.value, Crashed) for one in cells):
            return
        content = pickle.dumps((name, cells))
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
        return folder / f"{hashlib.sha256(name.encode()).hexdigest()[:24]}.pickle"


def finished_key(engines: Iterable[str], sources: str) -> str:
    """What the answers of engines depend on: which they are, the sources, and every package of the environment.

    Args:
        engines: Names of the engines that are asked.
        sources: Digest of the sources of the report.
    """
    packages = sorted(f"{one.name}=={one.version}" for one in distributions())
    stated = json.dumps([sorted(engines), sources, _digest("**/*.py"), packages])
    return hashlib.sha256(stated.encode()).hexdigest()[:24]
