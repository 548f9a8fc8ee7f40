"""A YAML text with the place of every entry in it: where it begins and ends, what lines and comments are its own."""

from __future__ import annotations

import re
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

from symofros.description.yaml import Node, compose_text
from symofros.studio.editor.editing.data_edits import Path

_BREAK = re.compile(r"\r\n|\n|\r")


class Span(NamedTuple):
    """Positions in a text, the second one excluded."""

    start: int
    end: int


@lru_cache(maxsize=8)
def yaml_text_of(text: str) -> YamlText:
    """A text with the spans of its entries; kept, because reading takes longer than anything that is done with it.

    Raises:
        YamlFault: It is not a YAML document that the format accepts; the problem's `where` is ":line".
    """
    return YamlText(text)


class YamlText:
    """A YAML text and its tree of nodes, with the span of each in the text.

    Attributes:
        text: The text, without a byte order mark.
        root: Root of the document's tree.
        duplicates: Problems of keys that appear twice; their `where` is ":line".
        newline: Line ending of the document.
    """

    def __init__(self, text: str) -> None:
        """Read the text; see `yaml_text_of`."""
        self.text = text
        self.root, self.duplicates = compose_text(text, "")
        first = _BREAK.search(text)
        self.newline = first.group() if first else "\n"
        self._settle(self.root)

    @cached_property
    def data(self) -> Any:
        """The document as plain data, which all who read it share: not to be changed."""
        return self.root.plain()

    def _settle(self, owner: Node) -> None:
        """Put values that are not written (the scanner has them at the next token) after their colon or dash."""
        if not owner.value or not isinstance(owner.value, (dict, list)):
            return
        for i, node in enumerate(self.children(owner)):
            if node.start == node.end and node.style == "plain":
                node.start = node.end = self.after_mark(owner, i)
            self._settle(node)

    def after_mark(self, owner: Node, i: int) -> int:
        """The position after the colon of a key or the dash of an item; of a key without a colon, after it."""
        if isinstance(owner.value, dict):
            key_end = self.children(owner)[i].key_end
            colon = self.skip(key_end)
            return colon + 1 if self.text[colon : colon + 1] == ":" else key_end
        return self.begin(owner, i) + (owner.style == "block")

    def node(self, path: Path) -> Node | None:
        """The node at a path; None if there is none."""
        node = self.root
        for step in path:
            inner = node.value
            known = isinstance(inner, dict) and step in inner
            known |= isinstance(inner, list) and isinstance(step, int) and 0 <= step < len(inner)
            if not known:
                return None
            node = inner[step]
        return node

    def children(self, owner: Node) -> list[Node]:
        """A mapping's values or a list's items, in order."""
        return list(owner.value.values()) if isinstance(owner.value, dict) else list(owner.value)

    def end(self, node: Node) -> int:
        """Position of the end of a value, without comments and blank lines after it."""
        if node.style == "block":
            return self.end(self.children(node)[-1])
        if node.style in ("|", ">"):
            return node.start + len(self.text[node.start : node.end].rstrip())
        return node.end

    def begin(self, owner: Node, i: int) -> int:
        """Position of the start of an entry: its key, or the dash of an item."""
        nodes = self.children(owner)
        if isinstance(owner.value, dict):
            return nodes[i].key_start
        if owner.style == "flow":
            return nodes[i].start
        return self.skip(self.end(nodes[i - 1])) if i else owner.start

    def skip(self, at: int) -> int:
        """The first position from here that is neither blank nor in a comment."""
        while at < len(self.text):
            sign = self.text[at]
            if sign == "#":
                at = self.line_end(at)
            elif sign.isspace():
                at += 1
            else:
                break
        return at

    @cached_property
    def line_starts(self) -> list[int]:
        """Positions at which lines start."""
        return [0, *(line_break.end() for line_break in _BREAK.finditer(self.text))]

    def line_start(self, at: int) -> int:
        """Position at which the line of a position starts."""
        return max(self.text.rfind("\n", 0, at), self.text.rfind("\r", 0, at)) + 1

    def line_end(self, at: int) -> int:
        """Position at which the line of a position ends, before its break."""
        line_break = _BREAK.search(self.text, at)
        return line_break.start() if line_break else len(self.text)

    def next_line(self, at: int) -> int:
        """Position at which the line after that of a position starts."""
        line_break = _BREAK.search(self.text, at)
        return line_break.end() if line_break else len(self.text)

    def column(self, at: int) -> int:
        """A position's column, from 0."""
        return at - self.line_start(at)

    def leads(self, at: int) -> bool:
        """Whether nothing but blanks stands before a position on its line."""
        return not self.text[self.line_start(at) : at].strip()

    def lines_of(self, owner: Node, i: int) -> Span:
        """Span of the lines that belong to an entry of a collection in block style.

        Its own lines, the comments directly above it at its own indentation (but not those at the head of the file),
        the comment at the end of its last line, and comments below it that are indented deeper than it is.
        """
        nodes = self.children(owner)
        start = self.begin(owner, i)
        column = self.column(start)
        first = self.line_start(start) if self.leads(start) else start
        if first != start or column == 0:
            lowest = self.next_line(self.end(nodes[i - 1])) if i else self._floor(owner)
            while first > lowest and self._comment_column(before := self.line_start(first - 1)) == column:
                first = before
        last = self.next_line(self.end(nodes[i]))
        # Comments deeper than the entry are about its inside; blank lines between them go with them.
        ahead = last
        while ahead < len(self.text):
            comment_column = self._comment_column(ahead)
            if comment_column is not None and comment_column > column:
                last = self.next_line(ahead)
            elif self.text[ahead : self.line_end(ahead)].strip():
                break
            ahead = self.next_line(ahead)
        return Span(first, last)

    def _floor(self, owner: Node) -> int:
        """Position above which no comment belongs to the first entry of a collection."""
        if owner is self.root:
            return self.line_start(owner.start)
        return self.next_line(owner.key_end) if owner.key_start >= 0 else owner.start

    def _comment_column(self, line: int) -> int | None:
        """The column of the comment that a line consists of."""
        text = self.text[line : self.line_end(line)]
        bare = text.lstrip(" ")
        return len(text) - len(bare) if bare.startswith("#") else None
