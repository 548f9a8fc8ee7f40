"""Inertia of bodies in the native file by a homogeneous solid."""

from __future__ import annotations

from types import ModuleType
from typing import ClassVar, Literal

from symofros.description import solids
from symofros.description.system import Inertia
from symofros.description.yaml.fields import Formula, ShapedEntry, Three

SolidName = Literal["box", "cylinder", "sphere", "ellipsoid"]


class SolidEntry(ShapedEntry):
    """A homogeneous solid that mass, mass centre and moments of inertia follow from, in place of these."""

    noun = "solid"
    makers: ClassVar[ModuleType] = solids
    common = ("shape", "density", "center")
    given = common

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

    def build(self) -> Inertia:
        """The inertia that a body takes of it."""
        inertia: Inertia = getattr(solids, self.shape)(self.density, **self.sizes, center=tuple(self.center))
        return inertia
