"""Each example opens, has no problems, and has its picture; nothing of the user's is overwritten."""

from __future__ import annotations

from pathlib import Path

import pytest
from PIL import Image

import symofros.studio.editor
from symofros.studio.editor.document.examples import EXAMPLES, listed
from symofros.studio.editor.document.session import Session
from symofros.studio.editor.document.workspace import FileError, Workspace
from symofros.studio.editor.editing.data_edits import EditError
from symofros.studio.editor.example_pictures import SIZE

GUI = Path(symofros.studio.editor.__file__).parent


@pytest.mark.parametrize("name", [each.name for each in EXAMPLES])
def test_an_example_becomes_a_document_without_problems(tmp_path: Path, name: str) -> None:
    session = Session(Workspace(tmp_path))
    session.example({"name": name})
    assert session.document.file.stem == name and session.document.analysis.problems == []
    kind = next(each["kind"] for each in listed() if each["name"] == name)
    assert (session.document.analysis.diagram is not None) == (kind == "diagram")
    for folder in (GUI / "page" / "public", GUI / "static"):
        assert Image.open(folder / "examples" / f"{name}.png").size == SIZE
    session.example({"name": name, "discard": True})  # Its models are there already, and the same.


def test_a_dozen_are_offered_of_both_kinds() -> None:
    kinds = [each["kind"] for each in listed()]
    assert len(kinds) >= 12 and kinds.count("diagram") >= 3


def test_a_file_of_the_user_is_not_overwritten(tmp_path: Path) -> None:
    mine = tmp_path / "rigid" / "cart_pole.yaml"
    mine.parent.mkdir()
    mine.write_text("mine")
    session = Session(Workspace(tmp_path))
    with pytest.raises(FileError, match="another file of that name"):
        session.example({"name": "balance"})
    assert mine.read_text() == "mine" and session.document.file.stem == "untitled"
    with pytest.raises(EditError, match="no such example"):
        session.example({"name": "../rigid/car"})
