"""Small pieces of C."""

from __future__ import annotations

import math
from collections.abc import Iterable

_WIDTH = 8


def doubles(values: Iterable[float]) -> str:
    """Initialisers of an array of doubles, some a line; C has no empty arrays."""
    texts = [_double(value) for value in values] or ["0.0"]
    lines = [", ".join(texts[i : i + _WIDTH]) for i in range(0, len(texts), _WIDTH)]
    return ",\n    ".join(lines)


def _double(value: float) -> str:
    if math.isfinite(value):
        return repr(float(value))
    return "NAN" if math.isnan(value) else "HUGE_VAL" if value > 0 else "-HUGE_VAL"


def integers(values: Iterable[int]) -> str:
    """Initialisers of an array of integers."""
    return ", ".join(map(str, values)) or "0"


def c_string(text: str) -> str:
    """A C string literal; bytes outside printable ASCII become octal escapes."""
    escaped = "".join(
        chr(byte) if 32 <= byte < 127 and chr(byte) not in '\\"?' else f"\\{byte:03o}" for byte in text.encode()
    )
    return f'"{escaped}"'


def strings(names: Iterable[str]) -> str:
    """Initialisers of an array of strings: C has no empty arrays, sizes say how many entries count."""
    return ", ".join(map(c_string, names)) or "NULL"


def comment(text: str) -> str:
    """Text that can't end a C comment, in ASCII, without trigraphs."""
    plain = text.encode("ascii", "replace").decode()
    return plain.replace("*/", "* /").replace("/*", "/ *").replace("?", "_").replace("\n", " ")
