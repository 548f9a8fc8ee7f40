"""Consent to run native code of files that a diagram names: of certain bytes of a file, for one run of the server."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from symofros.diagrams.external_block import ExternalBlock, NativeCode
from symofros.diagrams.wiring import Wired
from symofros.errors import Problem
from symofros.studio.editor.document.workspace import FileError, digest
from symofros.studio.editor.editing.data_edits import EditError

MAX_STATED = 200  # Characters of what a file states of itself.


class ConsentError(EditError):
    """A diagram would run native code without consent; carries what the user is asked.

    Attributes:
        files: Files that there is no consent to, as the page shows them.
    """

    def __init__(self, problem: Problem, files: list[dict[str, Any]]) -> None:
        super().__init__(problem)
        self.files = files


def native_code(wired: Wired) -> dict[str, NativeCode]:
    """Block -> native code that it runs."""
    found = {name: block.native_code() for name, block in wired.blocks.items() if isinstance(block, ExternalBlock)}
    return {name: code for name, code in found.items() if code is not None}


@dataclass(frozen=True)
class _Seen:
    """A file as it is now."""

    digest: str
    size: int
    owner: str


def _seen(file: str) -> _Seen:
    try:
        data, owner = Path(file).read_bytes(), _owner(file)
    except OSError as error:
        rule, remedy = "native code is read to be asked for", "name another file"
        raise FileError(f"'{file}' can't be read", error.strerror or "", rule, remedy) from None
    return _Seen(digest(data), len(data), owner)


def _owner(file: str) -> str:
    """Account that owns a file, or its number where that has no name."""
    try:
        return Path(file).owner()
    except (KeyError, NotImplementedError):
        return str(os.stat(file).st_uid)


class Consents:
    """What the user has consented to: pairs of a path and the digest of its bytes. A changed file is another one."""

    def __init__(self) -> None:
        self._given: set[tuple[str, str]] = set()

    def of(self, code: Mapping[str, NativeCode]) -> dict[str, str]:
        """Digests by file, for a reader of the diagram.

        Args:
            code: Block -> native code that it runs.

        Raises:
            ConsentError: There is no consent to one of the files as it is now.
            FileError: One can't be read.
        """
        seen = {file: _seen(file) for file in {each.file: None for each in code.values()}}
        missing = [file for file, now in seen.items() if (file, now.digest) not in self._given]
        if missing:
            found = ", ".join(f"block '{name}': {each.file}" for name, each in code.items() if each.file in missing)
            problem = Problem(
                "the diagram would run native code of a file",
                found[:300],
                "native code can do all that you can; it runs with your consent alone, to the bytes of each file",
                "run it again, and consent if you trust who made it",
            )
            raise ConsentError(problem, [_asked(file, seen[file], code) for file in missing])
        return {file: now.digest for file, now in seen.items()}

    def give(self, code: Mapping[str, NativeCode], given: Any) -> None:
        """Take the user's consent.

        Args:
            code: Block -> native code that it runs, of the open diagram.
            given: List of {"path", "digest"}, as the question stated them.

        Raises:
            EditError: It is no such list, the diagram does not run that file, or its bytes are others by now.
            FileError: One can't be read.
        """
        pairs = [_pair(each) for each in given] if isinstance(given, list) else []
        if not pairs:
            raise EditError("consent to nothing", f"{given!r:.100}", "a list of paths and digests", "reload the page")
        for path, stated in pairs:
            if path not in {each.file for each in code.values()}:
                rule = "consent is asked for files that the open diagram runs"
                raise EditError("consent to another file", f"{path!r:.100}", rule, "run the diagram again")
            if _seen(path).digest != stated:
                rule = "consent is to the bytes that were seen"
                raise EditError(f"'{path}' has changed meanwhile", "other bytes", rule, "run the diagram again")
        self._given.update(pairs)


def _pair(given: Any) -> tuple[str, str]:
    """Path and digest of one consent; "" for what is no text, which no file has."""
    stated = given if isinstance(given, dict) else {}
    path, digest_stated = (text if isinstance(text := stated.get(key), str) else "" for key in ("path", "digest"))
    return path, digest_stated


def _asked(file: str, seen: _Seen, code: Mapping[str, NativeCode]) -> dict[str, Any]:
    """A file as the question states it; model, author and tool are what the file itself says."""
    blocks = [name for name, each in code.items() if each.file == file]
    stated = code[blocks[0]]
    said = {"model": stated.model, "author": stated.author, "tool": stated.tool}
    known = {"path": file, "blocks": blocks, "bytes": seen.size, "digest": seen.digest, "owner": seen.owner}
    return known | {key: text[:MAX_STATED] for key, text in said.items()}
