"""Pages of the documentation, which a wheel has within the package, a checkout beside it."""

from __future__ import annotations

import re
from pathlib import Path

import symofros
from symofros.studio.editor.document.workspace import Workspace, read_text

_PACKAGE = Path(symofros.__file__).parent


def documented(page: str) -> str:
    """Text of a page, in Markdown.

    Args:
        page: Its file, as "docs/yaml.md"; after a comma, the section to return, as "docs/diagrams.md, The file".

    Raises:
        FileError: There is no such file.
    """
    name, _, section = page.partition(", ")
    root = _PACKAGE if (_PACKAGE / "docs").is_dir() else _PACKAGE.parent
    file = Workspace(root / "docs").inside(name.removeprefix("docs/"), (".md",))
    text, _ = read_text(file)
    found = re.search(rf"^(#+) {re.escape(section)}$.*?(?=^#{{1,6}} |\Z)", text, re.MULTILINE | re.DOTALL)
    return found[0] if section and found else text
