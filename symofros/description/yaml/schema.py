"""The native file's shape as pydantic models: the reader validates with them, the JSON Schema is made from them.

Entries are derived from the dataclasses of the description (derived.py): a new field is added there, in one place, with
its default and its line of documentation. After a change, rewrite the published schema:
`python -m symofros.description.yaml.schema`.
"""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from symofros.description.beams.beam import Beam
from symofros.description.frames import Frame
from symofros.description.joints.joint import Joint, Limits
from symofros.description.joints.joint_kinds import JointKindName
from symofros.description.system import Body, Inertia, Input, Parameter, RigidBody
from symofros.description.values import Value
from symofros.description.yaml.derived import NounEntry
from symofros.description.yaml.fields import (
    MOMENTS,
    Entry,
    Formula,
    Name,
    Number,
    PartEntry,
    Reserved,
    Six,
    Three,
    Waiver,
    fault,
    listed,
    moments_mapping,
    parameter_mapping,
)
from symofros.description.yaml.schema_beam import BeamEntry
from symofros.description.yaml.schema_constraints import ClosureEntry, NonholonomicEntry, SwitchEntry
from symofros.description.yaml.schema_events import ShortEvent
from symofros.description.yaml.schema_forces import ConnectionEntry, ContactEntry, ElementEntry, LoadEntry, RotorEntry
from symofros.description.yaml.schema_solid import SolidEntry
from symofros.errors import Problem

VERSION = 1
SCHEMA_FILE = Path(__file__).with_name("schema.json")


def default_joint_name(body: str) -> str:
    """The name of a body's joint where the file gives none."""
    return f"q_{body}"


class MomentsEntry(PartEntry):
    """Moments and products of inertia [kg m^2]; products with the sign they have in the matrix."""

    ixx: Formula
    iyy: Formula
    izz: Formula
    ixy: Formula = 0.0
    ixz: Formula = 0.0
    iyz: Formula = 0.0

    def build(self) -> tuple[Value, ...]:
        """The six, in the order of an Inertia."""
        return tuple(getattr(self, name) for name in MOMENTS)


class InertiaEntry(NounEntry, noun=Inertia, checked=True):
    mass: Formula
    moments: (
        Annotated[MomentsEntry, BeforeValidator(moments_mapping, json_schema_input_type=Three | Six | MomentsEntry)]
        | None
    ) = None


class LimitsEntry(NounEntry, noun=Limits):
    pass


class JointEntry(NounEntry, noun=Joint):
    name: Name | None = None
    kind: JointKindName
    effort: Annotated[
        list[Formula], Field(max_length=6), BeforeValidator(listed, json_schema_input_type=list[Formula] | Formula)
    ] = []
    limits: LimitsEntry | None = None
    coordinates: Annotated[list[Name], Field(max_length=6)] = []
    elements: Annotated[list[ElementEntry], Field(max_length=100)] = []
    rotors: Annotated[list[RotorEntry], Field(max_length=100)] = []

    def of_body(self, body: str) -> Joint:
        """The Joint of that body."""
        joint: Joint = self.build(name=default_joint_name(body) if self.name is None else self.name)
        return joint


class FrameEntry(NounEntry, noun=Frame, without=("name",)):
    at: Annotated[Number, Field(ge=0.0, le=1.0)] | None = None


class BodyEntry(Entry):
    """A body and the joint that carries it; without a joint it is the base. Rigid, unless it is a beam."""

    joint: JointEntry | None = None
    inertia: InertiaEntry | None = None
    """A rigid body without one is massless."""
    solid: SolidEntry | None = None
    """What its inertia follows from, where that is not stated."""
    beam: BeamEntry | None = None
    """What makes it a beam; then it has a joint, no inertia of its own, and frames at stations of its axis."""
    frames: Annotated[dict[Name, FrameEntry | None], Field(max_length=1000)] | None = None
    waive: list[Waiver] = []
    """Checks that this body is allowed to fail."""
    loads: Annotated[list[LoadEntry], Field(max_length=100)] = []
    """Forces and torques on it."""

    @model_validator(mode="after")
    def _one_nature(self) -> Self:
        if self.beam is not None:
            also = [key for key in ("inertia", "solid", "loads") if getattr(self, key)]
            if also or self.joint is None:
                joint_entries = f"also {' and '.join(also)}" if also else "no joint"
                rule = "a beam has a joint, its mass in rhoA and its loads under beam"
                raise fault(Problem("a beam that is not only a beam", joint_entries, rule, "kind: fixed clamps a beam"))
        if self.inertia is not None and self.solid is not None:
            rule = "the inertia of a body is stated, or follows from a solid"
            raise fault(Problem("a body with two inertias", "inertia and solid", rule, "remove one of them"))
        return self

    def build(self, name: str) -> Body:
        """The body of that name."""
        frames = tuple((entry or FrameEntry()).build(name=frame) for frame, entry in (self.frames or {}).items())
        joint, waive = self.joint.of_body(name) if self.joint else None, tuple(self.waive)
        if self.beam is not None:
            beam: Beam = self.beam.build(name=name, joint=joint, frames=frames or None, waive=waive)
            return beam
        matter = self.solid if self.inertia is None else self.inertia
        inertia = None if matter is None else matter.build()
        return RigidBody(name, joint, inertia, frames, waive, tuple(load.build() for load in self.loads))


class ParameterEntry(NounEntry, noun=Parameter, without=("name",)):
    pass


class InputEntry(NounEntry, noun=Input, without=("name",)):
    pass


class SystemEntry(Entry):
    """Entries that concern the whole system."""

    name: Name | None = None
    """Of the model; the file's name if not given."""
    gravity: Three = [0.0, 0.0, -9.81]
    """Acceleration of gravity in the world frame [m/s^2]."""


ShortParameter = Annotated[
    ParameterEntry, BeforeValidator(parameter_mapping, json_schema_input_type=Number | ParameterEntry)
]


class NativeFile(Entry):
    """A SYMOFROS model file, or a part that others include."""

    symofros: Literal[1]
    """Version of the format."""
    include: Annotated[list[Name], Field(max_length=100)] | None = None
    """Files to merge, relative to this one and inside the main file's folder."""
    system: SystemEntry | None = None
    parameters: Annotated[dict[Name, ShortParameter], Field(max_length=100_000)] | None = None
    inputs: Annotated[dict[Name, InputEntry | None], Field(max_length=10_000)] | None = None
    bodies: Annotated[dict[Name, BodyEntry | None], Field(max_length=10_000)] | None = None
    """In order: coordinates are numbered depth first in this order."""
    connections: Annotated[dict[Name, ConnectionEntry], Field(max_length=10_000)] | None = None
    """Springs and dampers between frames."""
    contacts: Annotated[dict[Name, ContactEntry], Field(max_length=10_000)] | None = None
    """Balls on one frame that the surface of a solid on another pushes back."""
    virtual_power: Annotated[dict[Name, dict[Name, Formula]], Field(max_length=10_000)] | None = None
    """Internal forces: for each, speed (`dq1`) -> force by formula."""
    potentials: Annotated[dict[Name, Formula], Field(max_length=10_000)] | None = None
    """Potential energies by formula of coordinates, parameters and `t` [J]."""
    states: Annotated[dict[Name, Formula], Field(max_length=10_000)] | None = None
    """States of forces: for each the formula of its rate. Formulas of forces may name them; they begin at zero."""
    closures: Annotated[dict[Name, ClosureEntry], Field(max_length=10_000)] | None = None
    """Frames that stay together: they close loops of the tree."""
    couplings: Annotated[dict[Name, Formula], Field(max_length=10_000)] | None = None
    """Conditions on coordinates: formulas of coordinates and parameters that stay zero (`q2 - 3*q1`)."""
    nonholonomic: Annotated[dict[Name, NonholonomicEntry], Field(max_length=10_000)] | None = None
    """Conditions on speeds."""
    switches: Annotated[dict[Name, SwitchEntry], Field(max_length=10_000)] | None = None
    """When constraints hold: for each that can be released, by its name."""
    events: Annotated[dict[Name, ShortEvent], Field(max_length=10_000)] | None = None
    """What runs look for, and do there: for each a formula whose zeros count, or a mapping."""
    options: Reserved = None


@cache
def json_schema() -> dict[str, Any]:
    """The JSON Schema of the native file."""
    schema = NativeFile.model_json_schema()
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


def schema_text() -> str:
    """The JSON Schema as it is published."""
    return json.dumps(json_schema(), indent=2) + "\n"


if __name__ == "__main__":
    SCHEMA_FILE.write_text(schema_text(), encoding="utf-8")
