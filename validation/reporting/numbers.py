"""Numbers as people and JSON read them."""

from __future__ import annotations

import math
import string
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

# Digits of a curve's points in JSON: more than a figure shows.
DIGITS = 5


def short(x: float | None) -> str:
    """For people; an unbounded side of a bound is left empty."""
    if x is None or math.isnan(x):
        return "NaN"
    if math.isinf(x):
        return ""
    return f"{x:.6g}" if x == 0.0 or 1e-3 <= abs(x) < 1e5 else f"{x:.2e}"


def digits(x: float | None, number: int = 2) -> str:
    """An error in so many digits, 3.2e-15; exact agreement is a bare 0."""
    return "NaN" if x is None or math.isnan(x) else "0" if x == 0.0 else f"{x:.{number - 1}e}"


def times(x: float) -> str:
    """A ratio."""
    return f"{short(float(f'{x:.2g}'))}×"


def counted(number: int, noun: str) -> str:
    """A number with its noun: "1 model", "2 models", "2 studies"."""
    figures = f"{number:,}".replace(",", " ") if number >= 10_000 else str(number)
    if number == 1:
        return f"{figures} {noun}"
    return f"{figures} {noun[:-1]}ies" if noun.endswith("dy") else f"{figures} {noun}s"


def duration(seconds: float) -> str:
    """A time in the unit that suits it."""
    if not math.isfinite(seconds):
        return "-"
    for unit, size in (("s", 1.0), ("ms", 1e-3)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-6:.3g} µs"


def compact(x: float) -> str:
    """Three digits or more."""
    return f"{x:.1f}" if x < 100 else f"{x:.0f}"


class Form(string.Formatter):
    """Formats of columns over the fields of a row (a mapping, a record, a tuple).

    They are Python's, "time", "short", "times", "compact" and "digits" as above, and scaled ones, "1e3*.2f". What is
    missing is "-"; several numbers are listed.
    """

    NAMED: Mapping[str, Callable[[Any], str]] = {
        f.__name__.replace("duration", "time"): f for f in (duration, short, times, compact, digits)
    }

    def of(self, text: str, row: Any) -> str:
        """The text with the fields of a row."""
        return self.vformat(text, (row,), {})

    def field(self, row: Any, name: str) -> Any:
        """A field of a row by its name, as in formats: "error", "target.model"."""
        return self.get_field(name, (row,), {})[0]

    def get_value(self, key: int | str, args: Sequence[Any], kwargs: Mapping[str, Any]) -> Any:
        """A field of the row."""
        (row,) = args
        return row[key] if isinstance(row, Mapping) or isinstance(key, int) else getattr(row, key)

    def format_field(self, value: Any, format_spec: str) -> str:
        """One field."""
        if value is None:
            return "-"
        if isinstance(value, list | tuple):
            return ", ".join(self.format_field(one, format_spec) for one in value)
        if format_spec in self.NAMED:
            return self.NAMED[format_spec](value)
        factor, star, spec = format_spec.rpartition("*")
        return format(float(factor) * value, spec) if star else format(value, spec)


def named(values: Mapping[str, object], separator: str) -> str:
    """Names, each with its value."""
    return separator.join(f"{name} {value}" for name, value in values.items())


def finite(x: float) -> float | None:
    """For JSON, which has no NaN."""
    return x if math.isfinite(x) else None


def rounded(values: Any) -> list[float | None]:
    """A curve for JSON."""
    return [finite(float(f"{x:.{DIGITS}g}")) for x in np.asarray(values, float)]
