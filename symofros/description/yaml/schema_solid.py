"""Inertia of bodies in the native file by a homogeneous solid."""

from __future__ import annotations

from typing import Any, Literal, Self, get_args

from pydantic import model_validator

from symofros.description import solids
from symofros.description.system import Inertia
from symofros.description.yaml.fields import Formula, PartEntry, Three, check_sizes, fault, sizes_of
from symofros.errors import DescriptionError

SolidName = Literal["box", "cylinder", "sphere", "ellipsoid"]


class SolidEntry(PartEntry):
    """A homogeneous solid that mass, mass centre and moments of inertia follow from, in place of these."""

    shape: SolidName
    density: Formula
    """Density [kg/m^3]."""
    x: Formula | None = None
    """Size of a box along x, semi-axis of an ellipsoid [m]."""
    y: Formula | None = None
    """Size along y, semi-axis of an ellipsoid [m]."""
    z: Formula | None = None
    """Size along z, semi-axis of an ellipsoid [m]."""
    radius: Formula | None = None
    """Outer radius of a cylinder or a sphere [m]."""
    length: Formula | None = None
    """Length of a cylinder [m]."""
    hole: Formula | None = None
    """Radius of a concentric hole, of a tube or a shell [m]."""
    axis: Literal["x", "y", "z"] | None = None
    """Axis of the body frame that a cylinder lies along; z by default."""
    center: Three = [0.0, 0.0, 0.0]
    """Position of its middle in the body frame [m]."""

    @model_validator(mode="after")
    def _possible(self) -> Self:
        check_sizes("solid", getattr(solids, self.shape), self._sizes(), _COMMON)
        try:
            self.build()
        except DescriptionError as error:
            raise fault(error.problem) from None
        return self

    def _sizes(self) -> dict[str, Any]:
        entries = {name: getattr(self, name) for name in type(self).model_fields if name not in _COMMON}
        return {name: value for name, value in entries.items() if value is not None}

    def build(self) -> Inertia:
        """The inertia that a body takes of it."""
        inertia: Inertia = getattr(solids, self.shape)(self.density, **self._sizes(), center=tuple(self.center))
        return inertia


_COMMON = ("shape", "density", "center")
# Shape -> names of its sizes.
SOLID_SIZES = {shape: sizes_of(getattr(solids, shape), _COMMON) for shape in get_args(SolidName)}
