"""Paths that the page names: too long ones are refused, and what is no file is named."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from symofros.studio.editor.document.workspace import FileError, Workspace, read_text


@pytest.mark.parametrize("name", ["a" * 300 + ".yaml", "\u00e4" * 120 + ".yaml", "b" * 250 + "/c.yaml"])
def test_names_that_are_too_long_are_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(FileError, match="too long a name"):
        Workspace(tmp_path).inside(name)


def test_what_is_no_file_is_named(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.yaml")
    (tmp_path / "folder.yaml").mkdir()
    for name, kind in (("pipe.yaml", "a named pipe"), ("folder.yaml", "a folder"), ("gone.yaml", "no such file")):
        with pytest.raises(FileError, match=kind):
            read_text(tmp_path / name)
