"""Sections of beams in the native file, by material and shape."""

from __future__ import annotations

from types import ModuleType
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from symofros.description.beams import sections
from symofros.description.beams.elastic import Theory
from symofros.description.yaml.fields import Formula, Number, ShapedEntry

ShapeName = Literal["rectangle", "circle", "tube", "ellipse", "box", "i_section", "l_section", "polygon"]
Outline = Annotated[
    list[Annotated[list[Number], Field(min_length=2, max_length=2)]], Field(min_length=3, max_length=1000)
]


class SectionEntry(ShapedEntry):
    """A section by material and shape, in place of stiffness and mass per length."""

    noun = "section"
    makers: ClassVar[ModuleType] = sections
    common = ("shape", "E", "G", "rho")
    given = ("material",)

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

    def build(self, theory: Theory = "second_order") -> dict[str, Any]:
        """The properties that a beam of a theory takes of it."""
        material = sections.Material(self.E, self.G, self.rho)
        section: sections.Section = getattr(sections, self.shape)(material, **self.sizes)
        return section.beam_properties(theory)
