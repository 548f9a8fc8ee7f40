"""Unsaved work, and files that are newer than what it was based on: nothing is overwritten that nobody has seen."""

from __future__ import annotations

from pathlib import Path

import pytest

from symofros.studio.editor.document.session import Session
from symofros.studio.editor.document.storage import ConflictError
from symofros.studio.editor.document.workspace import FileError, autosave_of, base_of
from tests.studio.editor.document.test_storage import TEXT, change, now, opened
from tests.studio.editor.texts import TEXTS

THEIRS = TEXT + "# by hand\n"
# How the unsaved work comes back to an editor: a server of its own, or the same that looked at another file.
RETURNS = ("a new server", "the same server")


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "bar.yaml"
    path.write_text(TEXT)
    (tmp_path / "other.yaml").write_text(TEXT)
    return path


def recovered_over(file: Path, theirs: str, how: str) -> Session:
    """A session that took up unsaved work on a file that was changed meanwhile."""
    session = opened(file)
    change(session)
    if how == "the same server":
        session.open({"path": "other.yaml"})
    file.write_text(theirs)
    if how == "the same server":
        session.open({"path": file.name})
        return session
    return opened(file)


@pytest.mark.parametrize("how", RETURNS)
def test_recovered_work_does_not_overwrite_a_file_that_is_newer(file: Path, how: str) -> None:
    session = recovered_over(file, THEIRS, how)
    assert session.as_json()["recovered"] and session.as_json()["disk_changed"]
    with pytest.raises(ConflictError) as caught:
        session.save(now(session))
    assert file.read_text() == THEIRS and caught.value.disk == THEIRS
    assert "has changed on disk" in caught.value.problem.what and "recovered work" in caught.value.problem.found
    session.save({**now(session), "over": caught.value.over})
    assert "value: 2.5" in file.read_text() and not session.as_json()["disk_changed"]


@pytest.mark.parametrize("how", RETURNS)
def test_a_second_server_killed_on_the_way_does_not_make_the_file_known(file: Path, how: str) -> None:
    change(recovered_over(file, THEIRS, how), 3.0)  # Which is killed, too.
    session = opened(file)
    assert "value: 3.0" in session.document.text
    with pytest.raises(ConflictError):
        session.save(now(session))
    assert file.read_text() == THEIRS


@pytest.mark.parametrize("back", ["discard", "undo", "reload"])
def test_saving_is_allowed_after_returning_to_the_newer_file(file: Path, back: str) -> None:
    session = recovered_over(file, THEIRS, "a new server")
    getattr(session, back)(now(session))
    assert session.document.text == THEIRS and not session.as_json()["disk_changed"]
    change(session)
    session.save(now(session))
    assert file.read_text().endswith("# by hand\n") and "value: 2.5" in file.read_text()


def test_work_on_a_file_that_did_not_change_is_saved_unasked(file: Path) -> None:
    session = recovered_over(file, TEXT, "a new server")
    assert session.as_json()["recovered"] and not session.as_json()["disk_changed"]
    session.save(now(session))
    assert "value: 2.5" in file.read_text()
    assert not autosave_of(file).exists() and not base_of(file).exists()


def test_a_new_document_does_not_overwrite_a_file_that_came_meanwhile(tmp_path: Path) -> None:
    file = tmp_path / "new.yaml"
    session = opened(file)
    session.set_text({**now(session), "text": TEXT})
    file.write_text(THEIRS)
    session = opened(file)
    with pytest.raises(ConflictError) as caught:
        session.save(now(session))
    assert "there already" in caught.value.problem.what and file.read_text() == THEIRS


def test_recovered_work_on_a_diagram_conflicts_with_a_changed_file(tmp_path: Path) -> None:
    file = tmp_path / "law.yaml"
    diagram = "symofros_diagram: 1\nname: law\nmodels: {}\nblocks:\n  one: {kind: constant, value: 1}\n"
    file.write_text(diagram)
    session = opened(file)
    session.set_text({**now(session), "text": diagram.replace("value: 1", "value: 2")})
    file.write_text(diagram.replace("value: 1", "value: 3"))
    session = opened(file)
    with pytest.raises(ConflictError):
        session.save(now(session))
    assert "value: 3" in file.read_text()


@pytest.mark.parametrize("stated", [None, "{", "[]", '{"file": "bar.yaml"}'])
def test_recovered_work_without_a_base_asks_before_saving(file: Path, stated: str | None) -> None:
    change(opened(file))
    base_of(file).unlink() if stated is None else base_of(file).write_text(stated)
    session = opened(file)
    assert session.as_json()["recovered"]
    with pytest.raises(ConflictError):
        session.save(now(session))


def test_two_servers_on_one_file_do_not_overwrite_each_others_unsaved_work(file: Path) -> None:
    one, two = opened(file), opened(file)
    change(one, 2.5)
    change(two, 7.0)
    assert "another editor" in two.as_json()["unkept"]["found"] and "value: 7.0" in two.document.text
    assert "value: 2.5" in autosave_of(file).read_text()
    two.save(now(two))
    assert "value: 2.5" in autosave_of(file).read_text()  # What is saved drops nothing of the other.
    with pytest.raises(ConflictError):
        one.save(now(one))
    assert "value: 7.0" in file.read_text()


def test_work_on_one_file_is_not_taken_for_that_on_its_namesake(file: Path) -> None:
    change(opened(file))
    namesake = file.with_suffix(".yml")
    namesake.write_text(TEXTS["double_pendulum"])
    session = opened(namesake)
    assert not session.as_json()["recovered"] and session.document.text == TEXTS["double_pendulum"]
    session.set_text({**now(session), "text": THEIRS})
    assert session.as_json()["unkept"] is not None and opened(file).as_json()["recovered"]


def test_saving_as_another_file_leaves_the_unsaved_work_on_it(file: Path) -> None:
    change(opened(file))
    file.write_text(THEIRS)
    session = opened(file.with_name("other.yaml"))
    with pytest.raises(ConflictError) as caught:
        session.save({**now(session), "path": file.name})
    with pytest.raises(FileError, match="unsaved work of its own"):
        session.save({**now(session), "path": file.name, "over": caught.value.over})
    assert file.read_text() == THEIRS and opened(file).as_json()["recovered"]
