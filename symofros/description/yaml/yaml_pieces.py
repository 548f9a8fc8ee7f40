"""YAML text -> its tree, piece by piece: of a text that was read before, only what has changed is read again.

The scanner is written in Python: 0.2 s for fifty bodies, and an editor reads after each keystroke. The root's entries,
and the entries of those, begin at lines of one indentation; such a piece means the same by itself as in its document
if it ends where the next one begins. One that does not (an open bracket or quotation), or that has a fault, sends the
whole text to the one reader that says so (yaml_nodes.py).
"""

from __future__ import annotations

import re
from collections import OrderedDict
from itertools import islice
from threading import Lock
from typing import NamedTuple

from symofros.description.yaml.yaml_nodes import (
    MAX_DEPTH,
    MAX_NODES,
    Node,
    YamlFault,
    compose_whole,
    decoded,
    too_many_nodes,
)
from symofros.errors import Problem

# Characters of the pieces that are kept, those asked for last: two of the largest texts that are edited. What a text is
# read to takes some fifty times as many bytes.
MAX_KEPT = 2 << 20
# Levels of mappings that are taken to pieces: sections, and what they list.
LEVELS = 2
# A line that begins an entry with a plain name, after its indentation; only a comment may follow one with entries.
_KEY = re.compile(r"^( *)[A-Za-z_][\w.-]*:(?= |\r?$)", re.MULTILINE)
_BARE = re.compile(r" *[A-Za-z_][\w.-]*: *(?:#[^\n]*)?\r?\n")
_COMMENT = re.compile(r"^ *#.*$", re.MULTILINE)
# Marks of documents and directives, and line breaks that `splitlines` and the scanner may count differently.
_WHOLE = re.compile(r"^(?:---|\.\.\.|%)|\r(?!\n)|[\x0b\x0c\x1c-\x1e\x85\u2028\u2029\ufeff]", re.MULTILINE)


class _Piece(NamedTuple):
    """One entry of a block mapping, read by itself.

    Attributes:
        name: Key.
        node: Value, with lines and positions of the piece.
        nodes: Number of nodes.
    """

    name: str
    node: Node
    nodes: int


class _Unfit(Exception):
    """The text is no sequence of pieces."""


def compose(data: bytes, file: str) -> tuple[Node, list[Problem]]:
    """Read one YAML document.

    Args:
        data: The file's content.
        file: File name, for the problems.

    Returns:
        The root, and the duplicate keys that were found (the first of each counts).

    Raises:
        YamlFault: Not UTF-8, not YAML, or something the format does without.
    """
    return compose_text(decoded(data, file), file)


def compose_text(text: str, file: str) -> tuple[Node, list[Problem]]:
    """The same from text.

    Raises:
        YamlFault: Not YAML, or something the format does without.
    """
    _refuse_size(text, file)
    try:
        return _root(text), []
    except (_Unfit, YamlFault):
        return compose_whole(text, file)


def _refuse_size(text: str, file: str) -> None:
    """Refuse a text with too many entries before it is scanned, which takes a tenth of a millisecond an entry.

    Raises:
        YamlFault: More lines begin an entry than a text may have nodes.
    """
    extra = next(islice(_KEY.finditer(text), MAX_NODES, None), None)
    if extra is not None:
        raise YamlFault(too_many_nodes(f"{file}:{text.count(chr(10), 0, extra.start()) + 1}"))


def _root(text: str) -> Node:
    """The root of a text that is a block mapping of pieces."""
    if _WHOLE.search(text):
        raise _Unfit
    parts = _split(text, 0)
    if len(parts) < 2 or not _is_comment(parts[0]):
        raise _Unfit
    return _Composer().mapping(parts, 0, 1, LEVELS)


def _split(text: str, least: int) -> list[str]:
    """The lines before the first entry, and each entry with the lines after it; together they are the text.

    Args:
        text: Lines, the first of which that is no comment says the indentation.
        least: Least indentation.
    """
    first = next((key for key in _KEY.finditer(text) if len(key[1]) >= least), None)
    if first is None:
        return [text]
    begins = [key.start() for key in _KEY.finditer(text, first.start()) if key[1] == first[1]]
    return [text[: begins[0]], *(text[i:j] for i, j in zip(begins, [*begins[1:], len(text)], strict=True))]


def _is_comment(text: str) -> bool:
    """Whether there is nothing but comments and blank lines."""
    return not _COMMENT.sub("", text).strip()


class _Composer:
    """Puts the tree of one text together, as long as it has no more nodes than a text may have.

    Attributes:
        nodes: Number of nodes so far.
    """

    def __init__(self) -> None:
        self.nodes = 0

    def mapping(self, parts: list[str], at: int, line: int, levels: int) -> Node:
        """The block mapping of some entries."""
        at, line = at + len(parts[0]), line + parts[0].count("\n")
        owner = Node(line, {}, line, at + _indentation(parts[1]), style="block")
        self.nodes += 1
        for part in parts[1:]:
            name, node = self.entry(part, at, line, levels)
            if name in owner.value or self.nodes > MAX_NODES:
                raise _Unfit
            owner.value[name] = node
            at, line = at + len(part), line + part.count("\n")
        owner.end = at
        return owner

    def entry(self, part: str, at: int, line: int, levels: int) -> tuple[str, Node]:
        """Name and value of an entry."""
        head = _BARE.match(part) if levels > 1 else None
        if head is not None:
            column = _indentation(part)
            inner = _split(part[head.end() :], column + 1)
            # What stands between a key and its first entry is a comment, or it is no mapping.
            if len(inner) > 1 and _is_comment(inner[0]):
                node, key_end = self.mapping(inner, at + head.end(), line + 1, levels - 1), part.index(":")
                node.key_line, node.key_start, node.key_end = line, at + column, at + key_end
                return part[column:key_end], node
        piece = _KEPT.read(part)
        self.nodes += piece.nodes
        return piece.name, _moved(piece.node, at, line - 1)


def _indentation(part: str) -> int:
    return len(part) - len(part.lstrip(" "))


def _read(part: str) -> _Piece:
    """One entry by itself.

    Raises:
        YamlFault: It has a fault, or does not end here.
    """
    root, repeated = compose_whole(part, "")
    if repeated or not isinstance(root.value, dict) or len(root.value) != 1:
        raise _Unfit
    ((name, node),) = root.value.items()
    nodes, depth = _measured(node)
    if depth > MAX_DEPTH - LEVELS:
        raise _Unfit
    return _Piece(name, node, nodes)


class _Kept:
    """Pieces that were read, by their text: the latest that are asked for."""

    def __init__(self) -> None:
        self._pieces: OrderedDict[str, _Piece] = OrderedDict()
        self._size = 0
        self._using = Lock()

    def read(self, part: str) -> _Piece:
        """A piece, read if it is not kept.

        Raises:
            YamlFault: It has a fault, or does not end here.
        """
        with self._using:
            piece = self._pieces.get(part)
            if piece is not None:
                self._pieces.move_to_end(part)
                return piece
        piece = _read(part)
        with self._using:
            if part not in self._pieces:
                self._pieces[part] = piece
                self._size += len(part)
            while self._size > MAX_KEPT:
                self._size -= len(self._pieces.popitem(last=False)[0])
        return piece


_KEPT = _Kept()


def _measured(node: Node) -> tuple[int, int]:
    """Number of nodes, and levels of collections."""
    if not isinstance(node.value, (dict, list)):
        return 1, 0
    inside = [_measured(inner) for inner in (node.value.values() if isinstance(node.value, dict) else node.value)]
    return 1 + sum(nodes for nodes, _ in inside), 1 + max((depth for _, depth in inside), default=0)


def _moved(node: Node, at: int, lines: int) -> Node:
    """A copy of a node some lines further down, for a text in which its piece begins at a position."""
    value = node.value
    if isinstance(value, dict):
        value = {key: _moved(inner, at, lines) for key, inner in value.items()}
    elif isinstance(value, list):
        value = [_moved(inner, at, lines) for inner in value]
    key_start, key_end = (node.key_start + at, node.key_end + at) if node.key_start >= 0 else (-1, -1)
    return Node(
        node.line + lines, value, node.key_line + lines, node.start + at, node.end + at, key_start, key_end, node.style
    )
