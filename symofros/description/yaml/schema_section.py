"""Sections of beams in the native file, by material and shape."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self, get_args

from pydantic import Field, model_validator

from symofros.description import sections
from symofros.description.beam import Theory
from symofros.description.yaml.fields import Formula, Number, PartEntry, check_sizes, fault, sizes_of
from symofros.errors import DescriptionError

ShapeName = Literal["rectangle", "circle", "tube", "ellipse", "box", "i_section", "l_section", "polygon"]
Outline = Annotated[
    list[Annotated[list[Number], Field(min_length=2, max_length=2)]], Field(min_length=3, max_length=1000)
]


class SectionEntry(PartEntry):
    """A section by material and shape, in place of stiffness and mass per length."""

    shape: ShapeName
    E: Formula
    """Young's modulus [N/m^2]."""
    G: Formula
    """Shear modulus [N/m^2]."""
    rho: Formula
    """Density [kg/m^3]."""
    y: Formula | None = None
    """Size along y; the semi-axis of an ellipse [m]."""
    z: Formula | None = None
    """Size along z; the semi-axis of an ellipse [m]."""
    radius: Formula | None = None
    """Outer radius of a circle or a tube [m]."""
    thickness: Formula | None = None
    """Thickness of the walls of a tube or a box, of the legs of an L section [m]."""
    web: Formula | None = None
    """Thickness of the web of an I section [m]."""
    flange: Formula | None = None
    """Thickness of the flanges of an I section [m]."""
    outline: Outline | None = None
    """Corners [y, z] of a polygon, in order [m]."""
    holes: Annotated[list[Outline], Field(max_length=20)] | None = None
    """Outlines of holes of a polygon [m]."""

    @model_validator(mode="after")
    def _possible(self) -> Self:
        check_sizes("section", getattr(sections, self.shape), self._sizes(), ("material",))
        try:
            self.build()
        except DescriptionError as error:
            raise fault(error.problem) from None
        return self

    def _sizes(self) -> dict[str, Any]:
        entries = {label: getattr(self, label) for label in type(self).model_fields if label not in _MATERIAL}
        return {label: value for label, value in entries.items() if value is not None}

    def build(self, theory: Theory = "second_order") -> dict[str, Any]:
        """The properties that a beam of a theory takes of it."""
        material = sections.Material(self.E, self.G, self.rho)
        section: sections.Section = getattr(sections, self.shape)(material, **self._sizes())
        return section.beam_properties(theory)


_MATERIAL = ("shape", "E", "G", "rho")
# Shape -> names of its sizes.
SECTION_SIZES = {shape: sizes_of(getattr(sections, shape), ("material",)) for shape in get_args(ShapeName)}
