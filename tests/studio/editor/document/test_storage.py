"""Documents and their files: bytes kept, unsaved work recovered, nobody's file overwritten unseen, nothing outside."""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path

import pytest

from symofros.studio.editor.document.document import MAX_TEXT, StaleError
from symofros.studio.editor.document.session import Session
from symofros.studio.editor.document.storage import ConflictError
from symofros.studio.editor.document.workspace import (
    FileError,
    Workspace,
    autosave_of,
    layout_of,
    read_layout,
    read_text,
)
from symofros.studio.editor.editing.data_edits import EditError
from tests.studio.editor.texts import TEXTS

TEXT = TEXTS["four_bar"]


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "bar.yaml"
    path.write_text(TEXT)
    return path


def opened(file: Path) -> Session:
    return Session(Workspace(file.parent), file)


def change(session: Session, value: float = 2.5) -> None:
    edit = {"op": "set", "path": ["parameters", "m", "value"], "value": value}
    session.edit({"revision": session.document.revision, "label": "mass", "edits": [edit]})


def now(session: Session) -> dict[str, int]:
    return {"revision": session.document.revision}


def test_undo_and_redo_restore_the_text_and_the_autosave(file: Path) -> None:
    session = opened(file)
    texts = [session.document.text]
    for value in (2.0, 3.0, 4.0):
        change(session, value)
        texts.append(session.document.text)
        assert autosave_of(file).read_text() == session.document.text
    for text in reversed(texts[:-1]):
        session.undo(now(session))
        assert session.document.text == text
    assert not session.document.dirty and not session.as_json()["can_undo"] and not autosave_of(file).exists()
    assert session.as_json()["redo_label"] == "mass"
    for text in texts[1:]:
        session.redo(now(session))
        assert session.document.text == text
    session.redo(now(session))
    assert session.document.text == texts[-1]
    session.undo(now(session))
    change(session, 5.0)
    assert not session.as_json()["can_redo"]  # A change after undo forgets what was undone.


def test_edits_are_applied_all_or_not_at_all(file: Path) -> None:
    session = opened(file)
    good = {"op": "set", "path": ["parameters", "m", "value"], "value": 2}
    bad = {"op": "remove", "path": ["bodies", "nobody"]}
    with pytest.raises(EditError):
        session.edit({**now(session), "edits": [good, bad]})
    assert session.document.text == TEXT and session.document.revision == 1 and not autosave_of(file).exists()


def test_typed_values_are_kept_as_typed(file: Path) -> None:
    session = opened(file)
    for typed, text in (("8.0e-4", "8.0e-4"), (" 1.50 ", "1.50"), ("L/2", "L/2"), ("true", "true"), ("a, b", "'a, b'")):
        edit = {"op": "set", "path": ["parameters", "m", "value"], "text": typed}
        session.edit({**now(session), "edits": [edit]})
        assert f"m: {{value: {text}, unit: kg}}" in session.document.text


@pytest.mark.parametrize("revision", [0, 2, None, "1", True, 1.0])
def test_a_stale_revision_changes_nothing(file: Path, revision: object) -> None:
    session = opened(file)
    for action in "edit set_text undo redo save discard reload insert_part".split():
        with pytest.raises(StaleError):
            getattr(session, action)({"revision": revision, "edits": [], "text": ""})
    assert session.document.text == TEXT


def test_revisions_do_not_repeat_across_documents(file: Path) -> None:
    session = opened(file)
    change(session)
    (file.parent / "other.yaml").write_text(TEXT)
    revision = session.document.revision
    session.open({"path": "other.yaml"})
    assert session.document.revision > revision
    with pytest.raises(StaleError):
        session.undo({"revision": revision})


@pytest.mark.parametrize("head", ["", "\ufeff"])
@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_saving_writes_the_bytes_that_were_read_but_for_the_edit(file: Path, head: str, newline: str) -> None:
    content = (head + TEXT.replace("\n", newline)).encode()
    file.write_bytes(content)
    session = opened(file)
    session.save(now(session))
    assert file.read_bytes() == content
    change(session)
    session.save(now(session))
    assert file.read_bytes() == content.replace(b"m: {value: 1.0", b"m: {value: 2.5")
    assert not session.document.dirty and not autosave_of(file).exists()


# Recovery.


def test_unsaved_work_is_taken_up_again_and_can_be_discarded(file: Path) -> None:
    change(opened(file))  # And then the server is killed.
    session = opened(file)
    assert session.as_json()["recovered"] and session.document.dirty
    assert "m: {value: 2.5" in session.document.text and file.read_text() == TEXT
    session.discard(now(session))
    assert session.document.text == TEXT and not session.as_json()["recovered"]
    assert not autosave_of(file).exists() and not opened(file).as_json()["recovered"]
    session.undo(now(session))  # Not even then is it lost.
    assert "m: {value: 2.5" in session.document.text


def test_a_new_document_is_recovered_too(tmp_path: Path) -> None:
    session = Session(Workspace(tmp_path))
    session.edit({**now(session), "edits": [{"op": "set", "path": ["parameters", "k"], "value": 3}]})
    again = Session(Workspace(tmp_path))
    assert again.as_json()["recovered"] and again.document.analysis.parameters[0]["name"] == "k"
    again.discard(now(again))
    assert "k" not in again.document.text


def test_unsaved_work_waits_while_another_file_is_open_unless_it_was_given_up(file: Path) -> None:
    (file.parent / "other.yaml").write_text(TEXT)
    session = opened(file)
    change(session)
    session.open({"path": "other.yaml"})
    session.open({"path": file.name})
    assert session.as_json()["recovered"]
    with pytest.raises(FileError):
        session.open({"path": "nothing.yaml", "discard": True})
    assert autosave_of(file).exists() and session.document.dirty
    session.open({"path": file.name, "discard": True})
    assert not session.as_json()["recovered"] and session.document.text == TEXT
    change(session)
    session.create({"path": "new.yaml", "discard": True})
    assert not opened(file).as_json()["recovered"]


def test_an_edit_stands_though_it_could_not_be_kept(file: Path) -> None:
    session = opened(file)
    shutil.rmtree(file.parent)
    change(session)
    found = session.as_json()
    assert "m: {value: 2.5" in found["text"] and "can't be written" in found["unkept"]["object"]
    assert not found["disk_changed"]
    file.parent.mkdir()
    change(session, 3.0)
    assert session.as_json()["unkept"] is None and autosave_of(file).exists()


# Others who write.


def test_a_file_that_somebody_else_wrote_is_not_overwritten(file: Path) -> None:
    session = opened(file)
    change(session)
    assert not session.as_json()["disk_changed"]
    theirs = TEXT.replace("four_bar", "theirs")
    file.write_text(theirs)
    assert session.as_json()["disk_changed"]
    with pytest.raises(ConflictError) as caught:
        session.save(now(session))
    assert caught.value.disk == theirs and file.read_text() == theirs and session.document.dirty
    file.write_text(theirs + "# later\n")
    with pytest.raises(ConflictError):  # Only the state that was seen may be overwritten.
        session.save({**now(session), "over": caught.value.over})
    file.write_text(theirs)
    session.save({**now(session), "over": caught.value.over})
    assert "m: {value: 2.5" in file.read_text() and not session.as_json()["disk_changed"]


def test_the_text_on_disk_can_be_taken_and_given_back(file: Path) -> None:
    session = opened(file)
    change(session)
    ours = session.document.text
    file.write_text(TEXT + "# theirs\n")
    session.reload(now(session))
    assert session.document.text == TEXT + "# theirs\n" and not session.document.dirty
    session.undo(now(session))
    assert session.document.text == ours and session.document.dirty
    session.save(now(session))
    assert file.read_text() == ours


def test_a_touched_or_removed_file_is_not_a_conflict(file: Path) -> None:
    session = opened(file)
    change(session)
    os.utime(file, (1, 1))
    assert not session.as_json()["disk_changed"]
    file.unlink()
    assert not session.as_json()["disk_changed"]
    session.save(now(session))
    assert "m: {value: 2.5" in file.read_text()


def test_saving_elsewhere_goes_on_there_and_does_not_overwrite(file: Path) -> None:
    session = opened(file)
    (file.parent / "there.yaml").write_text("symofros: 1\n")
    with pytest.raises(ConflictError) as caught:
        session.save({**now(session), "path": "there.yaml"})
    assert "there already" in caught.value.problem.what
    session.save({**now(session), "path": "new.yaml"})
    assert (file.parent / "new.yaml").read_text() == TEXT and session.as_json()["path"] == "new.yaml"


# The workspace.


@pytest.mark.parametrize(
    "path",
    [
        *"../x.yaml /etc/x.yaml a/../../x.yaml x.yaml/../../../y.yaml link/x.yaml link.yaml loop.yaml".split(),
        *(".hidden.yaml", ".git/x.yaml", "x.txt", "", "a\0.yaml", "x" * 2000 + ".yaml"),
    ],
)
def test_paths_stay_in_the_workspace(tmp_path: Path, path: str) -> None:
    outside, root = tmp_path / "outside", tmp_path / "root"
    outside.mkdir(), root.mkdir()
    (outside / "x.yaml").write_text(TEXT)
    (root / "link").symlink_to(outside)
    (root / "link.yaml").symlink_to(outside / "x.yaml")
    (root / "loop.yaml").symlink_to(root / "loop.yaml")
    session = Session(Workspace(root))
    for action in (session.open, session.create, lambda body: session.save({**body, **now(session)})):
        with pytest.raises((FileError, EditError)):
            if not path:
                raise EditError("no path")  # An empty path means the document's own file.
            action({"path": path})
    assert (outside / "x.yaml").read_text() == TEXT
    assert [entry["path"] for entry in session.workspace.files()] == []


def test_own_files_that_are_links_are_not_followed(file: Path, tmp_path: Path) -> None:
    secret = tmp_path / "secret"
    secret.write_text("secret: 1\n")
    autosave_of(file).symlink_to(secret)
    layout_of(file).symlink_to(secret)
    session = opened(file)
    assert not session.as_json()["recovered"] and session.storage.layout == {}
    change(session)
    session.place({"positions": {"a": [1, 2]}})
    assert secret.read_text() == "secret: 1\n"


def test_files_are_listed_by_path(tmp_path: Path) -> None:
    for name in "b.yaml sub/a.yml sub/robot.urdf m.xml x.txt .h.yaml .git/c.yaml __pycache__/d.yaml".split():
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_text("x")
    listed = Workspace(tmp_path).files()
    assert [entry["path"] for entry in listed] == ["b.yaml", "m.xml", "sub/a.yml", "sub/robot.urdf"]
    assert listed[0]["bytes"] == 1


@pytest.mark.parametrize(("content", "says"), [(b"\xff\xfe", "not UTF-8"), (b"#" * (MAX_TEXT + 1), "too large")])
def test_files_that_are_not_text_or_too_large_are_refused(file: Path, content: bytes, says: str) -> None:
    session = opened(file)
    (file.parent / "odd.yaml").write_bytes(content)
    with pytest.raises(FileError, match=says):
        session.open({"path": "odd.yaml"})
    assert session.document.file == file


@pytest.mark.parametrize(
    ("text", "says"),
    [("#" * (MAX_TEXT + 1), "too large"), ("\ud800", "half a character"), (3, "not a text"), (None, "not a text")],
)
def test_texts_that_no_file_can_hold_are_refused(file: Path, text: object, says: str) -> None:
    session = opened(file)
    with pytest.raises(EditError, match=says):
        session.set_text({**now(session), "text": text})
    assert session.document.text == TEXT


# Positions.


def test_positions_are_kept_beside_the_file_and_follow_a_renaming(file: Path) -> None:
    session = opened(file)
    session.place(
        {"positions": {"bodies/crank": [1, 2.5], "world": [0, 0], "x": ["a", 1], "y": [1], "z": [float("nan"), 0]}}
    )
    session.place({"positions": {"world": [5, 5]}})
    assert read_layout(file) == {"bodies/crank": [1.0, 2.5], "world": [5.0, 5.0]}
    session.edit({**now(session), "edits": [{"op": "rename", "path": ["bodies", "crank"], "to": "c"}]})
    assert opened(file).storage.layout["bodies/c"] == [1.0, 2.5]


@pytest.mark.parametrize(
    "content", ["", "[]", '{"layout": 3}', "[" * 100_000, json.dumps({"layout": {"a": [1e300, 0]}})]
)
def test_a_damaged_layout_file_is_ignored(file: Path, content: str) -> None:
    layout_of(file).write_text(content)
    assert opened(file).storage.layout == {}


DEEP: list[object] = []
for _ in range(100):
    DEEP = [DEEP]


@pytest.mark.parametrize(
    "edits",
    [
        *(None, {}, [3], [{"op": "eval"}]),
        *([{"op": "set", "path": "a"}], [{"op": "set", "path": [1.5]}]),
        [{"op": "insert", "path": [], "key": 3}],
        [{"op": "move", "path": ["a"], "index": -1}],
        [{"op": "set", "path": ["a"] * 60}],
        [{"op": "set", "path": ["a"], "text": 3}],
        [{"op": "set", "path": ["a"], "value": {"b": [10**400]}}],
        [{"op": "set", "path": ["a"], "value": DEEP}],
    ],
)
def test_malformed_edits_are_refused(file: Path, edits: object) -> None:
    session = opened(file)
    with pytest.raises(EditError, match="malformed"):
        session.edit({**now(session), "edits": edits})


@pytest.mark.parametrize("name", ["a" * 300 + ".yaml", "\u00e4" * 120 + ".yaml", "b" * 250 + "/c.yaml"])
def test_names_that_are_too_long_are_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(FileError, match="too long a name"):
        Workspace(tmp_path).inside(name)


def test_the_kind_of_a_path_that_is_not_a_file_is_named(tmp_path: Path) -> None:
    (tmp_path / "loop.yaml").symlink_to("loop.yaml")
    json.dumps(Session(Workspace(tmp_path), tmp_path / "loop.yaml").as_json(), allow_nan=False)
    os.mkfifo(tmp_path / "pipe.yaml")
    (tmp_path / "folder.yaml").mkdir()
    for name, kind in (("pipe.yaml", "a named pipe"), ("folder.yaml", "a folder"), ("gone.yaml", "no such file")):
        with pytest.raises(FileError, match=kind):
            read_text(tmp_path / name)
