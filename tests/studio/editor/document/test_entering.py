"""Going from a diagram into a model of it, and back."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from symofros.studio.editor.document.session import Session
from symofros.studio.editor.document.workspace import FileError, Workspace
from symofros.studio.editor.editing.data_edits import EditError
from tests.studio.editor.texts import FILES

TEXT = "symofros_diagram: 1\nmodels: {arm: {file: arm.yaml}}\nblocks: {tip: {kind: forward_dynamics, model: arm}}\n"


@pytest.fixture
def inside(tmp_path: Path) -> Session:
    shutil.copy(FILES["double_pendulum"], tmp_path / "arm.yaml")
    (tmp_path / "d.yaml").write_text(TEXT)
    session = Session(Workspace(tmp_path), tmp_path / "d.yaml")
    edit = {"op": "rename", "path": ["blocks", "tip"], "to": "plant"}
    session.edit({"revision": session.document.revision, "edits": [edit]})
    session.enter({"revision": session.document.revision, "path": "arm.yaml"})
    return session


def test_the_way_back_leads_to_the_diagram_as_it_was_with_its_undo(inside: Session) -> None:
    shown = inside.as_json()
    assert (shown["path"], shown["trail"], shown["diagram"]) == ("arm.yaml", ["d.yaml"], None)
    inner = inside.document.revision
    inside.leave({"revision": inner})
    assert inside.document.revision > inner and "plant:" in inside.document.text
    inside.undo({"revision": inside.document.revision})
    assert inside.document.text == TEXT and inside.as_json()["trail"] == []


def test_the_diagram_is_checked_against_the_model_as_it_was_saved(inside: Session) -> None:
    assert inside._outer[0].document.analysis.problems == []
    text = inside.document.text.replace("kind: revolute", "kind: revolving", 1)
    inside.set_text({"revision": inside.document.revision, "text": text})
    inside.save({"revision": inside.document.revision})
    inside.leave({"revision": inside.document.revision})
    assert any("revolving" in problem["found"] for problem in inside.document.analysis.problems)


def test_entering_stays_within_document_and_folder(inside: Session) -> None:
    for path in ("../arm.yaml", "/etc/passwd", "none.yaml", ".hidden.yaml"):
        with pytest.raises(FileError):
            inside.enter({"revision": inside.document.revision, "path": path})
    inside.leave({"revision": inside.document.revision})
    with pytest.raises(EditError, match="no way back"):
        inside.leave({"revision": inside.document.revision})


def test_another_file_ends_the_trail(inside: Session) -> None:
    inside.open({"path": "arm.yaml"})
    assert inside.as_json()["trail"] == []
