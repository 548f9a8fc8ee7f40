"""The open document and its files: opened, kept while it is unsaved, recovered, saved; nothing is lost on the way."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from symofros.errors import Problem, SymofrosError
from symofros.studio.editor.document.document import BOM, MAX_TEXT, EditedDocument, too_large
from symofros.studio.editor.document.unsaved_work import UnsavedWork
from symofros.studio.editor.document.workspace import (
    FileError,
    Workspace,
    autosave_of,
    digest,
    identifier,
    layout_of,
    positions,
    read_layout,
    read_text,
    signature,
    write,
)

# What a new document of each kind says.
EMPTY = {
    "mechanism": "symofros: 1\nsystem: {{name: {name}, gravity: [0, 0, -9.81]}}\nparameters: {{}}\nbodies: {{}}\n",
    "diagram": "symofros_diagram: 1\nname: {name}\nmodels: {{}}\nblocks: {{}}\n",
}


class ConflictError(SymofrosError):
    """The file on disk is not the one that was opened; carries what the answer says.

    Attributes:
        disk: The text on disk.
        over: The digest of the file: a save that names it may overwrite this state, and no other.
    """

    def __init__(self, problem: Problem, disk: str, over: str) -> None:
        super().__init__(problem)
        self.disk, self.over = disk, over


class Storage:
    """One document at a time.

    Attributes:
        document: The one that is open.
        layout: Positions of its blocks.
        recovered: Whether it is unsaved work of a server that was killed.
        unkept: Why unsaved work could not be kept; None where it is.
    """

    def __init__(self, workspace: Workspace, file: Path | None, revision: int = 1) -> None:
        """Open a file; begin it if it is not there; None: begin one without a name.

        Raises:
            FileError: It can't be read.
        """
        self.workspace = workspace
        self.document: EditedDocument
        self.layout: dict[str, list[float]] = {}
        self.recovered = False
        self.unkept: Problem | None = None
        self._seen = ""  # Digest of the file when it was last read or written; "" where there was none.
        self._base = ""  # Digest of the file that the text is based on: that of recovered work may be an older one.
        self._signature = ""
        self._revision = revision
        if file is None:
            file = self._unused("untitled")
        if file.exists():
            self.open(file)
        else:
            self.begin(file)

    def open(self, file: Path) -> None:
        """Open a file; unsaved work on it, left by a server that was killed, is taken up again.

        Raises:
            FileError: It can't be read.
        """
        text, data = read_text(file)
        if len(data) > MAX_TEXT:
            raise FileError(too_large(len(data)))
        marked = data.startswith(BOM.encode())
        self._become(EditedDocument(file, text, text, marked=marked, revision=self._revision), digest(data))

    def begin(self, file: Path, kind: str = "mechanism") -> None:
        """Begin a file that is not there yet, with an empty document of a kind."""
        empty = EMPTY[kind].format(name=identifier(file.stem))
        self._become(EditedDocument(file, empty, None, revision=self._revision), "")

    def create(self, file: Path, kind: str = "mechanism") -> None:
        """Begin a new file with an empty document of a kind.

        Raises:
            FileError: There is one of that name, or its folder is missing.
        """
        if file.exists() or not file.parent.is_dir():
            obstacle = "a file of that name" if file.exists() else "no such folder"
            raise FileError(
                f"'{file.name}' can't be begun", obstacle, "a new file has a name of its own", "choose another name"
            )
        self.begin(file, kind)

    def adopt(self, name: str, text: str, label: str = "import") -> None:
        """Begin a new document with a text that came from elsewhere; it takes a free name."""
        self.begin(self._unused(identifier(Path(name).stem)))
        self.document.change(label, lambda _: text)
        self.autosave()

    def _become(self, document: EditedDocument, seen: str) -> None:
        self.document, self._seen, self._base, self.recovered = document, seen, seen, False
        self._signature, self.layout = signature(document.file), read_layout(document.file)
        self._unsaved = UnsavedWork(document.file)
        found = self._unsaved.recover()
        if found is not None and found.text != document.text:
            document.change("recovered work", lambda _: found.text)
            self.recovered, self._base, self._signature = True, found.base, ""
        self.note_revision()

    @property
    def next_revision(self) -> int:
        """A revision that no document here has had."""
        return max(self._revision, self.document.revision) + 1

    def take_up(self, revision: int) -> None:
        """Go on with a document that was put aside: files that it refers to may have changed meanwhile."""
        self.document.read_again(revision)
        self.note_revision()

    def note_revision(self) -> None:
        """No later document may have a revision of an earlier one: a page that shows that would edit this."""
        self._revision = self.next_revision

    def _unused(self, stem: str) -> Path:
        """A free name; an untitled document with unsaved work is there to go on with."""
        for n in range(1, 1000):
            file = self.workspace.root / f"{stem}{n if n > 1 else ''}.yaml"
            if not file.exists() and (stem == "untitled" or not autosave_of(file).exists()):
                return file
        raise FileError("no free name", f"999 files '{stem}'", "a document has a file name", "give one")

    # While it is open.

    def autosave(self) -> None:
        """Store unsaved changes in case the server is killed; delete what is stored if there are none.

        Where that fails (a full disk, a folder that is gone) the edit stands nevertheless, and the page says so.
        """
        self.unkept = None
        try:
            if self.document.dirty:
                self._unsaved.keep(self.document.text, self._base)
            else:
                self._base = self._seen  # Undone as far as the text that was read: the user has seen it.
                self.forget()
        except FileError as error:
            self.unkept = error.problem
        self.note_revision()

    def place(self, data: Any) -> None:
        """Store positions: name -> [x, y]; those of other names are kept."""
        self.layout |= positions(data)
        self._write_layout()

    def _write_layout(self) -> None:
        try:
            write(layout_of(self.document.file), json.dumps({"layout": self.layout}, indent=1, sort_keys=True) + "\n")
        except FileError as error:
            self.unkept = error.problem

    def changed_on_disk(self) -> bool:
        """Whether the file on disk differs from the content that the text here is based on."""
        now = signature(self.document.file)
        if now == self._signature:
            return False
        try:
            same = digest(read_text(self.document.file)[1]) == self._base
        except FileError:
            same = now == ""  # What was removed can't be in conflict.
        if same:
            self._signature = now
        return not same

    def reload(self) -> None:
        """Replace the text by the file on disk; undo restores the replaced text.

        Raises:
            FileError: It can't be read.
        """
        text, data = read_text(self.document.file)
        self.document.change("take the file from disk", lambda _: text)
        self._saved(data)
        self.autosave()

    def discard(self) -> None:
        """Return to the last saved text, or to the empty document; undo restores the discarded text."""
        saved = self.document.saved
        kind = "mechanism" if self.document.analysis.diagram is None else "diagram"
        empty = EMPTY[kind].format(name=identifier(self.document.file.stem))
        self.document.change("discard", lambda _: empty if saved is None else saved)
        self.recovered, self._base = False, self._seen
        self.forget()
        self.note_revision()

    def forget(self) -> None:
        """Delete stored unsaved work."""
        self._unsaved.forget()

    # Saving.

    def save(self, path: str, over: str) -> None:
        """Write the document.

        Args:
            path: Path in the workspace; "": the document's own file.
            over: Digest of a state of the file that may be overwritten, besides the one that is known.

        Raises:
            ConflictError: The file is in another state.
            FileError: It can't be written, or there is unsaved work on that other file.
        """
        before = self.document.file
        file = self.workspace.inside(path) if path else before
        self._refuse_conflict(file, self._base if file == before else "", over)
        if file != before:
            self._refuse_unsaved(file)
        content = self.document.content
        write(file, content)
        self.forget()
        self.document.file = file
        if file != before:
            self._unsaved = UnsavedWork(file)
        self._saved(content)
        if self.layout:
            self._write_layout()

    def _saved(self, content: bytes) -> None:
        self.document.saved = self.document.text
        self._seen = self._base = digest(content)
        self.recovered = False
        self._signature = signature(self.document.file)

    def _refuse_conflict(self, file: Path, known: str, over: str) -> None:
        if not file.exists():
            return
        disk, data = read_text(file)
        there = digest(data)
        if there in (known, over) or data == self.document.content:
            return
        begun = " than the recovered work began with" if self.recovered and file == self.document.file else ""
        raise ConflictError(
            Problem(
                f"'{file.name}' has changed on disk" if known else f"'{file.name}' is there already",
                f"another text{begun}",
                "a file is overwritten only in the state that you saw",
                "compare the two texts; overwrite, or take the other",
            ),
            disk,
            there,
        )

    def _refuse_unsaved(self, file: Path) -> None:
        """Refuse to save to another file that has unsaved work, which would be offered over this document."""
        found = UnsavedWork(file).recover()
        if found is None or found.text == self.document.text:
            return
        raise FileError(
            f"'{file.name}' has unsaved work of its own",
            f"'{autosave_of(file).name}'",
            "a document is saved over no unsaved work on another file",
            f"choose another name, or open '{file.name}' and save or discard that work",
        )
