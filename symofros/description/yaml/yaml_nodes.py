"""YAML text -> a tree of plain values in which each knows its line; what could be an attack is refused.

Built from ruamel.yaml's parsing events rather than by its composer: anchors, aliases, tags, merge keys and deep
nesting are met, and refused, before anything is built from them. Plain scalars follow YAML 1.2's core schema.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import MarkedYAMLError, YAMLError
from ruamel.yaml.events import (
    AliasEvent,
    DocumentStartEvent,
    Event,
    MappingEndEvent,
    MappingStartEvent,
    ScalarEvent,
    SequenceEndEvent,
    SequenceStartEvent,
)

from symofros.errors import MAX_PROBLEMS, Problem, SymofrosError

MAX_DEPTH = 50
# Two thousand bodies of twenty-five values each have no more. The scanner is written in Python: seconds for as many.
MAX_NODES = 50_000

_WORDS: dict[str, bool | None] = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL")),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
}
_INTEGER = re.compile(r"[-+]?[0-9]{1,15}\Z")
_FLOAT = re.compile(
    r"(?:[-+]?(?:(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?|\.(?:inf|Inf|INF))|\.(?:nan|NaN|NAN))\Z"
)


@dataclass(slots=True)
class Node:
    """A value of the file and where it stands.

    Attributes:
        line: Line of the value, counted from 1.
        value: A scalar, a mapping or a sequence of nodes.
        key_line: Line of the key in a mapping; otherwise `line`.
        start: Position of the value in the text, its byte order mark left out.
        end: After the value; of what is in block style, wherever the scanner noticed that it had ended.
        key_start: Position of the key; -1 outside of mappings.
        key_end: After its key.
        style: "block" or "flow" of a mapping or sequence; of a scalar "plain", or the sign that it begins with.
    """

    line: int
    value: Any
    key_line: int
    start: int = 0
    end: int = 0
    key_start: int = -1
    key_end: int = -1
    style: str = "plain"

    def plain(self) -> Any:
        """The value without lines: dict, list, str, float, int, bool or None."""
        if isinstance(self.value, dict):
            return {key: node.plain() for key, node in self.value.items()}
        if isinstance(self.value, list):
            return [node.plain() for node in self.value]
        return self.value

    def at(self, path: Iterable[str | int]) -> Node:
        """The node at a path, or the deepest one on the way there that exists."""
        node = self
        for step in path:
            inner = node.value
            if isinstance(inner, dict) and step in inner:
                node = inner[step]
            elif isinstance(inner, list) and isinstance(step, int) and step < len(inner):
                node = inner[step]
            else:
                break
        return node


class YamlFault(SymofrosError):
    """A problem of a YAML document after which reading can't go on."""


def decoded(data: bytes, file: str) -> str:
    """A file's text, without a byte order mark.

    Raises:
        YamlFault: Not UTF-8.
    """
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        bad_byte = f"byte 0x{data[error.start]:02x}"
        raise YamlFault(
            "the text is not UTF-8", bad_byte, "files are in UTF-8", "save the file as UTF-8", f"{file}:{line}"
        ) from None


def too_many_nodes(where: str) -> Problem:
    """The problem that a document has more than MAX_NODES values.

    Args:
        where: Place of the first beyond.
    """
    rule, remedy = f"at most {MAX_NODES} in a file", "check that it is the file you meant"
    return Problem("too many values", f"more than {MAX_NODES}", rule, remedy, where)


def compose_whole(text: str, file: str) -> tuple[Node, list[Problem]]:
    """Read one YAML document; see `yaml_pieces.compose_text`.

    Returns:
        The root, and the duplicate keys that were found (the first of each counts).

    Raises:
        YamlFault: Not YAML, or something the format does without.
    """
    builder = _Builder(file)
    try:
        for event in YAML(typ="safe", pure=True).parse(text):
            builder.take(event)
    except MarkedYAMLError as error:
        syntax_error = f"{error.problem or error.context}"
        # What the end of the file cuts short is mended where it begins.
        mark = (error.context_mark if "stream" in syntax_error else None) or error.problem_mark
        line = mark.line + 1 if mark else 1
        raise YamlFault(_not_yaml(_plainly(syntax_error), f"{file}:{line}")) from None
    except (YAMLError, ValueError, OverflowError) as error:  # The scanner lets chr() complain about bad escapes.
        raise YamlFault(_not_yaml(" ".join(str(error).split())[:200], file)) from None
    if builder.root is None:
        raise YamlFault(
            "the file is empty", "no document", "a description is a YAML mapping", "begin with symofros: 1", file
        )
    return builder.root, builder.problems


# Messages of the scanner -> messages in the terms of the file's author.
_PLAINLY = {
    "expected <block end>, but found '<block mapping start>'": "an entry indented unlike its neighbours",
    "expected <block end>, but found '<block sequence start>'": "a '-' indented unlike its neighbours",
    "mapping values are not allowed here": "a ':' where no entry can begin",
    "found character '`' that cannot start any token": "a text that begins with a backquote and is not in quotes",
    "found character '\\t' that cannot start any token": "a tab; indentation is by blanks",
    "found unexpected end of stream": "a quotation that never ends",
    "but got '<stream end>'": "but the file ends",
}


def _plainly(text: str) -> str:
    for message, plain in _PLAINLY.items():
        text = text.replace(message, plain)
    return text


def _not_yaml(found: str, where: str) -> Problem:
    return Problem(
        "the text is not YAML",
        found,
        "a description is one YAML document",
        "mind indentation, ':' and brackets near this line",
        where,
    )


def scalar_of(text: str) -> Any:
    """Value of a plain scalar with this text."""
    if text in _WORDS:
        return _WORDS[text]
    if _INTEGER.match(text):
        return int(text)
    return float(text.lower().replace(".inf", "inf").replace(".nan", "nan")) if _FLOAT.match(text) else text


@dataclass
class _Builder:
    """Puts nodes together; `open` are the collections begun and not ended, each with the key that waits for a value."""

    file: str
    root: Node | None = None
    problems: list[Problem] = field(default_factory=list)
    open: list[tuple[Node, list[tuple[str, int, int, int]]]] = field(default_factory=list)
    documents: int = 0
    nodes: int = 0

    def take(self, event: Event) -> None:
        """One more parsing event."""
        line = event.start_mark.line + 1
        self.refuse_extras(event, line)
        if isinstance(event, ScalarEvent):
            self.scalar(event, line)
        elif isinstance(event, (MappingStartEvent, SequenceStartEvent)):
            node = Node(
                line,
                {} if isinstance(event, MappingStartEvent) else [],
                line,
                event.start_mark.index,
                style="flow" if event.flow_style else "block",
            )
            if self.wants_key():
                raise self.fault("a key is not a name", "a list or mapping as a key", "keys are plain names", line)
            self.put(node)
            self.open.append((node, []))
            if len(self.open) > MAX_DEPTH:
                raise self.fault(
                    f"nested deeper than {MAX_DEPTH}",
                    f"{len(self.open)} levels",
                    "the format needs fewer than ten",
                    line,
                    "close the brackets",
                )
        elif isinstance(event, (MappingEndEvent, SequenceEndEvent)):
            self.open.pop()[0].end = event.end_mark.index

    def fault(self, what: str, found: str, rule: str, line: int, remedy: str = "") -> YamlFault:
        return YamlFault(what, found, rule, remedy, f"{self.file}:{line}")

    def refuse_extras(self, event: Event, line: int) -> None:
        anchor, tag = getattr(event, "anchor", None), getattr(event, "tag", None)
        if isinstance(event, AliasEvent) or anchor:
            sign = "*" if isinstance(event, AliasEvent) else "&"
            raise self.fault(
                "anchors and aliases are refused",
                f"{sign}{anchor}",
                "every value is written where it is used",
                line,
                "write the value out, or make it a parameter",
            )
        if tag:
            raise self.fault(
                "tags are refused",
                str(tag),
                "values are plain numbers, texts, lists and mappings",
                line,
                "drop the tag",
            )
        if isinstance(event, DocumentStartEvent):
            self.documents += 1
            if self.documents > 1:
                raise self.fault(
                    "several documents in one file",
                    "a second '---'",
                    "one file holds one document",
                    line,
                    "split the file and use include",
                )

    def wants_key(self) -> bool:
        return bool(self.open) and isinstance(self.open[-1][0].value, dict) and not self.open[-1][1]

    def scalar(self, event: ScalarEvent, line: int) -> None:
        if not self.wants_key():
            value = scalar_of(event.value) if event.implicit[0] else event.value
            start, end = event.start_mark.index, event.end_mark.index
            self.put(Node(line, value, line, start, end, style=event.style or "plain"))
            return
        if event.value == "<<" and event.implicit[0]:
            raise self.fault(
                "merge keys are refused", "<<", "every value is written where it is used", line, "write the entries out"
            )
        # A key is a name, whatever it looks like: `on`, `1` and `null` are texts here.
        self.open[-1][1].append((event.value, line, event.start_mark.index, event.end_mark.index))

    def put(self, node: Node) -> None:
        self.nodes += 1
        if self.nodes > MAX_NODES:
            raise YamlFault(too_many_nodes(f"{self.file}:{node.line}"))
        if not self.open:
            self.root = node
            return
        owner, key = self.open[-1]
        if not key:
            owner.value.append(node)
            return
        name, node.key_line, node.key_start, node.key_end = key.pop()
        if name in owner.value:
            self.duplicate(name, owner.value[name].key_line, node.key_line)
        else:
            owner.value[name] = node

    def duplicate(self, name: str, first: int, second: int) -> None:
        if len(self.problems) >= MAX_PROBLEMS:
            return
        self.problems.append(
            Problem(
                f"'{name:.60}' appears twice",
                f"lines {first} and {second}",
                "a name is given once in its mapping",
                "rename or remove one of them",
                f"{self.file}:{second}",
            )
        )
