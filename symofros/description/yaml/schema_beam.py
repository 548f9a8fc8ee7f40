"""The native file's beams as pydantic models."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from symofros.description.beam import Beam, BeamLoad, Direction, Samples
from symofros.description.yaml.derived import NounEntry
from symofros.description.yaml.fields import Formula, Number

Count = Annotated[int, Field(ge=0, le=40)]
Sampled = Annotated[list[Number], Field(min_length=4, max_length=10_000)]


class SamplesEntry(NounEntry, noun=Samples, checked=True):
    xi: Sampled
    values: Sampled


def _samples(stated: Any) -> Any:
    """A mapping as samples; anything else is left to be read as a formula."""
    return SamplesEntry.model_validate(stated) if isinstance(stated, dict) else stated


ShapeEntry = Annotated[SamplesEntry | Formula, BeforeValidator(_samples, json_schema_input_type=SamplesEntry | Formula)]
ShapeList = Annotated[list[ShapeEntry], Field(max_length=40)]


class BeamLoadEntry(NounEntry, noun=BeamLoad):
    at: Annotated[Number, Field(ge=0.0, le=1.0)] | None = None


class BeamEntry(NounEntry, noun=Beam, without=("name", "joint", "frames", "waive")):
    bend_y: Count = 0
    bend_z: Count = 0
    twist: Count = 0
    segments: Annotated[int, Field(ge=1, le=200)] = 1
    shapes: dict[Direction, ShapeList] = {}
    loads: Annotated[list[BeamLoadEntry], Field(max_length=100)] = []
