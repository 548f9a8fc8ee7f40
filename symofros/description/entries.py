"""Entries of description classes: one that does not exist is refused in words."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from functools import wraps
from typing import Any, TypeVar

from symofros.errors import DescriptionError, Problem, did_you_mean

_Class = TypeVar("_Class", bound=type)
# What other programs state of a beam, and this theory has not.
_ABSENT: Mapping[str, str] = {
    "EA": "beams do not stretch: leave it out, or put a prismatic joint with a spring at the end",
    "GA": "sections do not shear: leave it out",
    "kGA": "sections do not shear: leave it out",
}


def refuses_unknown_entries(cls: _Class) -> _Class:
    """A class decorator, above @dataclass: a keyword that is no field raises DescriptionError with the nearest one."""
    initialise: Any = vars(cls)["__init__"]
    known = tuple(field.name for field in fields(cls) if field.init)

    @wraps(initialise)
    def checked(self: Any, *args: Any, **entries: Any) -> None:
        unknown = [entry for entry in entries if entry not in known]
        if unknown:
            name = entries.get("name", args[0] if args else None)
            what = cls.__name__ + (f" '{name}'" if isinstance(name, str) else "")
            raise DescriptionError(
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
        initialise(self, *args, **entries)

    type.__setattr__(cls, "__init__", checked)
    return cls
