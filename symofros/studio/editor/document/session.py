"""One run of the editor: what each request does to the document, and what it needs of it."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from symofros.description import MODEL_SUFFIXES, System
from symofros.studio.editor.diagrams.grouping import grouped
from symofros.studio.editor.diagrams.native_code import Consents
from symofros.studio.editor.document.document import EditedDocument, StaleError, refuse_text
from symofros.studio.editor.document.examples import take_example
from symofros.studio.editor.document.expressions import check_field
from symofros.studio.editor.document.figures.beam_figures import beam_figures
from symofros.studio.editor.document.figures.inertia_figures import inertia_figures
from symofros.studio.editor.document.parts.parts import insertion
from symofros.studio.editor.document.parts.parts_library import Library
from symofros.studio.editor.document.storage import EMPTY, Storage
from symofros.studio.editor.document.workspace import FileError, Workspace, identifier, read_text, write
from symofros.studio.editor.editing.data_edits import EditError, four_parts
from symofros.studio.editor.editing.requests import edits_of, fields_of, text_of
from symofros.studio.editor.editing.yaml_edits import with_references
from symofros.studio.editor.editing.yaml_rendering import block
from symofros.studio.editor.editing.yaml_spans import yaml_text_of

Json = dict[str, Any]

MECHANISM_JOBS = ("compile", "crosscheck", "simulate", "analyse", "page", "export")
DIAGRAM_JOBS = ("run", "export")
MAX_DEPTH = 10


class Session:
    """What the server holds between requests. Not to be used by two threads at once.

    Raises of all that change the document: StaleError (another revision), EditError (what is asked makes no sense),
    FileError (a file can't be read or written). Nothing has changed then.
    """

    def __init__(self, workspace: Workspace, file: Path | None = None) -> None:
        """Open a file, or begin an empty document."""
        self.workspace = workspace
        self.library = Library(workspace)
        self._consents = Consents()
        self.storage = Storage(workspace, file)
        self._outer: list[Storage] = []  # What was open when somebody went into a model or part of it.

    @property
    def document(self) -> EditedDocument:
        """The document that is open."""
        return self.storage.document

    def shown_system(self, block: str = "") -> System | None:
        """The system that the 3-D view shows; None while the document has problems.

        Args:
            block: Block of a diagram that moves a mechanism; "" for the first one.

        Raises:
            EditError: The diagram has no such block, or moves nothing.
        """
        analysis = self.document.analysis
        if analysis.problems:
            return None
        if analysis.diagram is None:
            return analysis.system
        known = analysis.mechanisms
        chosen = block or next(iter(known), "")
        if chosen not in known:
            listed = ", ".join(known) or "none"
            what, rule = "no mechanism to show", f"blocks that move one: {listed}"
            raise EditError(what, f"'{block[:50]}'", rule, "choose one of them" if known else "add forward dynamics")
        return known[chosen]

    def as_json(self) -> Json:
        """The document as every answer carries it."""
        return {
            "path": self.workspace.shown(self.document.file),
            "trail": [self.workspace.shown(storage.document.file) for storage in self._outer],
            **self.document.as_json(),
            "layout": self.storage.layout,
            "recovered": self.storage.recovered,
            "unkept": four_parts(self.storage.unkept) if self.storage.unkept else None,
            "disk_changed": self.storage.changed_on_disk(),
        }

    # Changing.

    def edit(self, body: Json) -> None:
        """Apply edits, all or none."""
        self.document.expect(body.get("revision"))
        edits = edits_of(body.get("edits"))
        self.document.change(text_of(body, "label")[:200] or "edit", lambda text: with_references(text, edits))
        for edit in edits:
            if edit.op == "rename" and (place := self.storage.layout.get("/".join(map(str, edit.path)))):
                self.storage.place({"/".join(map(str, (*edit.path[:-1], edit.key))): place})
        self.storage.autosave()

    def set_text(self, body: Json) -> None:
        """Replace the whole text."""
        self.document.expect(body.get("revision"))
        self.document.change("edit text", lambda _: refuse_text(body.get("text")))
        self.storage.autosave()

    def undo(self, body: Json) -> None:
        """One step back."""
        self.document.expect(body.get("revision"))
        self.document.undo()
        self.storage.autosave()

    def redo(self, body: Json) -> None:
        """One step forth."""
        self.document.expect(body.get("revision"))
        self.document.redo()
        self.storage.autosave()

    def discard(self, body: Json) -> None:
        """Return to the last saved text, or to the empty document."""
        self.document.expect(body.get("revision", self.document.revision))
        self.storage.discard()

    def reload(self, body: Json) -> None:
        """Take the text on disk."""
        self.document.expect(body.get("revision"))
        self.storage.reload()

    def save(self, body: Json) -> None:
        """Write the document to its own file or to another; ConflictError where that would lose something."""
        self.document.expect(body.get("revision"))
        self.storage.save(text_of(body, "path"), text_of(body, "over"))

    def open(self, body: Json) -> None:
        """Open a file of the workspace; `discard`: the user gave up unsaved changes of the present one."""
        file = self.workspace.inside(text_of(body, "path"))
        self._leave(body, lambda: self.storage.open(file))

    def create(self, body: Json) -> None:
        """Begin a document in a new file of the workspace."""
        file = self.workspace.inside(text_of(body, "path"))
        kind = text_of(body, "kind") or "mechanism"
        if kind not in EMPTY:
            raise EditError("no such kind of document", f"'{kind[:50]}'", f"one of {', '.join(EMPTY)}", "choose one")
        self._leave(body, lambda: self.storage.create(file, kind))

    def enter(self, body: Json) -> None:
        """Go into a model or a part of the open diagram, to come back later; its undo steps are kept meanwhile."""
        self.document.expect(body.get("revision"))
        if len(self._outer) >= MAX_DEPTH:
            raise EditError("the way back is too long", f"{MAX_DEPTH} documents", "at most that many", "go back first")
        file = self.workspace.inside((self.document.file.parent / text_of(body, "path")).as_posix())
        read_text(file)
        inner = Storage(self.workspace, file, self.storage.next_revision)
        self._outer.append(self.storage)
        self.storage = inner

    def leave(self, body: Json) -> None:
        """Return to the diagram that this document was opened from; `discard`: unsaved changes here are given up."""
        self.document.expect(body.get("revision"))
        if not self._outer:
            raise EditError(
                "there is no way back", "the outermost document", "one goes back from inside", "open a file"
            )
        if body.get("discard") is True:
            self.storage.forget()
        inner, self.storage = self.storage, self._outer.pop()
        self.storage.take_up(inner.next_revision)

    def adopt(self, body: Json, name: str, text: str) -> None:
        """Begin a document with a text that came from elsewhere."""
        self._leave(body, lambda: self.storage.adopt(name, text))

    def example(self, body: Json) -> None:
        """Begin a document that says what an example says; what it reads goes into the workspace."""
        name, text = take_example(text_of(body, "name") or "", self.workspace)
        self._leave(body, lambda: self.storage.adopt(name, text, "example"))

    def _leave(self, body: Json, enter: Callable[[], None]) -> None:
        """Go to another document; unsaved changes stay beside their file, unless given up."""
        if body.get("discard") is not True:
            enter()
        else:
            self.storage.forget()
            try:
                enter()
            except FileError:
                self.storage.autosave()  # The user is still here.
                raise
        self._outer.clear()

    def insert_part(self, body: Json) -> None:
        """Put a part into the document, on a frame of a body."""
        self.document.expect(body.get("revision"))
        name = text_of(body, "name")
        parent, frame = text_of(body, "parent") or None, text_of(body, "frame") or None
        edits = insertion(yaml_text_of(self.document.text).data, self.library.part(name), parent, frame)
        self.document.change(f"insert {name}"[:200], lambda text: with_references(text, edits))
        self.storage.autosave()

    def group(self, body: Json) -> None:
        """Put blocks of the diagram into a subsystem: a file of its own beside it, and a part in their place.

        Undo brings the blocks back; the file stays.
        """
        self.document.expect(body.get("revision"))
        name, blocks = text_of(body, "name") or "", body.get("blocks")
        if not isinstance(blocks, list) or not all(isinstance(item, str) for item in blocks):
            raise EditError("blocks of the subsystem", f"{blocks!r:.100}", "a list of ids", "choose some")
        folder = self.document.file.parent
        stem = identifier(name)
        file = next(one for n in range(1, 1000) if not (one := folder / f"{stem}{n if n > 1 else ''}.yaml").exists())
        self.workspace.inside(self.workspace.shown(file))
        inside, edits = grouped(yaml_text_of(self.document.text).data, stem, file.name, blocks)
        write(file, "\n".join([*block(inside, (), 0), ""]))
        self.document.change(f"group into {stem}"[:200], lambda text: with_references(text, edits))
        self.storage.autosave()

    # Beside the document.

    def place(self, body: Json) -> None:
        """Store positions of the named blocks; others keep theirs.

        Raises:
            StaleError: They are of another document than the one that is open: blocks there may have the same names.
        """
        path, here = text_of(body, "path"), self.workspace.shown(self.document.file)
        if path not in ("", here):
            raise StaleError(f"places of blocks of '{path[:100]}'; '{here}' is open")
        self.storage.place(body.get("positions"))

    def keep_part(self, body: Json) -> None:
        """Keep some bodies of the document as a part."""
        self.library.keep(text_of(body, "name"), yaml_text_of(self.document.text).data, body.get("bodies"))

    # Asking.

    def field_checker(self, body: Json) -> Callable[[], Json]:
        """A function that checks texts of fields against the document as it is now, even if it changes later.

        Raises:
            EditError: The fields are no list of mappings, or too many.
        """
        document = self.document
        checks = [
            partial(check_field, document.file, document.text, document.analysis, field.path, field.text, field.draft)
            for field in fields_of(body.get("fields"))
        ]
        return lambda: {"checks": [check() for check in checks]}

    def beam_figures(self, body: Json) -> Json:
        """Section and frequencies of a beam under edit, at the document's parameters."""
        return beam_figures(body.get("beam"), self._known())

    def inertia_figures(self, body: Json) -> Json:
        """Mass, mass centre and moments of a body under edit, at the document's parameters."""
        return inertia_figures(body, self._known())

    def _known(self) -> dict[str, float]:
        parameters = self.document.analysis.parameters
        return {item["name"]: item["number"] for item in parameters if item["number"] is not None}

    def consent(self, body: Json) -> None:
        """Take the user's consent to run native code of files as they are now.

        Raises:
            EditError: It is to another file, or to other bytes.
        """
        self._consents.give(self.document.analysis.native, body.get("files"))

    def job_request(self, body: Json) -> tuple[str, Json, int, str]:
        """The kind of a job, the request for its worker, and the revision and the path of its document.

        Raises:
            ConsentError: A run would need the user's consent to native code.
            EditError: An unknown kind, or options that are no mapping.
            FileError: An export to outside of the workspace.
        """
        kind, options = text_of(body, "kind"), body.get("options") or {}
        document = self.document
        is_diagram = document.analysis.diagram is not None
        jobs = DIAGRAM_JOBS if is_diagram else MECHANISM_JOBS
        if kind not in jobs or not isinstance(options, dict):
            raise EditError(
                "no such job of this document",
                f"{kind!r:.50}",
                f"one of {', '.join(jobs)}; options are a mapping",
                "choose one of them",
            )
        request: Json = {"file": str(document.file), "text": document.text, "options": options}
        if kind == "run":
            request["native"] = self._consents.of(document.analysis.native)
        if kind == "export":
            folder = self.workspace.inside(text_of(options, "folder"), ())
            request |= {"folder": str(folder), "root": str(self.workspace.root), "is_diagram": is_diagram}
        return kind, request, document.revision, self.workspace.shown(document.file)

    def to_import(self, body: Json, folder: Path) -> Path:
        """The file to import: one of the workspace, or the request's text, put into a folder.

        Raises:
            FileError: Neither, or of another format.
        """
        if "path" in body:
            return self.workspace.inside(text_of(body, "path"), MODEL_SUFFIXES)
        file = Workspace(folder).inside(Path(text_of(body, "name")).name, MODEL_SUFFIXES)
        write(file, refuse_text(body.get("text")))
        return file
