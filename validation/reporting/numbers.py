"""Numbers as people and JSON read them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

# Digits of a curve's points in JSON: more than a figure shows.
DIGITS = 5


def short(x: float | None) -> str:
    """A number as text for display; empty for an infinite one, the unbounded side of a bound."""
    if x is None or math.isnan(x):
        return "NaN"
    if math.isinf(x):
        return ""
    return f"{x:.6g}" if x == 0.0 or 1e-3 <= abs(x) < 1e5 else f"{x:.2e}"


def digits(x: float | None, number: int = 2) -> str:
    """An error in so many digits, 3.2e-15; exact agreement is a bare 0."""
    return "NaN" if x is None or math.isnan(x) else "0" if x == 0.0 else f"{x:.{number - 1}e}"


def times(x: float) -> str:
    """A ratio to two digits, as text with a multiplication sign."""
    return f"{short(float(f'{x:.2g}'))}×"


def counted(number: int, noun: str) -> str:
    """A number with its noun: "1 model", "2 models", "2 studies", "2 ways"."""
    figures = f"{number:,}".replace(",", " ") if number >= 10_000 else str(number)
    plural = f"{noun[:-1]}ies" if noun.endswith("y") and noun[-2] not in "aeou" else f"{noun}s"
    return f"{figures} {noun if number == 1 else plural}"


def duration(seconds: float) -> str:
    """A time in the unit that suits it."""
    if not math.isfinite(seconds):
        return "-"
    size, unit = next((pair for pair in ((1.0, "s"), (1e-3, "ms")) if seconds >= pair[0]), (1e-6, "µs"))
    return f"{seconds / size:.3g} {unit}"


def compact(x: float) -> str:
    """Three digits or more."""
    return f"{x:.1f}" if x < 100 else f"{x:.0f}"


def formatted(value: float | Iterable[float] | None, form: str | Callable[[float], str]) -> str:
    """A number, or several, by a format; "-" where there is none."""
    if value is None:
        return "-"
    values = [value] if isinstance(value, int | float) else value
    return ", ".join(format(x, form) if isinstance(form, str) else form(x) for x in values)


def named(values: Mapping[str, object], separator: str) -> str:
    """Names, each with its value."""
    return separator.join(f"{name} {value}" for name, value in values.items())


def finite(x: float) -> float | None:
    """The number for JSON, which has no NaN: None if it is not finite."""
    return x if math.isfinite(x) else None


def rounded(values: Any) -> list[float | None]:
    """A curve for JSON."""
    return [finite(float(f"{x:.{DIGITS}g}")) for x in np.asarray(values, float)]
