"""Small pieces of C."""

from __future__ import annotations

import math
from collections.abc import Iterable

from symofros.generator.codegen.model import comment as comment
from symofros.generator.codegen.model import strings as strings

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
