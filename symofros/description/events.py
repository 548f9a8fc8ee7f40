"""Events of a description: their formulas as the parser reads them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from symofros.base.arguments import shown
from symofros.base.events import Event
from symofros.description.values import Value, as_value
from symofros.errors import DescriptionError


def as_events(stated: Mapping[str, Any]) -> dict[str, Event]:
    """Events with their names, and their formulas as Values.

    Args:
        stated: Name -> formula or Event.

    Raises:
        DescriptionError: A text is no formula, or a name no text.
    """
    for name in stated:
        if not isinstance(name, str):
            raise DescriptionError("an event without a name", shown(name), "its name is a text", "{'grasp': ...}")
    return {name: _as_event(name, event) for name, event in stated.items()}


def _as_event(name: str, stated: Any) -> Event:
    event, what = stated if isinstance(stated, Event) else Event(stated), f"event '{name}'"
    action = event.action and {
        to: as_value(value, f"{what}, what its action sets '{to}' to") for to, value in event.action.items()
    }
    rests = None if event.rests is None else as_value(event.rests, f"{what}: rests")
    return replace(event, name=name, formula=as_value(event.formula, f"{what}: formula"), action=action, rests=rests)


def event_text(event: Event) -> str:
    """An event of a description in one line: "gap falls: grip = 1, once"."""
    way = {"both": "", "rising": " rises", "falling": " falls"}[event.direction]
    sets = [f"{name} = {_shown(value)}" for name, value in (event.action or {}).items()]
    more = ["ends the run"] * event.terminal + ["once"] * event.once
    more += [f"restitution {event.restitution:g}"] if event.restitution is not None else []
    more += [f"rests while {event.rests} > 0"] if event.rests is not None else []
    return f"{_shown(event.formula)}{way}" + (": " if sets or more else "") + ", ".join([*sets, *more])


def _shown(value: Value) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)
