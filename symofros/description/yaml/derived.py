"""Entries of the native file that are derived from the dataclasses they describe: fields, defaults, descriptions.

`class SpringEntry(NounEntry, noun=Spring)` has one entry a field of Spring, in its order: the kind of value from the
field's type, the default from the dataclass, the description from its docstring. What the file states otherwise than
Python does is written in the body of the class, and takes the place of the field. `without` names fields that the file
gives elsewhere, as the key of a mapping for instance.
"""

from __future__ import annotations

import inspect
from dataclasses import MISSING, fields
from types import NoneType, UnionType
from typing import Any, ClassVar, Literal, Self, Union, get_args, get_origin, get_type_hints

from pydantic import ConfigDict, Field, model_validator

from symofros.description.entries import descriptions
from symofros.description.values import IDENTITY, Rotation, Value
from symofros.description.yaml.fields import (
    AnchorEntry,
    Formula,
    Name,
    Number,
    PartEntry,
    RotationEntry,
    Text,
    Three,
    Two,
    fault,
)
from symofros.errors import SymofrosError

_TEXTS = ("unit", "description")
_VECTOR = (Value, Value, Value)
_POINT = (Value, Value)
_ANCHOR = (str, str | None)


def _entry_type(name: str, kind: Any) -> Any:
    """Annotation of the file's entry for a field of a noun, from the field's name and type."""
    arguments = get_args(kind)
    if kind == Value:
        return Formula
    if get_origin(kind) in (Union, UnionType) and NoneType in arguments:
        (inner,) = [Value] if set(arguments) - {NoneType} == set(get_args(Value)) else set(arguments) - {NoneType}
        return _entry_type(name, inner) | None
    if arguments == _VECTOR:
        return Three
    if arguments == _POINT:
        return Two
    if arguments == _ANCHOR:
        return AnchorEntry
    if kind is Rotation:
        return RotationEntry | None
    if kind is float:
        return Number
    if kind is str:
        return Text if name in _TEXTS else Name
    if kind is bool or get_origin(kind) is Literal:
        return kind
    raise TypeError(f"entry '{name}': state it in the entry's class, {kind} has no form in the file")


def _default(value: Any) -> Any:
    """A default of a dataclass as the file's data."""
    if value is MISSING:
        return ...
    if value is IDENTITY:
        return None
    return list(value) if isinstance(value, tuple) else value


class NounEntry(PartEntry):
    """An entry that becomes a dataclass of the description."""

    # Descriptions come from the dataclass: pydantic need not read this file's text for them.
    model_config = ConfigDict(use_attribute_docstrings=False)

    noun: ClassVar[Any]
    checked: ClassVar[bool] = False

    def __init_subclass__(
        cls, noun: type | None = None, without: tuple[str, ...] = (), checked: bool = False, **options: Any
    ) -> None:
        """Add the entries of a noun's fields, before pydantic reads the class; `checked`: report faults here."""
        super().__init_subclass__(**options)
        if noun is None:
            return
        stated = dict(cls.__dict__.get("__annotations__", {}))
        hints, lines = get_type_hints(noun), descriptions(noun)
        annotations: dict[str, Any] = {}
        for item in fields(noun):
            if item.name in without:
                continue
            own = item.name in stated
            annotations[item.name] = stated.pop(item.name) if own else _entry_type(item.name, hints[item.name])
            default = ... if own else _default(item.default)
            setattr(cls, item.name, Field(cls.__dict__.get(item.name, default), description=lines.get(item.name)))
        cls.__annotations__ = annotations | stated
        cls.noun, cls.checked = noun, checked
        if cls.__doc__ is None:
            cls.__doc__ = inspect.cleandoc(noun.__doc__ or "").partition("\n")[0]

    @model_validator(mode="after")
    def _possible(self) -> Self:
        if self.checked:
            try:
                self.build()
            except SymofrosError as error:
                raise fault(error.problem) from None
        return self

    def stated(self) -> dict[str, Any]:
        """The noun's fields as they are stated here."""
        return {name: _value(getattr(self, name)) for name in type(self).model_fields}

    def build(self, **given: Any) -> Any:
        """Make the noun of the entries that are stated here, and of fields that are given elsewhere in the file.

        Raises:
            DescriptionError: The noun refuses them.
        """
        values = self.stated() | given
        return self.noun(**{key: value for key, value in values.items() if value is not None})


def _value(stated: Any) -> Any:
    """A value of the file as a field of a noun."""
    if isinstance(stated, PartEntry):
        return stated.build()
    if isinstance(stated, dict):
        return {key: _value(item) for key, item in stated.items()}
    return tuple(map(_value, stated)) if isinstance(stated, list) else stated
