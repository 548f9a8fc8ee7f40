"""How much the folder of compiled models holds, and what is removed from it: the models that were used longest ago."""

from __future__ import annotations

import os
import re
import time
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import NamedTuple

from symofros.errors import SymofrosError

# Names of the folder's own files, a compiled model each with all of its suffixes; no other file is ever removed.
_OWN = re.compile(r"(timing-)?[0-9a-f]{32}\.(so|dylib|dll|pyd|py|c|digest|known|fastest|json)")
LIMIT_VARIABLE = "SYMOFROS_CACHE_LIMIT"
DEFAULT_LIMIT = 4000.0  # [MB]; a robot's model takes 1 to 3.
_MEGABYTE = 1e6
# A library counts as used when it is loaded; the time is written so often at most [s].
_USE_STEP = 86400.0


@dataclass(frozen=True)
class Entry:
    """The files of one name in the folder.

    Attributes:
        files: Files.
        size: Bytes of all of them.
        used: Time when they were made or last loaded [s since the epoch].
    """

    files: tuple[Path, ...]
    size: int
    used: float


def entries(folder: Path) -> list[Entry]:
    """What the folder holds, the least recently used first; links and files of others are left out."""
    by_name: dict[str, list[tuple[Path, os.stat_result]]] = {}
    try:
        with os.scandir(folder) as listed:
            for item in listed:
                if _OWN.fullmatch(item.name) and item.is_file(follow_symlinks=False):
                    with suppress(OSError):  # Another process may be removing it.
                        status = item.stat(follow_symlinks=False)
                        by_name.setdefault(item.name.partition(".")[0], []).append((Path(item.path), status))
    except OSError:
        return []
    made = [
        Entry(
            tuple(path for path, _ in files),
            sum(status.st_size for _, status in files),
            max(status.st_mtime for _, status in files),
        )
        for files in by_name.values()
    ]
    return sorted(made, key=lambda entry: entry.used)


class Pruned(NamedTuple):
    """What was removed, and what could not be: of a folder that is only read, or loaded by another process."""

    removed: list[Entry]
    kept: list[Entry]


def prune(folder: Path, limit: float, unused: float = 0.0) -> Pruned:
    """Remove the least recently used until the rest is within a limit.

    Args:
        folder: Folder of compiled models.
        limit: Bytes that may stay.
        unused: Also what was not used for so long [s]; 0: not for this reason.
    """
    held = entries(folder)
    total, oldest = sum(entry.size for entry in held), time.time() - unused if unused else 0.0
    pruned = Pruned([], [])
    for entry in held:
        if total <= limit and entry.used >= oldest:
            break
        if all([_removed(file) for file in entry.files]):
            pruned.removed.append(entry)
            total -= entry.size
        else:
            pruned.kept.append(entry)
    return pruned


def _removed(file: Path) -> bool:
    try:
        file.unlink(missing_ok=True)
    except OSError:
        return False
    return True


def limit() -> float:
    """Bytes that the folder may hold: SYMOFROS_CACHE_LIMIT, in MB; infinite if that is 0.

    Raises:
        SymofrosError: It is not a number, or negative.
    """
    stated = os.environ.get(LIMIT_VARIABLE)
    try:
        megabytes = DEFAULT_LIMIT if not stated else float(stated)
    except ValueError:
        megabytes = -1.0
    if not megabytes >= 0.0:
        raise SymofrosError(
            f"{LIMIT_VARIABLE} is not a size",
            repr(stated)[:80],
            "it is the number of megabytes that compiled models may take, 0 for no limit",
            f"unset it for {DEFAULT_LIMIT:g}",
        )
    return megabytes * _MEGABYTE or float("inf")


@cache
def keep_within_limit(folder: Path) -> None:
    """Once a process, before something is compiled."""
    prune(folder, limit())


def note_use(statement: Path) -> None:
    """Let a model that is loaded be among the last to be removed.

    Args:
        statement: The file beside its library, whose time is that of its last use.
    """
    with suppress(OSError):  # A folder that is only read.
        if time.time() - statement.stat().st_mtime > _USE_STEP:
            os.utime(statement)
