"""Plain data -> YAML text, in the layout of the native files: short things in braces, long ones on lines."""

from __future__ import annotations

import re
from typing import Any

from symofros.description.yaml import scalar_of
from symofros.studio.editor.editing.data_edits import Path

WIDTH = 110
STEP = 2
# A whole number from here on is read as a double.
WHOLE = 10**15

# What may begin a plain scalar here; YAML allows more, and means something else by most of it.
_PLAIN = re.compile(r"[A-Za-z_0-9.(/+\-](.*[^\s:#])?\Z")
_NOT_PLAIN = re.compile(r":\s|\s#|\A(---|\.\.\.)|\A-(\s|\Z)|\A\(?[:#]")
_FLOW_SIGNS = re.compile(r"[,\[\]{}]|:(?=[,\[\]{}])|:\Z")
_ESCAPES = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\t": "\\t", "\r": "\\r"}


class Typed(float):
    """A number that is written as somebody typed it: 8.0e-4, not 0.0008."""

    text: str

    def __new__(cls, text: str) -> Typed:
        """The number of a text that reads as one."""
        made = super().__new__(cls, float(scalar_of(text)))
        made.text = text
        return made


def scalar(value: Any, *, flow: bool, quote: str = "", key: bool = False) -> str:
    """A scalar's text.

    Args:
        value: Value to write: None, bool, int, float or str.
        flow: Whether it stands within brackets.
        quote: Quotation mark of the text that it replaces.
        key: Whether it is a key, which is a name whatever it looks like.
    """
    if isinstance(value, str):
        return _text(value, flow, quote, key)
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, Typed):
        return value.text
    if isinstance(value, float):
        return {"inf": ".inf", "-inf": "-.inf", "nan": ".nan"}.get(repr(value), repr(value))
    return repr(value) if abs(value) < WHOLE else scalar(float(value), flow=flow)


def _text(text: str, flow: bool, quote: str, key: bool) -> str:
    plain = (
        text.isprintable()
        and _PLAIN.match(text)
        and not _NOT_PLAIN.search(text)
        and not (flow and _FLOW_SIGNS.search(text))
    )
    if quote not in ("'", '"') and plain and (key or scalar_of(text) == text) and text != "<<":
        return text
    if quote != '"' and text.isprintable():
        return "'" + text.replace("'", "''") + "'"
    return '"' + "".join(_escaped(sign) for sign in text) + '"'


def _escaped(sign: str) -> str:
    if sign in _ESCAPES:
        return _ESCAPES[sign]
    if sign.isprintable():
        return sign
    return f"\\u{ord(sign):04x}" if ord(sign) < 0x10000 else f"\\U{ord(sign):08x}"


def inline(value: Any, quote: str = "", *, flow: bool = True) -> str:
    """Data on one line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{scalar(k, flow=True, key=True)}: {inline(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(inline, value)) + "]"
    return scalar(value, flow=flow, quote=quote)


def is_block(value: Any, path: Path, column: int) -> bool:
    """Whether data at a path goes on lines of its own.

    Args:
        value: The data.
        path: Path in the document that it goes to.
        column: Column at which its text would begin.
    """
    if not isinstance(value, (dict, list)) or not value:
        return False
    sections = len(path) == 1 and path[0] != "system" or path[:1] == ("bodies",) and len(path) == 2
    if isinstance(value, dict) and (not path or sections):
        return True
    return len(inline(value)) + column > WIDTH and not _is_numbers(value)


def _is_numbers(value: Any) -> bool:
    return isinstance(value, list) and not any(isinstance(item, (dict, list)) for item in value)


def block(value: Any, path: Path, column: int) -> list[str]:
    """Data on lines, each beginning at a column; the lines are indented."""
    lines: list[str] = []
    indent = " " * column
    items = value.items() if isinstance(value, dict) else enumerate(value)
    for key, item in items:
        head = f"{scalar(key, flow=False, key=True)}:" if isinstance(value, dict) else "-"
        inner = (*path, key)
        if not is_block(item, inner, column + len(head) + 1):
            lines.append(f"{indent}{head} {inline(item, flow=False)}")
        elif isinstance(value, dict):
            lines += [f"{indent}{head}", *block(item, inner, column + STEP)]
        else:
            first, *rest = block(item, inner, column + STEP)
            lines += [f"{indent}- {first.lstrip()}", *rest]
    return lines
