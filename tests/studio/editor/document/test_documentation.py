"""Pages of the documentation that windows name: each is there, with its section."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import symofros.studio.editor
from symofros.studio.editor.diagrams.palette import diagram_catalogue
from symofros.studio.editor.document.documentation import documented
from symofros.studio.editor.document.workspace import FileError

WINDOWS = Path(symofros.studio.editor.__file__).parent / "page" / "src" / "windows"
NAMED = {
    page for file in WINDOWS.glob("*.tsx") for page in re.findall(r'"(docs/[^"]+)"', file.read_text(encoding="utf-8"))
}
BLOCKS = {entry["page"] for entry in diagram_catalogue()["palette"] if "page" in entry}


@pytest.mark.parametrize("page", sorted(NAMED | BLOCKS))
def test_a_page_that_a_window_names_is_there(page: str) -> None:
    title = documented(page).partition("\n")[0]
    section = page.partition(", ")[2]
    assert title.startswith("# ") if not section else title.lstrip("# ") == section


def test_nothing_else_is_read() -> None:
    assert len(NAMED) > 8 and len(BLOCKS) > 20
    for page in ("docs/../README.md", "docs/conf.py", "docs/nothing.md", "", "docs/../../etc/passwd.md"):
        with pytest.raises(FileError):
            documented(page)
