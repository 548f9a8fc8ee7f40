"""The document that is being edited: its text, what can be undone, and what it was on disk."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

from symofros.errors import Problem, SymofrosError
from symofros.studio.editor.document.analysis import analyse
from symofros.studio.editor.document.meaning import Analysis
from symofros.studio.editor.editing.data_edits import EditError

BOM = "\ufeff"
# What is read again after each edit; a file of a thousand bodies is a third of it.
MAX_TEXT = 1 << 20
MAX_STEPS = 500
MAX_KEPT = 64 << 20  # Characters of the texts that undo and redo keep.


class StaleError(SymofrosError):
    """An edit of a revision that is not the document's any more."""


class UndoStep(NamedTuple):
    """A text to go back or forth to, and the name of the edit in between."""

    label: str
    text: str


class EditedDocument:
    """A text under edit.

    Attributes:
        file: Path of the document, or the one it will be saved to.
        text: The text, without a byte order mark.
        saved: The text on disk when it was last read or written; None if it was never there.
        revision: Grows with every change of the text.
        step: How many edits are in force: a new or repeated one adds one, one that is undone takes it away.
    """

    def __init__(self, file: Path, text: str, saved: str | None, *, marked: bool = False, revision: int = 1) -> None:
        """Begin with a text; `marked`: the file begins with a byte order mark."""
        self.file, self.text, self.saved, self.marked = file, text, saved, marked
        self.revision, self.step = revision, 0
        self._undo: list[UndoStep] = []
        self._redo: list[UndoStep] = []
        self._analysis: Analysis | None = None
        self._readable: Analysis | None = None

    @property
    def dirty(self) -> bool:
        """Whether the text differs from the last saved one."""
        return self.text != self.saved

    @property
    def content(self) -> bytes:
        """Bytes of the file, with a byte order mark if it begins with one."""
        return ((BOM if self.marked else "") + self.text).encode("utf-8")

    @property
    def analysis(self) -> Analysis:
        """Analysis of the text, cached until the text changes."""
        if self._analysis is None:
            self._analysis = analyse(self.file, self.text)
            if self._analysis.readable:
                self._readable = self._analysis
        return self._analysis

    def read_again(self, revision: int) -> None:
        """Drop the analysis, as files that the text refers to have changed; the document gets a new revision."""
        self.revision, self._analysis = revision, None

    def expect(self, revision: Any) -> None:
        """Refuse a change of another revision.

        Raises:
            StaleError: It is another one.
        """
        if type(revision) is not int or revision != self.revision:
            raise StaleError(f"revision {revision}; the document is at {self.revision}")

    def change(self, label: str, make: Callable[[str], str]) -> None:
        """Put the text that `make` makes of this one in its place; it can be undone.

        Raises:
            EditError: The new text is too large, or holds what is not text.
        """
        text = refuse_text(make(self.text))
        if text != self.text:
            self._undo.append(UndoStep(label, self.text))
            self._redo.clear()
            self.step += 1
            self._keep_bounds()
            self._become(text)

    def undo(self) -> None:
        """Go one step back, if there is one."""
        self._swap(self._undo, self._redo, -1)

    def redo(self) -> None:
        """Go one step forth, if there is one."""
        self._swap(self._redo, self._undo, 1)

    def _swap(self, source: list[UndoStep], target: list[UndoStep], by: int) -> None:
        if source:
            self.step += by
            step = source.pop()
            target.append(UndoStep(step.label, self.text))
            self._become(step.text)

    def _become(self, text: str) -> None:
        self.analysis  # noqa: B018  The last readable one is kept for when the new text is not.
        self.text = text
        self.revision += 1
        self._analysis = None

    def _keep_bounds(self) -> None:
        kept = sum(len(step.text) for step in self._undo)
        while len(self._undo) > MAX_STEPS or (kept > MAX_KEPT and len(self._undo) > 1):
            kept -= len(self._undo.pop(0).text)

    def as_json(self) -> dict[str, Any]:
        """The document as JSON for the page; its data are a mapping, whatever the text is."""
        now = self.analysis
        readable = now if now.readable else self._readable or now
        return {
            "name": self.file.name,
            "revision": self.revision,
            "dirty": self.dirty,
            "step": self.step,
            "can_undo": bool(self._undo),
            "can_redo": bool(self._redo),
            "undo_label": self._undo[-1].label if self._undo else "",
            "redo_label": self._redo[-1].label if self._redo else "",
            "text": self.text,
            "data": readable.data if isinstance(readable.data, dict) else {},
            "graph": readable.graph,
            "diagram": readable.diagram,
            "problems": now.problems,
            "parameters": readable.parameters,
            "inputs": readable.inputs,
            "lines": now.lines,
        }


def refuse_text(text: Any) -> str:
    """The text, if it can be a document's.

    Raises:
        EditError: Not a text, too large, or with half a surrogate pair.
    """
    if not isinstance(text, str):
        raise EditError("the text is not a text", type(text).__name__, "a document is text", "send a string")
    try:
        size = len(text.encode("utf-8"))
    except UnicodeEncodeError:
        raise EditError(
            "the text holds half a character", "a lone surrogate", "files are in UTF-8", "remove it"
        ) from None
    if size > MAX_TEXT:
        raise EditError(too_large(size))
    return text.removeprefix(BOM)


def too_large(size: int) -> Problem:
    """The problem of a text with more bytes than the editor accepts."""
    return Problem(
        "the text is too large to edit", f"{size} bytes", f"at most {MAX_TEXT} bytes", "split it, and use include"
    )
