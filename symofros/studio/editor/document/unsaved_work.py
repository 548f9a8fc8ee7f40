"""Unsaved work on a file, kept beside it: its text, and which state of the file it was based on."""

from __future__ import annotations

import json
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from symofros.studio.editor.document.workspace import (
    FileError,
    autosave_of,
    base_of,
    read_own,
    signature,
    write,
)

UNKNOWN_BASE = "unknown"  # No digest is that: what was based on it differs from every file.


class Recovered(NamedTuple):
    """Unsaved work that was found.

    Attributes:
        text: What it says.
        base: Digest of the file that it was based on; "" where there was none, `UNKNOWN_BASE` where nothing says.
    """

    text: str
    base: str


class UnsavedWork:
    """What one server keeps of its unsaved work on one file; what another server keeps there is left alone."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self._text: str | None = None  # What lies there, as far as this server knows.
        self._signature = ""

    def recover(self) -> Recovered | None:
        """Work that an earlier server left; None where there is none of this file."""
        autosave = autosave_of(self.file)
        try:
            text = read_own(autosave)
        except FileError:
            self._text, self._signature = None, signature(autosave)
            return None
        name, base = self._stated_base()
        if name != self.file.name:  # arm.yml beside arm.yaml.
            return None
        self._text, self._signature = text, signature(autosave)
        return Recovered(text, base)

    def _stated_base(self) -> tuple[str, str]:
        """The name of the file that work lies there of, and the digest that it was based on."""
        try:
            stated = json.loads(read_own(base_of(self.file)))
            return str(stated["file"]), str(stated["based_on"])
        except (FileError, ValueError, KeyError, TypeError, RecursionError):
            return self.file.name, UNKNOWN_BASE

    def keep(self, text: str, base: str) -> None:
        """Store unsaved work: its text, and the digest of the file that it is based on.

        Args:
            text: The document.
            base: Digest of the file that it is based on; "" where there was none.

        Raises:
            FileError: It can't be written, or another server keeps its own there.
        """
        self._refuse_others()
        if self._stated_base() != (self.file.name, base) or not base_of(self.file).exists():
            stated = {"file": self.file.name, "based_on": base}
            write(base_of(self.file), json.dumps(stated, indent=1) + "\n")
        autosave = autosave_of(self.file)
        write(autosave, text)
        self._text, self._signature = text, signature(autosave)

    def _refuse_others(self) -> None:
        if not self._is_others():
            return
        raise FileError(
            f"unsaved work on '{self.file.name}' is not kept",
            "another editor keeps unsaved work there",
            "unsaved work of another editor is not overwritten",
            "Save it under another name, or close the other editor",
        )

    def _is_others(self) -> bool:
        """Whether the stored text was written by another server since it was read or written here."""
        autosave = autosave_of(self.file)
        now = signature(autosave)
        if now in ("", self._signature):
            return False
        try:
            return read_own(autosave) != self._text
        except FileError:
            return False

    def forget(self) -> None:
        """Delete stored unsaved work, unless another server wrote it."""
        if self._is_others():
            return
        with suppress(OSError):  # It is not there, or can't be removed; then it is offered again, and can be discarded.
            autosave_of(self.file).unlink()
        with suppress(OSError):
            base_of(self.file).unlink()
        self._text, self._signature = None, ""
