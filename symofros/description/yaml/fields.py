"""The kinds of values that entries of the native file hold, as pydantic types that read them."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Annotated, Any, Self

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, PlainValidator, WithJsonSchema, model_validator
from pydantic_core import PydanticCustomError
from typing_extensions import TypeAliasType

from symofros.description.parser import MAX_LENGTH
from symofros.description.system import WAIVERS
from symofros.description.values import Value, Vector, as_value
from symofros.errors import DescriptionError, Problem, did_you_mean

MOMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


class Entry(BaseModel):
    """A mapping of the file. Strict: no unknown keys, and a text is not taken for a number."""

    model_config = ConfigDict(extra="forbid", strict=True, frozen=True, use_attribute_docstrings=True)


class CheckedEntry(Entry, ABC):
    """One whose noun checks itself when it is made."""

    @model_validator(mode="after")
    def _possible(self) -> Self:
        try:
            self.build()
        except DescriptionError as error:
            raise fault(error.problems[0]) from None
        return self

    @abstractmethod
    def build(self) -> object:
        """The noun."""


def three(values: list[Value]) -> Vector:
    """A list of three as a vector."""
    x, y, z = values
    return x, y, z


def fault(problem: Problem) -> PydanticCustomError:
    """A problem in the form that pydantic collects."""
    parts = {"what": problem.what, "found": problem.found, "rule": problem.rule, "remedy": problem.remedy}
    return PydanticCustomError("problem", "{what}", parts)


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
