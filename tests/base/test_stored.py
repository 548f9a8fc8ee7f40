"""State in files of our own: whatever lies there is read as what was written, or counts as absent with a warning."""

from __future__ import annotations

import json
import os
import warnings
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from symofros.base.stored import append_line, keep, stored_json, stored_lines, stored_text, write_atomically
from symofros.errors import StoredStateWarning

DAMAGES = [b"", b"\0" * 64, b"\xff\xfe\x80", b"{", b"null", b"3", b"[]", b"{}", b'{"n": "x"}', b"[" * 100_000]


def row(value: Any) -> int:
    """A sound value has an integer."""
    return int(value["n"])


@pytest.mark.parametrize("damage", DAMAGES)
def test_damaged_files_count_as_absent_with_a_warning(tmp_path: Path, damage: bytes) -> None:
    file = tmp_path / "state.json"
    file.write_bytes(damage)
    with pytest.warns(StoredStateWarning, match=r"state\.json: .*taken for absent"):
        assert stored_json(file, row) is None


@pytest.mark.parametrize("kind", ["folder", "pipe", "link", "loop"])
def test_a_path_that_is_not_a_file_counts_as_absent(tmp_path: Path, kind: str) -> None:
    place = tmp_path / "state.json"
    if kind == "folder":
        place.mkdir()
    elif kind == "pipe":
        os.mkfifo(place)
    else:
        place.symlink_to(tmp_path / ("gone" if kind == "link" else "state.json"))
    with pytest.warns(StoredStateWarning, match="taken for absent"):
        assert stored_text(place, str) is None


def test_absent_files_are_not_reported_as_damaged(tmp_path: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert stored_json(tmp_path / "gone", row) is None
        assert stored_lines(tmp_path / "gone", row) == []


@given(st.lists(st.one_of(st.integers(-5, 5), st.binary(max_size=12).filter(lambda b: b"\n" not in b)), max_size=8))
def test_valid_lines_are_read_despite_damaged_ones(tmp_path_factory: pytest.TempPathFactory, parts: list[Any]) -> None:
    file = tmp_path_factory.mktemp("lines") / "journal.jsonl"
    for part in parts:
        if isinstance(part, int):
            append_line(file, {"n": part})
        else:  # A process was killed in the middle of its line.
            with file.open("ab") as stream:
                stream.write(part)
    with warnings.catch_warnings(record=True):
        warnings.simplefilter("always")
        values = stored_lines(file, row)
    assert values == [part for part in parts if isinstance(part, int)]


def test_a_failure_to_store_is_reported(tmp_path: Path) -> None:
    (tmp_path / "hint").mkdir()
    with pytest.warns(StoredStateWarning, match=r"hint: .*it is not kept"):
        keep(tmp_path / "hint", "text")
    assert [path.name for path in tmp_path.iterdir()] == ["hint"]


def test_a_full_disk_names_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "chmod", full)
    with pytest.raises(OSError, match=r"No space left on device: '.*model\.json'"):
        write_atomically(tmp_path / "model.json", json.dumps([1]))
    assert list(tmp_path.iterdir()) == []
