"""What the dashboard shows of one report."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from validation.evidence.findings import Chart, Curve, Kind, Mark
from validation.reporting.page import short

# Values over this many times the smallest are better seen on a logarithmic axis.
_WIDE = 1e3
# Curves of a chart; the whole report shows the rest.
_MOST = 6


@dataclass(frozen=True)
class Fact:
    """One number with its meaning.

    Attributes:
        value: As shown.
        label: What it is, with unit and bound.
        ok: Its verdict; None where nothing was asked of it.
    """

    value: str
    label: str
    ok: bool | None = None


@dataclass(frozen=True)
class Card:
    """A report in short.

    Attributes:
        headline: What it found, in a sentence.
        ok: Its verdict; None for a measurement without one.
        facts: Its key figures.
        charts: Its most telling curves.
    """

    headline: str
    ok: bool | None
    facts: tuple[Fact, ...] = ()
    charts: tuple[Chart, ...] = ()


def counted(number: int, noun: str) -> str:
    """A number with its noun: "1 model", "2 models"."""
    digits = f"{number:,}".replace(",", " ") if number >= 10_000 else str(number)
    return f"{digits} {noun}{'' if number == 1 else 's'}"


def bounded(checks: Sequence[Mapping[str, Any]]) -> tuple[str, bool]:
    """What checks come to, in words, and whether all are kept."""
    missed = sum(not check["ok"] for check in checks)
    return ("all within their bounds" if not missed else f"{missed} out of bounds"), not missed


def chart_of(data: Mapping[str, Any]) -> Chart:
    """A chart as reports keep it in JSON; one of an older layout gets the axes that suit its values.

    Args:
        data: As `page.figure_data` wrote it.
    """
    curves = data["curves"][:_MOST]
    log = data.get("log") or [_wide(curves, "x"), _wide(curves, "y")]
    shown = [
        Curve(curve["label"], _numbers(curve["x"]), _numbers(curve["y"]), k, _kind(curve))
        for k, curve in enumerate(curves)
    ]
    marks = tuple(Mark(label, at) for label, at in data.get("marks", {}).items())
    return Chart(data["title"], data["x"], data["y"], tuple(shown), marks, bool(log[0]), bool(log[1]))


def _kind(curve: Mapping[str, Any]) -> Kind:
    kind: Kind = curve.get("kind", "joined" if len(curve["x"]) < 20 else "line")
    return kind


def _numbers(values: Sequence[float | None]) -> np.ndarray:
    return np.array([np.nan if value is None else value for value in values], float)


def _wide(curves: Sequence[Mapping[str, Any]], axis: str) -> bool:
    values = np.concatenate([_numbers(curve[axis]) for curve in curves])
    values = values[np.isfinite(values)]
    return bool(len(values) and values.min() > 0.0 and values.max() > _WIDE * values.min())


def times(value: float) -> str:
    """A ratio."""
    return f"{short(float(f'{value:.2g}'))}×"
