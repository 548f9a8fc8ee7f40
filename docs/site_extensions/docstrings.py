"""Docstrings are plain text with `code`: stars and bars in their formulas mean themselves; Attributes are called so."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from sphinx.application import Sphinx
from sphinx.domains.python import PyObject

# What is no code, and what would be markup or the scheme of a link there.
_CODE_OR_MARK = re.compile(r"(`[^`]*`)|([*|]|\bfile:)")


def escaped(line: str) -> str:
    """A line whose stars, bars and "file:line" outside of code are no markup."""
    return _CODE_OR_MARK.sub(lambda match: match[1] or f"\\{match[2]}", line)


def _escape(app: Sphinx, what: str, name: str, obj: object, options: object, lines: list[str]) -> None:
    lines[:] = [escaped(line) for line in lines]


def setup(app: Sphinx) -> Mapping[str, Any]:
    """Called by Sphinx."""
    for field in PyObject.doc_field_types:
        if field.name == "variable":
            field.label = "Attributes"
    app.connect("autodoc-process-docstring", _escape, priority=100)  # Before napoleon, which writes stars of its own.
    return {"parallel_read_safe": True}
