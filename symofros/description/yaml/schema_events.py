"""Events and their actions as pydantic models: of the native file, and of the blocks of diagrams' files."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from symofros.base.events import Event
from symofros.description.yaml.derived import NounEntry
from symofros.description.yaml.fields import Formula, Name


class EventEntry(NounEntry, noun=Event, without=("name",), checked=True):
    formula: Formula
    action: Annotated[dict[Name, Formula], Field(min_length=1, max_length=1000)] | None = None
    rests: Formula | None = None


def event_mapping(stated: Any) -> Any:
    """A bare formula as the event that it abbreviates."""
    if isinstance(stated, dict):  # Diagrams' files of version 0.1 were written with an empty name.
        return {key: value for key, value in stated.items() if (key, value) != ("name", "")}
    return stated if stated is None else {"formula": stated}


ShortEvent = Annotated[EventEntry, BeforeValidator(event_mapping, json_schema_input_type=Formula | EventEntry)]
