"""Advice as a table for the terminal."""

from __future__ import annotations

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from symofros.studio.advice.advice import Advice

_COLORS = {"taken": "green", "refused": "red", "not tried": "yellow"}


def table_of(advice: Advice) -> RenderableType:
    """A table of all choices, then cost and error of the reduced model, times and notes."""
    table = Table(
        "what",
        "change",
        "verdict",
        "estimate",
        "simulated",
        "why",
        title=f"{advice.full.name}: errors in units of what is allowed",
    )
    for one in advice.choices:
        verdict = Text(one.verdict, _COLORS[one.verdict])
        simulated = "" if one.error is None else f"{one.error:.3g}"
        table.add_row(Text(one.subject), Text(one.change), verdict, f"{one.estimate:.3g}", simulated, Text(one.why))
    lines = [*advice.summary(), *timing(advice), *(f"note: {note}" for note in advice.notes)]
    return Group(table, *(Text(line) for line in lines))


def timing(advice: Advice) -> list[str]:
    """Measured times, which vary from run to run."""
    full, reduced = advice.full_cost.seconds, advice.cost.seconds
    return [f"measured: {1e3 * reduced:.3g} ms a run, the full model {1e3 * full:.3g} ms; {advice.runs} simulations"]
