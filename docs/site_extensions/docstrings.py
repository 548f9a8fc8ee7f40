"""Docstrings are plain text with `code`: stars and bars in their formulas mean themselves."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from sphinx.application import Sphinx

_CODE_OR_MARK = re.compile(r"(`[^`]*`)|([*|])")


def escaped(line: str) -> str:
    """A line whose stars and bars outside of code are no markup."""
    return _CODE_OR_MARK.sub(lambda match: match[1] or f"\\{match[2]}", line)


def _escape(app: Sphinx, what: str, name: str, obj: object, options: object, lines: list[str]) -> None:
    lines[:] = [escaped(line) for line in lines]


def setup(app: Sphinx) -> Mapping[str, Any]:
    """Called by Sphinx."""
    app.connect("autodoc-process-docstring", _escape, priority=100)  # Before napoleon, which writes stars of its own.
    return {"parallel_read_safe": True}
