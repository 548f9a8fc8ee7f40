"""Entries of description classes: what they are; an unknown one is refused with a suggestion."""

from __future__ import annotations

import inspect
import re
from collections.abc import Mapping
from dataclasses import fields
from functools import cache, wraps
from typing import Any, TypeVar

from symofros.base.arguments import bound
from symofros.errors import ArgumentError, DescriptionError, Problem, did_you_mean

_Class = TypeVar("_Class", bound=type)
_ATTRIBUTE = re.compile(r"^    (\w+): (.*(?:\n {8}.*)*)", re.MULTILINE)
# What is stated elsewhere, or by other programs under other names.
_ABSENT: Mapping[str, str] = {
    "GA": "state GA_y and GA_z, with the correction of shear, of a rod with shear_y and shear_z; else leave it out",
    "kGA": "state it as GA_y and GA_z, of a rod with shear_y and shear_z; else leave it out",
    "mass": "an Inertia has it: inertia=sf.Inertia(mass=...)",
}


@cache
def descriptions(noun: type) -> dict[str, str]:
    """Entry -> its line in the docstring of a dataclass."""
    text = inspect.cleandoc(noun.__doc__ or "").partition("Attributes:\n")[2]
    return {name: " ".join(line.split()) for name, line in _ATTRIBUTE.findall(text)}


class UnknownEntryError(DescriptionError, ArgumentError):
    """A keyword that the class does not have: a wrong description, and a wrong call."""


def refuses_unknown_entries(cls: _Class) -> _Class:
    """A class decorator, above @dataclass: a keyword that is no field raises UnknownEntryError with the nearest one.

    Calls that lack an entry, or have too many, raise ArgumentError.
    """
    initialise: Any = vars(cls)["__init__"]
    known = tuple(field.name for field in fields(cls) if field.init)

    @wraps(initialise)
    def checked(self: Any, *args: Any, **entries: Any) -> None:
        unknown = [entry for entry in entries if entry not in known]
        if unknown:
            name = entries.get("name", args[0] if args else None)
            what = cls.__name__ + (f" '{name}'" if isinstance(name, str) else "")
            raise UnknownEntryError(
                [
                    Problem(
                        f"{what}: no entry '{entry}'",
                        f"{entry} = {entries[entry]!r:.60}",
                        f"its entries are {', '.join(known)}",
                        _ABSENT.get(entry) or did_you_mean(entry, known),
                    )
                    for entry in unknown
                ]
            )
        try:
            initialise(self, *args, **entries)
        except TypeError:
            bound(cls.__name__, inspect.signature(cls), args, entries)
            raise

    type.__setattr__(cls, "__init__", checked)
    return cls
