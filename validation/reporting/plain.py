"""Dataclasses <-> JSON: what a report keeps of them, and the same records read back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Annotated, Any, TypeVar

import numpy as np
from pydantic import BeforeValidator, TypeAdapter

from ..mechanics.geometry import Array
from .numbers import finite, rounded

T = TypeVar("T")
# A number that may be NaN, which JSON writes as null.
Number = Annotated[float, BeforeValidator(lambda x: np.nan if x is None else x)]


def plain(value: Any) -> Any:
    """A record for JSON: dataclasses as mappings, arrays as rounded lists, what is not finite as None."""
    if is_dataclass(value) and not isinstance(value, type):
        return {item.name: plain(getattr(value, item.name)) for item in fields(value)}
    if isinstance(value, np.ndarray):
        return rounded(value)
    if isinstance(value, float):
        return finite(float(value))
    if isinstance(value, Mapping):
        return {name: plain(item) for name, item in value.items()}
    return [plain(item) for item in value] if isinstance(value, list | tuple) else value


def restored(kind: type[T], data: Any) -> T:
    """The record of a dataclass that `plain` wrote; entries that are no field of it are left out.

    Raises:
        ValueError: The data is of another layout.
    """
    return TypeAdapter(kind).validate_python(data)


def as_array(values: Any) -> Array:
    """A list from JSON as an array, None as NaN."""
    return np.array(values, dtype=float)
