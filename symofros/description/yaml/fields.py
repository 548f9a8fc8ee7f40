"""The kinds of values that entries of the native file hold, as pydantic types that read them."""

from __future__ import annotations

import inspect
from abc import ABC, abstractmethod
from collections.abc import Callable, Collection
from typing import Annotated, Any, Self

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


def sizes_of(make: Callable[..., Any], common: Collection[str]) -> list[str]:
    """Names of a shape's sizes: arguments of the function that makes it, without those that are none."""
    return [name for name in inspect.signature(make).parameters if name not in common]


def check_sizes(noun: str, make: Callable[..., Any], stated: Collection[str], common: Collection[str]) -> None:
    """Refuse sizes that a shape does not have, and a shape without those that it needs.

    Args:
        noun: What has the shape.
        make: Function that is named as the shape and takes its sizes.
        stated: Names of the sizes that are stated.
        common: Arguments that are no sizes.
    """
    parameters, sizes = inspect.signature(make).parameters, sizes_of(make, common)
    missing = [name for name in sizes if parameters[name].default is inspect.Parameter.empty and name not in stated]
    superfluous = sorted(set(stated).difference(sizes))
    if missing or superfluous:
        rule = f"{make.__name__} has {', '.join(sizes)}"
        remedy = f"add {', '.join(sorted(missing))}" if missing else f"remove {', '.join(superfluous)}"
        what = f"{noun}: not the sizes of shape {make.__name__}"
        raise fault(Problem(what, ", ".join(sorted(stated)), rule, remedy))


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
        """The Rotation."""
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
