"""Events of a simulation that is asked for in the page: formulas whose zeros are found, and limits of joints."""

from __future__ import annotations

import math
from typing import Any

import symofros as sf
from symofros.base.names import speed_column, symbol_of
from symofros.errors import SymofrosError
from symofros.studio.editor.jobs.request import Json


def events_of(model: sf.Model, options: Json) -> dict[str, sf.Event]:
    """Events by name: those that are stated, and where `stop_at_limits` is true one for each end of a joint's limits.

    Args:
        model: Model that moves.
        options: `events`: a list of name, formula, direction, terminal.

    Raises:
        SymofrosError: Two events have one name, or one has none.
    """
    events: dict[str, sf.Event] = {}
    for each in options.get("events") or ():
        name, formula = str(each.get("name", "")).strip(), str(each.get("formula", "")).strip()
        if not name or not formula or name in events:
            found = f"name '{name}', formula '{formula}'"
            raise SymofrosError(
                "an event without a name of its own, or without a formula", found, "each event has both", "name it"
            )
        events[name] = sf.Event(formula, direction=each.get("direction", "both"), terminal=each.get("terminal") is True)
    return events | (_limits(model) if options.get("stop_at_limits") is True else {})


def _limits(model: sf.Model) -> dict[str, sf.Event]:
    """Coordinates and speeds that reach what their joints state, from inside."""
    names = model.names
    symbols = {
        "q": [symbol_of(name) for name in names.q],
        "v": [speed_column(name, names.q) for name in names.v],
    }
    events = {}
    for limit in model.record.joint_limits:
        if limit.of not in symbols:
            continue  # An effort is what an input is asked to be.
        symbol = symbols[limit.of][limit.entry]
        for bound, end, direction in ((limit.lower, "least", "falling"), (limit.upper, "largest", "rising")):
            if math.isfinite(bound):
                events[f"{symbol} at its {end}, {bound:.6g}"] = _crossing(symbol, bound, direction)
    return events


def _crossing(symbol: str, bound: float, direction: Any) -> sf.Event:
    return sf.Event(f"{symbol} - ({bound!r})", direction=direction, terminal=True)
