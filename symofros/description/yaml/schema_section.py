"""Sections of beams in the native file, by material and shape."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Annotated, Any, Literal, Self, get_args

from pydantic import Field, model_validator

from symofros.description import sections
from symofros.description.beam import Theory
from symofros.description.yaml.fields import Formula, Number, PartEntry, fault
from symofros.errors import DescriptionError, Problem

ShapeName = Literal["rectangle", "circle", "tube", "ellipse", "box", "i_section", "l_section", "polygon"]
Outline = Annotated[
    list[Annotated[list[Number], Field(min_length=2, max_length=2)]], Field(min_length=3, max_length=1000)
]


def _maker(shape: str) -> tuple[Callable[..., sections.Section], list[str], list[str]]:
    """The function of a shape, its sizes, and those that it needs."""
    make = getattr(sections, shape)
    parameters = [p for p in inspect.signature(make).parameters.values() if p.name != "material"]
    return make, [p.name for p in parameters], [p.name for p in parameters if p.default is p.empty]


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
        _, sizes, needed = _maker(self.shape)
        stated = set(self._sizes())
        missing, superfluous = set(needed) - stated, stated - set(sizes)
        if missing or superfluous:
            listed = ", ".join(sorted(missing or superfluous))
            rule = f"{self.shape} has {', '.join(sizes)}"
            remedy = f"add {listed}" if missing else f"remove {listed}"
            raise fault(
                Problem(f"section: not the sizes of shape {self.shape}", ", ".join(sorted(stated)), rule, remedy)
            )
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
        make, _, _ = _maker(self.shape)
        return make(sections.Material(self.E, self.G, self.rho), **self._sizes()).beam_properties(theory)


_MATERIAL = ("shape", "E", "G", "rho")
assert set(get_args(ShapeName)) <= set(vars(sections))
