"""Names that users choose: what formulas, columns and tables call a thing, and legal, stable, readable names in C."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable
from itertools import chain, count

QUOTE = "`"
TIME = "t"
# What these mean in formulas is fixed: the time, and a number.
RESERVED = frozenset({TIME, "pi"})

# A name between backquotes; d and dd before it are those of speeds and their rates, what follows is a component.
QUOTED_NAME = r"d{0,2}`(?:[^`]|``)+`(?:\.[A-Za-z_][A-Za-z0-9_]*)*(?:\[\d{1,6}\])?"
_QUOTED = re.compile(QUOTED_NAME, re.ASCII)
_RATE = re.compile(r"d{1,2}`(?:[^`]|``)+`")
_PARTS = re.compile(r"(d*)`((?:[^`]|``)+)`(.*)", re.DOTALL)

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
# Names that an export's own build, or scripts of Matlab beside its MEX file, need: targets of CMake, then constants and
# common functions, which the file would hide from everything on the path.
_USED_BESIDE_EXPORTS = frozenset(
    "all clean depend edit_cache help install package rebuild_cache run_tests test uninstall zero_check"
    " ans e eps i inf j nan pi"
    " abs acos any asin atan atan2 ceil cos cosh cross det diag diff disp dot eig error exp eye find fix floor inv"
    " length linspace load log max mean min mod norm ones plot rand randn rank reshape round save sign sim sin sinh"
    " size sort sqrt std step sum svd tan tanh trace zeros"
    " cd classdef clear exist mexext mkoctfile numel pwd rehash spmd strncmp tempdir until unwind_protect which".split()
)
_RESERVED_PREFIXES = ("symofros_", "sym_", "fmi2", "fmi3")
_ILLEGAL = re.compile(r"[^A-Za-z0-9]+")
_MAX_LENGTH = 48


def quoted(name: str) -> str:
    """A name between backquotes; one within it is doubled."""
    return f"{QUOTE}{name.replace(QUOTE, 2 * QUOTE)}{QUOTE}"


def name_of(text: str) -> str:
    """The name that a text stands for where nothing but a name can be: d`left-hip`, `dleft-hip`, dleft-hip."""
    return "".join(_parts(text) or (text,))


def symbol_in(text: str) -> str:
    """The symbol that a name with backquotes stands for in a formula: left-hip, or d`left-hip` of a rate."""
    rate, name = _parts(text) or ("", text)
    return rate_symbol(name, len(rate)) if rate else symbol_of(name)


def rate_symbol(coordinate: str, order: int = 1) -> str:
    """The symbol of a coordinate's rate that nothing else can have: a coordinate door may be there besides oor."""
    return "d" * order + quoted(coordinate)


def is_rate_symbol(symbol: str) -> bool:
    """Whether a symbol is of that form."""
    return _RATE.fullmatch(symbol) is not None


def _parts(text: str) -> tuple[str, str] | None:
    """The prefix d or dd of a quoted name of a rate, "" of others, and the name; None if nothing is quoted."""
    match = _PARTS.fullmatch(text) if _QUOTED.fullmatch(text) else None
    if match is None:
        return None
    rate, inner, rest = match.groups()
    return rate, inner.replace(2 * QUOTE, QUOTE) + rest


def symbol_of(name: str) -> str:
    """The symbol of a coordinate, speed or input in formulas and columns: its name, but "`t`" for one called t.

    Within the program a symbol is the plain name, whatever signs it holds; formulas print it with backquotes where
    they need them. A reserved name bears them everywhere, as it would mean something else without; so does the name in
    `rate_symbol`, which the symbol dNAME is short for.
    """
    return quoted(name) if name in RESERVED else name


def coordinate_of(text: str, coordinates: Collection[str]) -> str:
    """The coordinate, input or parameter that a text names, with backquotes or without; "" where there is none."""
    plain = text if text in coordinates else name_of(text) if text.startswith(QUOTE) else ""
    return plain if plain in coordinates else ""


def speed_of(text: str, speeds: Collection[str]) -> str:
    """The speed that a text names, itself or as the rate of its coordinate (dq1, d`left-hip`); "" where there is none.

    Args:
        text: As a user wrote it.
        speeds: Names of speeds, those of their coordinates where they are their rates.
    """
    plain = coordinate_of(text, speeds)
    if plain:
        return plain
    if not text.startswith("d"):
        text = name_of(text)
    return coordinate_of(text[1:], speeds) if text.startswith("d") else ""


def speed_column(speed: str, coordinates: Collection[str]) -> str:
    """Symbol of a speed in columns and formulas: its name; dNAME or d`NAME` if a coordinate has that name."""
    if speed not in coordinates:
        return speed
    return f"d{speed}" if f"d{speed}" not in coordinates else rate_symbol(speed)


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


def package_name(text: str) -> str:
    """The `identifier` of an export's files and symbols: "_" after what its build or Matlab's scripts need, too."""
    name = identifier(text)
    return f"{name}_" if name.lower() in _USED_BESIDE_EXPORTS else name


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
