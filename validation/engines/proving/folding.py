"""Scripts in lines that a page holds: long statements broken after commas, XML between its tags."""

from __future__ import annotations

import ast
import io
import re
import tokenize
from collections.abc import Iterator

from ..plugins.writing.source import WIDTH

_INDENT = "    "
# Lines of XML leave room for quotes and what follows them.
_XML = WIDTH - 4
_COMMENT = "# "
# XML that stands in a line without being hard to read.
_SHORT = 80


def folded(script: str) -> str:
    """A script whose lines are no longer than a page is wide, where they can be broken."""
    lines = script.splitlines()
    result: list[str] = []
    place = 0
    for statement in ast.parse(script).body:
        first, last = statement.lineno - 1, statement.end_lineno or statement.lineno
        for comment in lines[place:first]:
            result += _comment(comment) if comment.startswith(_COMMENT) else [comment]
        own = lines[first:last]
        simple = not isinstance(statement, ast.FunctionDef | ast.For | ast.If | ast.With)
        result += _statement("\n".join(own)).split("\n") if simple else own
        place = last
    return "\n".join([*result, *lines[place:]]) + "\n"


def _comment(line: str) -> Iterator[str]:
    words = line.removeprefix(_COMMENT).split(" ")
    text = _COMMENT + words[0]
    for word in words[1:]:
        if len(text) + 1 + len(word) > WIDTH:
            yield text
            text = _COMMENT + word
        else:
            text += " " + word
    yield text


def _statement(text: str) -> str:
    """A statement, XML in triple quotes, broken after the last commas within brackets that lines hold."""
    filled, line = "", ""
    for part in _parts(text):
        if line and len(line) + len(part.split("\n", 1)[0].rstrip()) > WIDTH:
            filled += line.rstrip() + "\n"
            line = _INDENT + part.lstrip()
        else:
            line += part
        before, newline, line = line.rpartition("\n")
        filled += before + newline
    return filled + line


def _parts(text: str) -> Iterator[str]:
    """The text in parts that end where it may be broken."""
    part, depth, end = "", 0, (1, 0)
    for token in tokenize.generate_tokens(io.StringIO(text + "\n").readline):
        if token.type in (tokenize.NEWLINE, tokenize.ENDMARKER, tokenize.NL):
            continue
        spaces = " " * (token.start[1] - end[1]) if token.start[0] == end[0] else " " * (depth == 0)
        end = token.end
        own = token.string
        if token.type == tokenize.STRING and _is_long_xml(own):
            # What is before it goes on a line with its beginning.
            room = WIDTH - len(part + spaces) - 3  # Less the quotes.
            own = f'"""{xml_lines(ast.literal_eval(own), room)}"""'
        part += spaces + own
        depth += (own in "([{") - (own in ")]}")
        if own == "," and depth:
            yield part
            part = ""
    yield part


def _is_long_xml(literal: str) -> bool:
    # Strings that are filled in have prefixes, and are no XML.
    return literal.lstrip("\"'").startswith("<") and len(literal) > _SHORT


def xml_lines(text: str, room: int = WIDTH) -> str:
    """XML with line breaks between tags, or attributes where a tag is longer than a line.

    Args:
        text: The XML.
        room: Letters that its first line may have.
    """
    filled: list[str] = []
    line = ""
    # An element of text alone stays in one piece.
    for part in re.findall(
        r"<\w+[^>/]*>[^<]+</\w+>|<[^>]*>|[^<]+", re.sub(r"\s+", " ", re.sub(r">\s+<", "><", text)).strip()
    ):
        width = _XML if filled else room
        if len(line) + len(part) > width and line:
            filled.append(line)
            line = ""
        if len(part) <= WIDTH:
            line += part
            continue
        for word in re.findall(r'[^ "]+(?:"[^"]*"[^ "]*)?', part):
            if line and len(line) + 1 + len(word) > WIDTH:
                filled.append(line)
                line = word
            else:
                line += (" " if line and not line.endswith(">") else "") + word
    return "\n".join([*filled, line])
