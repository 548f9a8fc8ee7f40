"""The native file's shape as pydantic models: the reader validates with them, the JSON Schema is made from them.

Each entry knows how to become its noun (`build`), so that a new field is added in one file. After a change, rewrite
the published schema: `python -m symofros.description.yaml.schema`.
"""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, ConfigDict, Field, model_validator

from symofros.description.frames import Frame
from symofros.description.joint import WORLD, Joint, Limits
from symofros.description.joint_kinds import JointKindName
from symofros.description.system import Body, Inertia, Input, Parameter, RigidBody
from symofros.description.values import IDENTITY, Rotation, RotationKind
from symofros.description.yaml.fields import (
    MOMENTS,
    CheckedEntry,
    Entry,
    Formula,
    Four,
    Matrix,
    Name,
    Number,
    Reserved,
    Six,
    Text,
    Three,
    Waiver,
    fault,
    listed,
    moments_mapping,
    parameter_mapping,
    three,
)
from symofros.description.yaml.schema_beam import BeamEntry
from symofros.description.yaml.schema_constraints import ClosureEntry, NonholonomicEntry
from symofros.description.yaml.schema_forces import ConnectionEntry, ElementEntry, LoadEntry, RotorEntry
from symofros.errors import Problem

VERSION = 1
SCHEMA_FILE = Path(__file__).with_name("schema.json")
ROTATIONS: tuple[RotationKind, ...] = ("rpy", "axis_angle", "quaternion", "matrix")


def default_joint_name(body: str) -> str:
    """The name of a body's joint where the file gives none."""
    return f"q_{body}"


class RotationEntry(Entry):
    """A constant rotation, in exactly one of four forms."""

    model_config = ConfigDict(json_schema_extra={"minProperties": 1, "maxProperties": 1})

    rpy: Three | None = None
    """Roll, pitch, yaw about fixed axes [rad]: Rz(yaw) Ry(pitch) Rx(roll), as in URDF."""
    axis_angle: Four | None = None
    """Axis x, y, z and the angle [rad]."""
    quaternion: Four | None = None
    """x, y, z, w: scalar last."""
    matrix: Matrix | None = None
    """Three rows of three."""

    @model_validator(mode="after")
    def _one_form(self) -> Self:
        given = [kind for kind in ROTATIONS if getattr(self, kind) is not None]
        if len(given) != 1:
            found = ", ".join(given) or "none of them"
            raise fault(Problem("not exactly one form", found, f"exactly one of {', '.join(ROTATIONS)}", "keep one"))
        return self

    def build(self) -> Rotation:
        """The Rotation."""
        if self.matrix is not None:
            return Rotation.matrix(self.matrix)
        kind, values = next((kind, values) for kind in ROTATIONS if (values := getattr(self, kind)) is not None)
        return Rotation(kind, tuple(values))


def _rotation(entry: RotationEntry | None) -> Rotation:
    return entry.build() if entry else IDENTITY


class MomentsEntry(Entry):
    """Moments and products of inertia [kg m^2]; products with the sign they have in the matrix."""

    ixx: Formula
    iyy: Formula
    izz: Formula
    ixy: Formula = 0.0
    ixz: Formula = 0.0
    iyz: Formula = 0.0


class InertiaEntry(CheckedEntry):
    """Mass, mass centre and inertia matrix of a rigid body."""

    mass: Formula
    """[kg]"""
    center_of_mass: Three = [0.0, 0.0, 0.0]
    """From the body's origin, in the body frame [m]."""
    moments: (
        Annotated[MomentsEntry, BeforeValidator(moments_mapping, json_schema_input_type=Three | Six | MomentsEntry)]
        | None
    ) = None
    """Ixx, Iyy, Izz and, if not zero, Ixy, Ixz, Iyz [kg m^2]."""
    about: Literal["center_of_mass", "body"] = "center_of_mass"
    """The point the moments are about; with `body`, they are along the body's axes."""
    rotation: RotationEntry | None = None
    """From the body frame to the axes of the moments; only with about: center_of_mass."""

    def build(self) -> Inertia:
        """The Inertia."""
        moments = [getattr(self.moments, name) for name in MOMENTS] if self.moments else [0.0] * 6
        x, y, z = self.center_of_mass
        xx, yy, zz, xy, xz, yz = moments
        return Inertia(self.mass, (x, y, z), (xx, yy, zz, xy, xz, yz), self.about, _rotation(self.rotation))


class LimitsEntry(Entry):
    """Bounds of a one-coordinate joint: data, not forces."""

    lower: Number | None = None
    upper: Number | None = None
    velocity: Number | None = None
    effort: Number | None = None

    def build(self) -> Limits:
        """The Limits."""
        return Limits(self.lower, self.upper, self.velocity, self.effort)


class JointEntry(Entry):
    """How a body moves on its parent."""

    name: Name | None = None
    """Also the name of the coordinate; `q_` and the body's name if not given."""
    kind: JointKindName
    parent: Name = WORLD
    """The body that carries this one; `world` is the ground."""
    frame: Name | None = None
    """The parent's frame that the joint sits in; its body frame if not given."""
    position: Three = [0.0, 0.0, 0.0]
    """From that frame's origin, in that frame [m]."""
    rotation: RotationEntry | None = None
    """From that frame to the joint's."""
    axis: Three = [0.0, 0.0, 1.0]
    """Of a joint that turns about or slides along one, in the joint's frame; first axis of a universal joint."""
    actuated: bool = False
    """Adds an input for each speed: an effort on the joint."""
    effort: Annotated[
        list[Formula], Field(max_length=6), BeforeValidator(listed, json_schema_input_type=list[Formula] | Formula)
    ] = []
    """One formula a speed, of inputs, parameters, coordinates, speeds (`dq1`) and `t` [N m or N]."""
    limits: LimitsEntry | None = None
    axis2: Three = [0.0, 1.0, 0.0]
    """Second axis of a universal joint, in the frame after the first turn."""
    pitch: Formula = 0.0
    """Of a screw joint [m/rad]."""
    coordinates: Annotated[list[Name], Field(max_length=6)] = []
    """Names of the coordinates of a general joint."""
    moving_position: Three = [0.0, 0.0, 0.0]
    """Of a general joint: where it moves to, by formulas of its coordinates [m]."""
    moving_rotation: RotationEntry | None = None
    """Of a general joint: how it turns, likewise."""
    prescribed: bool = False
    """The motion is given: coordinates, speeds and their rates are inputs."""
    elements: Annotated[list[ElementEntry], Field(max_length=100)] = []
    """Springs, dampers, stops and friction."""
    armature: Formula = 0.0
    """Inertia added to each speed [kg m^2 or kg]."""
    rotors: Annotated[list[RotorEntry], Field(max_length=100)] = []
    """Rotors that its speeds drive, with their gyroscopic effect."""

    def build(self, body: str) -> Joint:
        """The Joint of that body."""
        return Joint(
            name=default_joint_name(body) if self.name is None else self.name,
            kind=self.kind,
            parent=self.parent,
            frame=self.frame,
            position=three(self.position),
            rotation=_rotation(self.rotation),
            axis=three(self.axis),
            actuated=self.actuated,
            effort=tuple(self.effort),
            limits=self.limits.build() if self.limits else None,
            axis2=three(self.axis2),
            pitch=self.pitch,
            coordinates=tuple(self.coordinates),
            moving_position=three(self.moving_position),
            moving_rotation=_rotation(self.moving_rotation),
            prescribed=self.prescribed,
            elements=tuple(element.build() for element in self.elements),
            armature=self.armature,
            rotors=tuple(rotor.build() for rotor in self.rotors),
        )


class FrameEntry(Entry):
    """A frame fixed on a body."""

    position: Three = [0.0, 0.0, 0.0]
    """From the body's origin, in the body frame [m]."""
    rotation: RotationEntry | None = None
    """From the body frame to this one."""

    def build(self, name: str) -> Frame:
        """The Frame of that name."""
        x, y, z = self.position
        return Frame(name, (x, y, z), _rotation(self.rotation))


class BodyEntry(Entry):
    """A body and the joint that carries it; without a joint it is the base. Rigid, unless it is a beam."""

    joint: JointEntry | None = None
    inertia: InertiaEntry | None = None
    """A rigid body without one is massless."""
    beam: BeamEntry | None = None
    """What makes it a beam; then it has a joint, no inertia of its own, and one frame at most: its tip."""
    frames: Annotated[dict[Name, FrameEntry | None], Field(max_length=1000)] | None = None
    waive: list[Waiver] = []
    """Checks that this body is allowed to fail."""
    loads: Annotated[list[LoadEntry], Field(max_length=100)] = []
    """Forces and torques on it."""

    @model_validator(mode="after")
    def _one_nature(self) -> Self:
        if self.beam is not None:
            also = [key for key in ("inertia", "loads") if getattr(self, key)]
            if also or self.joint is None:
                found = f"also {' and '.join(also)}" if also else "no joint"
                rule = "a beam has a joint, its mass in rhoA and its loads under beam"
                raise fault(Problem("a beam that is not only a beam", found, rule, "kind: fixed clamps a beam"))
        return self

    def build(self, name: str) -> Body:
        """The body of that name."""
        frames = {frame: (entry or FrameEntry()).build(frame) for frame, entry in (self.frames or {}).items()}
        if self.beam is not None and self.joint is not None:
            return self.beam.build(name, self.joint.build(name), frames, tuple(self.waive))
        return RigidBody(
            name,
            self.joint.build(name) if self.joint else None,
            self.inertia.build() if self.inertia else None,
            tuple(frames.values()),
            tuple(self.waive),
            tuple(load.build() for load in self.loads),
        )


class ParameterEntry(Entry):
    """A named number, given at run time unless constant."""

    value: Number
    unit: Text = ""
    constant: bool = False
    """Hard-coded in the C code."""
    description: Text = ""

    def build(self, name: str) -> Parameter:
        """The Parameter of that name."""
        return Parameter(name, float(self.value), self.unit, self.constant, self.description)


class InputEntry(Entry):
    """A named input, for formulas of efforts."""

    unit: Text = ""
    description: Text = ""

    def build(self, name: str) -> Input:
        """The Input of that name."""
        return Input(name, self.unit, self.description)


class SystemEntry(Entry):
    """What concerns the whole."""

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
    virtual_power: Annotated[dict[Name, dict[Name, Formula]], Field(max_length=10_000)] | None = None
    """Internal forces: for each, speed (`dq1`) -> force by formula."""
    potentials: Annotated[dict[Name, Formula], Field(max_length=10_000)] | None = None
    """Potential energies by formula of coordinates, parameters and `t` [J]."""
    closures: Annotated[dict[Name, ClosureEntry], Field(max_length=10_000)] | None = None
    """Frames that stay together: they close loops of the tree."""
    nonholonomic: Annotated[dict[Name, NonholonomicEntry], Field(max_length=10_000)] | None = None
    """Conditions on speeds."""
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
