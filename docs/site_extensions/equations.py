"""Equations of the theory: text in the code's names; their numbers stand in a column of their own, with anchors."""

from __future__ import annotations

import re
from collections.abc import Mapping
from html import escape
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx

_NUMBERED = re.compile(r"^(?P<text>.*?)\s{2,}\((?P<number>\d+[a-z]?)\)$")


def as_equations(text: str) -> str:
    """A block of lines as HTML, `#eq-9` the anchor of the line with the number (9); "" where no line has a number."""
    lines = [_NUMBERED.match(line) or line for line in text.splitlines()]
    if all(isinstance(line, str) for line in lines):
        return ""
    shown = "\n".join(escape(line if isinstance(line, str) else line["text"]) for line in lines)
    numbers = "\n".join("" if isinstance(line, str) else _anchor(line["number"]) for line in lines)
    return f'<div class="equations"><pre tabindex="0">{shown}</pre><pre class="numbers">{numbers}</pre></div>'


def _anchor(number: str) -> str:
    return f'<a id="eq-{number}" href="#eq-{number}">({number})</a>'


def _number_equations(app: Sphinx, tree: nodes.document) -> None:
    if app.env.docname.startswith("theory/"):
        for block in list(tree.findall(nodes.literal_block)):
            shown = as_equations(block.astext())
            if shown:
                block.replace_self(nodes.raw("", shown, format="html"))


def setup(app: Sphinx) -> Mapping[str, Any]:
    """Called by Sphinx."""
    app.connect("doctree-read", _number_equations)
    return {"parallel_read_safe": True}
