"""The native file's beams as pydantic models."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from symofros.description.beam import Beam, BeamLoad, Direction, Family, Retain, Samples, UserShape
from symofros.description.frames import Frame
from symofros.description.joint import Joint
from symofros.description.yaml.fields import CheckedEntry, Entry, Formula, Name, Number, Three, three

Count = Annotated[int, Field(ge=0, le=40)]
Sampled = Annotated[list[Number], Field(min_length=4, max_length=10_000)]


class SamplesEntry(CheckedEntry):
    """A shape function by its values at stations."""

    xi: Sampled
    """x/L, rising from 0 to 1."""
    values: Sampled

    def build(self) -> Samples:
        """The Samples."""
        return Samples(tuple(self.xi), tuple(self.values))


def _samples(stated: Any) -> Any:
    """A mapping as samples; anything else is left to be read as a formula."""
    return SamplesEntry.model_validate(stated) if isinstance(stated, dict) else stated


ShapeEntry = Annotated[SamplesEntry | Formula, BeforeValidator(_samples, json_schema_input_type=SamplesEntry | Formula)]
ShapeList = Annotated[list[ShapeEntry], Field(max_length=40)]


class BeamLoadEntry(Entry):
    """A force and a moment on the centroid axis, at a station or spread over the length."""

    force: Three = [0.0, 0.0, 0.0]
    """[N], or [N/m] if spread; then also by formula of the station x [m]."""
    torque: Three = [0.0, 0.0, 0.0]
    """[N m], or [N m/m] if spread."""
    at: Annotated[Number, Field(ge=0.0, le=1.0)] | None = None
    """x/L of the station; spread over the length if not given."""
    axes: Literal["body", "world"] = "body"

    def build(self) -> BeamLoad:
        """The BeamLoad."""
        return BeamLoad(three(self.force), three(self.torque), self.at, self.axes)


class BeamEntry(Entry):
    """A slender elastic body along x, clamped at its root. Section properties may be formulas of the station x [m]."""

    length: Formula
    """[m]"""
    rhoA: Formula
    """Mass per length [kg/m]."""
    EI_z: Formula = 0.0
    """Stiffness against bending in the x-y plane [N m^2]."""
    EI_y: Formula = 0.0
    """Stiffness against bending in the x-z plane [N m^2]."""
    GJ: Formula = 0.0
    """Stiffness against twist [N m^2]."""
    rhoJ: Formula = 0.0
    """Polar moment of inertia per length [kg m]."""
    rhoI_y: Formula = 0.0
    """Moment of inertia per length about y [kg m], counted with rotary_inertia."""
    rhoI_z: Formula = 0.0
    bend_y: Count = 0
    """Number of shape functions for the displacement along y; 0 is rigid."""
    bend_z: Count = 0
    twist: Count = 0
    family: Family = "spline"
    shapes: dict[Direction, ShapeList] = {}
    """The user's own functions, for family user: formulas of xi = x/L, or samples."""
    damping: Formula = 0.0
    """Voigt-Kelvin retardation time [s]."""
    foreshortening: bool = True
    """Whether bending pulls the axis back."""
    rotary_inertia: bool = False
    """Whether sections resist being turned by bending."""
    retain: Retain = "first_order"
    """How far elastic terms are kept."""
    loads: Annotated[list[BeamLoadEntry], Field(max_length=100)] = []

    def build(self, name: str, joint: Joint, frames: dict[Name, Frame], waive: tuple[str, ...]) -> Beam:
        """The Beam of that name."""
        shapes = tuple((key, tuple(map(_built, functions))) for key, functions in self.shapes.items())
        given: dict[str, Any] = {key: getattr(self, key) for key in type(self).model_fields if key != "shapes"}
        given |= {"loads": tuple(load.build() for load in self.loads), "waive": waive, "shapes": shapes}
        if frames:
            given["frames"] = tuple(frames.values())
        return Beam(name, joint, **given)


def _built(shape: SamplesEntry | UserShape) -> UserShape:
    return shape.build() if isinstance(shape, SamplesEntry) else shape
