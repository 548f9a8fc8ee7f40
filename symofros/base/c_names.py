"""C names that are legal, stable and readable."""

from __future__ import annotations

import re
from collections.abc import Iterable
from itertools import chain, count

_KEYWORDS = frozenset(
    "auto break case char const continue default do double else enum extern float for goto if inline int long"
    " register restrict return short signed sizeof static struct switch typedef union unsigned void volatile while asm"
    " main".split()
)
# Names that headers, operating systems, FMI or Matlab reserve; the first row would clash with symofros_model.h.
_RESERVED = frozenset(
    "sym symofros"
    " assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdarg stdbool stddef"
    " stdint stdio stdlib string tgmath time wchar wctype windows"
    " con prn aux nul fmi fmi2 fmi3 fmu mex mexfunction simstruc simulink symosfunction selftest"
    " break catch class elseif end function global otherwise parfor persistent try".split()
)
_RESERVED_PREFIXES = ("symofros_", "sym_", "fmi2", "fmi3")
_ILLEGAL = re.compile(r"[^A-Za-z0-9]+")
_MAX_LENGTH = 48


def identifier(text: str) -> str:
    """A C identifier that looks like the text; "m" before a leading digit, "_" after a reserved name.

    It also serves as the name of files and of a function of Matlab.
    """
    name = _ILLEGAL.sub("_", text).strip("_")[:_MAX_LENGTH].rstrip("_") or "model"
    if name[0].isdigit():
        name = f"m{name}"
    lower = name.lower()
    is_reserved = name in _KEYWORDS or lower in _RESERVED
    if lower.startswith(_RESERVED_PREFIXES):
        name = f"m_{name}"
    return f"{name}_" if is_reserved else name


def function_symbols(name: str, functions: Iterable[tuple[str, str]]) -> list[str]:
    """C names of functions by (name, frame), all different: frames whose names become the same in C get numbers."""
    symbols: list[str] = []
    for function, frame in functions:
        stem = "_".join([name, function, *([identifier(frame)] if frame else [])])
        symbols.append(next(s for s in chain([stem], (f"{stem}_{i}" for i in count(2))) if s not in symbols))
    return symbols


def local_name(label: str, node: int) -> str:
    """The local variable of a labelled node: w_WB_B[arm][2] -> w_WB_B__arm_2.

    Args:
        label: Label in the graph.
        node: Number of the node, which makes the name unique.
    """
    head, *rest = [_ILLEGAL.sub("_", part).strip("_") for part in re.split(r"[\[\]]+", label)]
    tail = "_".join(part for part in rest if part)
    return f"{head}__{tail[:_MAX_LENGTH]}_{node}" if tail else f"{head}_{node}"


def c_string(text: str) -> str:
    """A C string literal; bytes outside printable ASCII become octal escapes."""
    escaped = "".join(
        chr(byte) if 32 <= byte < 127 and chr(byte) not in '\\"?' else f"\\{byte:03o}" for byte in text.encode()
    )
    return f'"{escaped}"'
