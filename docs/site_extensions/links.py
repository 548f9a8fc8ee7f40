"""Links out of docs/ work on GitHub as they stand; in the site they lead to the file, or the page that includes it.

Sphinx takes a link to any other kind of file as a download by itself; only Markdown looks to it like a page.
"""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from sphinx.application import Sphinx

# Files outside docs/ -> pages that include them.
PAGES = {
    "symofros/NOTATION.md": "docs/conventions.md",
    "CHANGELOG.md": "docs/changelog.md",
    "examples/README.md": "docs/examples.md",
}
_LINK = re.compile(r"\]\((?P<path>(?:\.\./)+[^)#\s]+\.md)(?P<anchor>#[^)\s]*)?\)")


def inside(text: str, page: Path, root: Path) -> str:
    """The text of a page, its links to Markdown outside docs/ turned.

    Args:
        text: Markdown.
        page: Its file.
        root: Folder of the repository.
    """

    def turned(link: re.Match[str]) -> str:
        target = Path(os.path.normpath(page.parent / link["path"])).relative_to(root).as_posix()
        if target.startswith("docs/"):
            return link[0]
        if target not in PAGES:
            return f"](path:{link['path']})"
        return f"]({os.path.relpath(root / PAGES[target], page.parent)}{link['anchor'] or ''})"

    return _LINK.sub(turned, text)


def _turn_links(app: Sphinx, page: str, source: list[str]) -> None:
    path = Path(app.env.doc2path(page))
    source[0] = inside(source[0], path, Path(app.srcdir).parent)


def setup(app: Sphinx) -> Mapping[str, Any]:
    """Called by Sphinx."""
    app.connect("source-read", _turn_links)
    return {"parallel_read_safe": True}
