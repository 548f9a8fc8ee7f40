"""The kinds of values that entries of the native file hold, as pydantic types that read them."""

from __future__ import annotations

import inspect
from abc import ABC, abstractmethod
from types import ModuleType
from typing import Annotated, Any, ClassVar, Self, get_args

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, PlainValidator, WithJsonSchema, model_validator
from pydantic_core import PydanticCustomError
from typing_extensions import TypeAliasType

from symofros.description.forces import Anchor
from symofros.description.parser import MAX_LENGTH
from symofros.description.system import WAIVERS
from symofros.description.values import Rotation, RotationKind, Value, as_value
from symofros.errors import DescriptionError, Problem, did_you_mean

ROTATIONS: tuple[RotationKind, ...] = ("rpy", "axis_angle", "quaternion", "matrix")
MOMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


class Entry(BaseModel):
    """A mapping of the file. Strict: no unknown keys, and a text is not taken for a number."""

    # Validators are built when a file is first read, each once: not with every class that contains another.
    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, use_attribute_docstrings=True, defer_build=True)


class PartEntry(Entry, ABC):
    """An entry that is a part of a noun, and knows how to become it."""

    @abstractmethod
    def build(self) -> Any:
        """The part."""


def fault(problem: Problem) -> PydanticCustomError:
    """A problem in the form that pydantic collects."""
    parts = {"what": problem.what, "found": problem.found, "rule": problem.rule, "remedy": problem.remedy}
    return PydanticCustomError("problem", "{what}", parts)


class ShapedEntry(PartEntry):
    """An entry by a shape and the sizes that this shape has: the arguments of a function of the shape's name.

    Attributes:
        noun: What has the shape, for messages.
        makers: Module of the functions.
        common: Entries of every shape.
        given: Arguments of the functions that are no sizes.
    """

    noun: ClassVar[str]
    makers: ClassVar[ModuleType]
    common: ClassVar[tuple[str, ...]]
    given: ClassVar[tuple[str, ...]]
    shape: str

    @classmethod
    def sizes_by_shape(cls) -> dict[str, list[str]]:
        """Shape -> names of its sizes."""
        return {shape: list(cls._parameters(shape)) for shape in get_args(cls.model_fields["shape"].annotation)}

    @classmethod
    def _parameters(cls, shape: str) -> dict[str, inspect.Parameter]:
        parameters = inspect.signature(getattr(cls.makers, shape)).parameters
        return {name: each for name, each in parameters.items() if name not in cls.given}

    @property
    def sizes(self) -> dict[str, Any]:
        """The sizes that are stated."""
        entries = {name: getattr(self, name) for name in type(self).model_fields if name not in self.common}
        return {name: value for name, value in entries.items() if value is not None}

    @model_validator(mode="after")
    def _possible(self) -> Self:
        """Refuse unknown, missing and impossible sizes of a shape."""
        parameters, stated = self._parameters(self.shape), set(self.sizes)
        missing = {name for name, each in parameters.items() if each.default is each.empty} - stated
        superfluous = stated - set(parameters)
        if missing or superfluous:
            listed = ", ".join(sorted(missing or superfluous))
            rule = f"{self.shape} has {', '.join(parameters)}"
            remedy = f"add {listed}" if missing else f"remove {listed}"
            what = f"{self.noun}: not the sizes of shape {self.shape}"
            raise fault(Problem(what, ", ".join(sorted(stated)), rule, remedy))
        try:
            self.build()
        except DescriptionError as error:
            raise fault(error.problem) from None
        return self


def _value(stated: Any) -> Value:
    try:
        return as_value(stated)
    except DescriptionError as error:
        raise fault(error.problems[0]) from None


def _waiver(name: str) -> str:
    if name not in WAIVERS:
        known = ", ".join(WAIVERS)
        raise fault(Problem("unknown waiver", f"'{name}'", f"one of {known}", did_you_mean(name, WAIVERS)))
    return name


def moments_mapping(stated: Any) -> Any:
    """A list of moments as the mapping that it abbreviates."""
    if not isinstance(stated, list):
        return stated
    if len(stated) not in (3, 6):
        rule = "three (Ixx, Iyy, Izz) or six (then Ixy, Ixz, Iyz)"
        raise fault(
            Problem("wrong number of entries", f"{len(stated)} entries", rule, "give three, or all six, zeros included")
        )
    return dict(zip(MOMENTS, stated, strict=False))


def parameter_mapping(stated: Any) -> Any:
    """A bare number as the parameter that it abbreviates."""
    return {"value": stated} if isinstance(stated, (int, float)) and not isinstance(stated, bool) else stated


def listed(stated: Any) -> Any:
    """A single value as a list of one."""
    return stated if isinstance(stated, list) else [stated]


def _reserved(stated: Any) -> None:
    if stated:
        raise fault(
            Problem(
                "this version does not know this section yet",
                f"{str(stated):.60}",
                "the section is reserved for a later version of the format, and is empty until then",
                "remove it",
            )
        )


Number = Annotated[float, Field(allow_inf_nan=False)]
Name = Annotated[str, Field(min_length=1, max_length=200)]
Text = Annotated[str, Field(max_length=10_000)]
Formula = TypeAliasType(
    "Formula",
    Annotated[
        Value,
        PlainValidator(_value),
        WithJsonSchema(
            {
                "description": "A number, or a formula such as 'L1/2 + 0.1*cos(q1)'.",
                "anyOf": [{"type": "number"}, {"type": "string", "minLength": 1, "maxLength": MAX_LENGTH}],
            }
        ),
    ],
)
Two = Annotated[list[Formula], Field(min_length=2, max_length=2)]
Three = Annotated[list[Formula], Field(min_length=3, max_length=3)]
Four = Annotated[list[Formula], Field(min_length=4, max_length=4)]
Six = Annotated[list[Formula], Field(min_length=6, max_length=6)]
Matrix = Annotated[list[Three], Field(min_length=3, max_length=3)]
Waiver = Annotated[str, AfterValidator(_waiver), WithJsonSchema({"type": "string", "enum": [*WAIVERS]})]
Reserved = Annotated[
    None, PlainValidator(_reserved), WithJsonSchema({"description": "Reserved.", "enum": [None, [], {}]})
]


class RotationEntry(PartEntry):
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
            stated_forms = ", ".join(given) or "none of them"
            raise fault(
                Problem("not exactly one form", stated_forms, f"exactly one of {', '.join(ROTATIONS)}", "keep one")
            )
        return self

    def build(self) -> Rotation:
        """The Rotation that is stated."""
        if self.matrix is not None:
            return Rotation.matrix(self.matrix)
        kind, values = next((kind, values) for kind in ROTATIONS if (values := getattr(self, kind)) is not None)
        return Rotation(kind, tuple(values))


class AnchorEntry(PartEntry):
    """A frame of a body."""

    body: Name
    frame: Name | None = None
    """The body frame if not given."""

    def build(self) -> Anchor:
        """The pair that nouns hold."""
        return self.body, self.frame
