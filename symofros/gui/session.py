"""One run of the editor: a workspace, the document that is open, and what each request does to them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from symofros.errors import Problem, SymofrosError
from symofros.gui.document import BOM, Document, refuse_text
from symofros.gui.edits import with_references
from symofros.gui.expressions import check_field
from symofros.gui.library import Library
from symofros.gui.parts import insertion
from symofros.gui.plain import EditError
from symofros.gui.requests import edits_of, path_of
from symofros.gui.sheet import Sheet
from symofros.gui.workspace import (
    READABLE,
    FileError,
    Workspace,
    autosave_of,
    digest,
    identifier,
    layout_of,
    positions,
    read_layout,
    read_text,
    write,
)

Json = dict[str, Any]

JOBS = ("compile", "crosscheck", "simulate", "export")
EMPTY = "symofros: 1\nsystem: {{name: {name}, gravity: [0, 0, -9.81]}}\nparameters: {{}}\nbodies: {{}}\n"


class ConflictError(SymofrosError):
    """The file on disk is not the one that was opened; carries what the answer says."""

    def __init__(self, problem: Problem, disk: str, over: str) -> None:
        self.problem, self.disk, self.over = problem, disk, over
        super().__init__(str(problem))


class Session:
    """What the server holds between requests. Not to be used by two threads at once."""

    def __init__(self, workspace: Workspace, file: Path | None = None) -> None:
        """Open a file, or begin an empty document."""
        self.workspace = workspace
        self.library = Library(workspace)
        self.recovered = False
        self.on_disk = ""  # Digest of the file's bytes when it was last read or written.
        self.layout: dict[str, list[float]] = {}
        self.document: Document
        if file is None:
            self.begin(workspace.root / _unused(workspace.root))
        elif file.exists():
            self.open(file)
        else:
            self.begin(file)

    def as_json(self) -> Json:
        """The document as every answer carries it."""
        return {
            "path": self.workspace.shown(self.document.file),
            **self.document.as_json(),
            "layout": self.layout,
            "recovered": self.recovered,
        }

    # Opening.

    def open(self, file: Path) -> None:
        """Open a file; unsaved work on it, left by a server that was killed, is taken up again."""
        text, data = read_text(file)
        self.document = Document(file, text, text, marked=data.startswith(BOM.encode()))
        self.on_disk, self.layout = digest(data), read_layout(file)
        self._recover()

    def begin(self, file: Path) -> None:
        """Begin a file that is not there yet."""
        self.document = Document(file, EMPTY.format(name=identifier(file.stem)), None)
        self.on_disk, self.layout = "", read_layout(file)
        self._recover()

    def create(self, file: Path) -> None:
        """Begin a new file.

        Raises:
            FileError: There is one of that name, or its folder is missing.
        """
        if file.exists() or not file.parent.is_dir():
            found = "a file of that name" if file.exists() else "no such folder"
            raise FileError(Problem(f"'{file.name}' can't be begun", found, "a new file has a name of its own",
                                    "choose another name"))  # fmt: skip
        self.begin(file)

    def _recover(self) -> None:
        self.recovered = False
        try:
            text, _ = read_text(autosave_of(self.document.file))
        except FileError:
            return
        if text != self.document.text:
            self.document.change("recovered work", lambda _: text)
            self.recovered = True

    def discard(self) -> None:
        """Go back to the file as it was saved; what was discarded can be had back by undo."""
        saved = self.document.saved
        if saved is not None:
            self.document.change("discard", lambda _: saved)
        elif self.recovered:
            self.document.undo()
        self.recovered = False
        self._autosave()

    def open_named(self, body: Json) -> None:
        """Open a file of the workspace."""
        self.open(self.workspace.inside(str(body.get("path", ""))))

    def create_named(self, body: Json) -> None:
        """Begin a file of the workspace."""
        self.create(self.workspace.inside(str(body.get("path", ""))))

    def adopt(self, stem: str, text: str) -> None:
        """Begin a new document with a text that came from elsewhere; it takes a free name."""
        stem = identifier(Path(stem).stem)
        self.begin(self.workspace.root / _unused(self.workspace.root, stem))
        self.document.change("import", lambda _: text)
        self._autosave()

    # Changing.

    def edit(self, body: Json) -> None:
        """Apply edits, all or none."""
        self.document.expect(body.get("revision"))
        edits = edits_of(body.get("edits"))
        label = str(body.get("label", "edit"))[:200]
        self.document.change(label, lambda text: with_references(text, edits))
        for edit in edits:
            if edit.op == "rename" and (place := self.layout.get("/".join(map(str, edit.path)))):
                self.layout["/".join(map(str, (*edit.path[:-1], edit.key)))] = place
        self._autosave()

    def set_text(self, body: Json) -> None:
        """Replace the whole text."""
        self.document.expect(body.get("revision"))
        text = body.get("text")
        refuse_text(text)
        self.document.change("text", lambda _: str(text))
        self._autosave()

    def undo(self, body: Json) -> None:
        """One step back."""
        self.document.expect(body.get("revision"))
        self.document.undo()
        self._autosave()

    def redo(self, body: Json) -> None:
        """One step forth."""
        self.document.expect(body.get("revision"))
        self.document.redo()
        self._autosave()

    def place(self, body: Json) -> None:
        """Remember where blocks are; of those that are named."""
        self.layout |= positions(body.get("positions"))
        self._write_layout()

    def _autosave(self) -> None:
        file = autosave_of(self.document.file)
        if self.document.dirty:
            write(file, self.document.text)
        else:
            file.unlink(missing_ok=True)

    def _write_layout(self) -> None:
        write(layout_of(self.document.file), json.dumps({"layout": self.layout}, indent=1, sort_keys=True) + "\n")

    # Parts.

    def keep_part(self, body: Json) -> None:
        """Keep some bodies of the document as a part."""
        self.library.keep(str(body.get("name", "")), Sheet(self.document.text).root.plain(), body.get("bodies"))

    def insert_part(self, body: Json) -> None:
        """Put a part into the document, on a frame of a body."""
        self.document.expect(body.get("revision"))
        name = str(body.get("name", ""))
        parent, frame = (str(body[key]) if body.get(key) else None for key in ("parent", "frame"))
        edits = insertion(Sheet(self.document.text).root.plain(), self.library.part(name), parent, frame)
        self.document.change(f"insert {name}"[:200], lambda text: with_references(text, edits))
        self._autosave()

    # Asking.

    def check_field(self, body: Json) -> Json:
        """What is to say about one field's text."""
        document = self.document
        return check_field(document.file, document.text, document.analysis, path_of(body.get("path", [])),
                           body.get("text"))  # fmt: skip

    def job_request(self, body: Json) -> tuple[str, Json]:
        """The kind of a job, and what its worker needs.

        Raises:
            EditError: An unknown kind, or options that are no mapping.
            FileError: An export to outside of the workspace.
        """
        kind, options = body.get("kind"), body.get("options") or {}
        if kind not in JOBS or not isinstance(options, dict):
            raise EditError(Problem("no such job", f"{kind!r:.50}", f"one of {', '.join(JOBS)}; options are a mapping",
                                    "choose one of them"))  # fmt: skip
        document = self.document
        request: Json = {"file": str(document.file), "text": document.text, "options": options}
        if kind == "export":
            folder = self.workspace.inside(str(options.get("folder", "")), ())
            request |= {"folder": str(folder), "root": str(self.workspace.root)}
        return kind, request

    def to_import(self, body: Json, folder: Path) -> Path:
        """The file to import: one of the workspace, or the request's text, put into a folder.

        Raises:
            FileError: Neither, or of another format.
        """
        if "path" in body:
            return self.workspace.inside(str(body["path"]), READABLE)
        refuse_text(body.get("text"))
        name = Path(str(body.get("name", ""))).name
        file = Workspace(folder).inside(name, READABLE)
        write(file, str(body["text"]))
        return file

    # Saving.

    def save(self, body: Json) -> None:
        """Write the document, to its own file or to another.

        Raises:
            StaleError: Another revision.
            ConflictError: The file is not as it was when it was opened; `over` says which state may be overwritten.
        """
        self.document.expect(body.get("revision"))
        before, file = self.document.file, self.document.file
        if body.get("path"):
            file = self.workspace.inside(str(body["path"]))
        known = self.on_disk if file == before else ""
        self._refuse_conflict(file, known, body.get("over"))
        write(file, self.document.content)
        autosave_of(before).unlink(missing_ok=True)
        self.document.moved(file)
        self.on_disk, self.recovered = digest(self.document.content), False
        if self.layout:
            self._write_layout()

    def _refuse_conflict(self, file: Path, known: str, over: Any) -> None:
        try:
            disk, data = read_text(file)
        except FileError:
            if file.exists():
                raise
            return  # Removed, or not there yet: nothing can be lost.
        there = digest(data)
        if there in (known, over) or data == self.document.content:
            return
        raise ConflictError(
            Problem(f"'{file.name}' has changed on disk" if known else f"'{file.name}' is there already",
                    "another text", "a file is overwritten only in the state that you saw",
                    "compare the two texts; overwrite, or take the other"), disk, there)  # fmt: skip


def _unused(folder: Path, stem: str = "untitled") -> str:
    """The first free name for a document that has none; an untitled one with unsaved work is free to go on with."""
    for n in range(1, 1000):
        name = f"{stem}{n if n > 1 else ''}.yaml"
        taken = (folder / name).exists() or (stem != "untitled" and autosave_of(folder / name).exists())
        if not taken:
            return name
    raise EditError(Problem("no free name", f"999 files '{stem}'", "a document has a file name", "give one"))
