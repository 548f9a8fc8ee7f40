"""The native file's beams as pydantic models."""

from __future__ import annotations

from typing import Annotated, Any, Self

from pydantic import BeforeValidator, Field, model_validator

from symofros.description.beams.beam import MAX_SECTIONS, SECTION, STATIONS, Beam, BeamLoad
from symofros.description.beams.elastic import CENTERS, Direction
from symofros.description.beams.shapes import Samples
from symofros.description.yaml.derived import NounEntry
from symofros.description.yaml.fields import Formula, Number, Six, fault
from symofros.description.yaml.schema_section import SectionEntry
from symofros.errors import Problem

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
    stretch: Count = 0
    shear_y: Count = 0
    shear_z: Count = 0
    segments: Annotated[int, Field(ge=1, le=200)] = 1
    stations: Annotated[list[Annotated[Number, Field(ge=0.0, le=1.0)]], Field(max_length=200)] = [*STATIONS]
    sections: Annotated[int, Field(ge=0, le=MAX_SECTIONS)] = 0
    shapes: dict[Direction, ShapeList] = {}
    loads: Annotated[list[BeamLoadEntry], Field(max_length=100)] = []
    section: SectionEntry | None = None
    """Material and shape, in place of rhoA, EI_y and the other properties of the section."""
    rhoA: Formula | None = None
    stiffness: Annotated[list[Six], Field(max_length=6)] = []

    @model_validator(mode="after")
    def _one_section(self) -> Self:
        stated = [label for label in (*SECTION, *CENTERS, "stiffness") if label in self.model_fields_set]
        if self.section is not None and stated:
            rule = "a section gives all properties per length"
            raise fault(Problem("a section and its properties", ", ".join(stated), rule, "keep the one or the other"))
        if self.section is None and self.rhoA is None:
            rule = "a beam has mass: rhoA, or a section"
            raise fault(Problem("a beam without mass", "neither rhoA nor section", rule, "add one of them"))
        return self

    def stated(self) -> dict[str, Any]:
        """The fields of the beam, those of its section among them."""
        stated = super().stated()
        del stated["section"]
        return stated | (self.section.build(stated["theory"]) if self.section is not None else {})
