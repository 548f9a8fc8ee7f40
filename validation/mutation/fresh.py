"""Which code is new since a revision: by its tokens, so that what was moved, wrapped or commented anew is not."""

from __future__ import annotations

import io
import re
import subprocess
import tarfile
from bisect import bisect_left
from pathlib import Path

from .fault import SourceFault

# Tokens in a row that the older source has nowhere are new.
ROW = 7
_DAY = re.compile(r"\d{4}-\d{2}-\d{2}")
_SUFFIXES = (".py", ".c", ".h", ".in")
_TOKENS = re.compile(
    r"""(?P<skip>\"{3}.*?\"{3}|/\*.*?\*/|(?<!\S)//[^\n]*|(?<!\S)\#\s[^\n]*)|"(?:[^"\\\n]|\\.)*"|\w+|\S""", re.DOTALL
)

Rows = set[tuple[str, ...]]


class Fresh:
    """Tells faults in new code.

    Args:
        root: Folder of the repository.
        since: Revision, or day as 2026-11-24: the source as it was when it began.

    Raises:
        LookupError: The repository has no such revision, or there is no repository.
    """

    def __init__(self, root: Path, since: str) -> None:
        self.revision = revision_at(root, since)
        self._rows: Rows = set()
        archive = _git(root, "archive", "--format=tar", self.revision, "symofros")
        with tarfile.open(fileobj=io.BytesIO(archive)) as files:
            for member in files:
                file = files.extractfile(member) if member.name.endswith(_SUFFIXES) else None
                if file is not None:
                    self._rows |= _rows([text for text, _ in tokens(file.read().decode("utf-8", "replace"))])
        self._begins: dict[str, list[int]] = {}

    def has(self, fault: SourceFault, text: str) -> bool:
        """Whether a fault is planted in new code."""
        if fault.module not in self._begins:
            self._begins[fault.module] = self._new_tokens(text)
        begins = self._begins[fault.module]
        at = bisect_left(begins, fault.start)
        return at < len(begins) and begins[at] < fault.start + len(fault.before)

    def _new_tokens(self, text: str) -> list[int]:
        """Where the middle tokens of new rows begin, in order."""
        listed = tokens(text)
        names = [name for name, _ in listed]
        return [
            listed[i + ROW // 2][1] for i in range(len(names) - ROW + 1) if tuple(names[i : i + ROW]) not in self._rows
        ]


def tokens(text: str) -> list[tuple[str, int]]:
    """Tokens of Python or C and where they begin, without comments and docstrings."""
    return [(match[0], match.start()) for match in _TOKENS.finditer(text) if match.lastgroup != "skip"]


def _rows(names: list[str]) -> Rows:
    return {tuple(names[i : i + ROW]) for i in range(len(names) - ROW + 1)}


def revision_at(root: Path, since: str) -> str:
    """The revision that a name, or the beginning of a day, stands for.

    Raises:
        LookupError: There is none.
    """
    asked = ("rev-list", "-1", f"--before={since}T00:00:00", "HEAD") if _DAY.fullmatch(since) else ("rev-parse", since)
    try:
        revision = _git(root, *asked).decode().strip()
    except (subprocess.CalledProcessError, FileNotFoundError) as error:
        raise LookupError(f"no revision '{since}' of {root}") from error
    if not revision:
        raise LookupError(f"{root} has no revision before {since}")
    return revision


def _git(root: Path, *arguments: str) -> bytes:
    return subprocess.run(["git", "-C", str(root), *arguments], check=True, capture_output=True).stdout
