"""Entries of description classes: what they are; unknown ones, and values of other types, are refused."""

from __future__ import annotations

import inspect
import numbers
import re
from collections.abc import Callable, Collection, Mapping, Set
from dataclasses import fields
from functools import cache, partial, wraps
from typing import Any, Literal, TypeVar, get_args, get_origin, get_type_hints

from symofros.base.annotations import checker_of, shown
from symofros.base.arguments import bound, entries_of
from symofros.description.values import Rotation, as_rotation
from symofros.errors import ArgumentError, DescriptionError, Problem, did_you_mean
from symofros.expr.expression import Expression

_Class = TypeVar("_Class", bound=type)
# Numbers of which their classes say in words of their own which are meant.
_CHECKED_BY_CLASS = frozenset(
    {"at", "segments", "sections", "bend_y", "bend_z", "twist", "stretch", "shear_y", "shear_z"}
)
_ANCHOR = tuple[str, str | None]
_ATTRIBUTE = re.compile(r"^    (\w+): (.*(?:\n {8}.*)*)", re.MULTILINE)
# What is stated elsewhere, or by other programs under other names.
_CONSTRAINTS, _LIMITS = "constraints=(...) has all of them", "limits=sf.Limits(lower, upper)"
_ABSENT: Mapping[str, str] = {
    "GA": "state GA_y and GA_z, with the correction of shear, of a rod with shear_y and shear_z; else leave it out",
    "kGA": "state it as GA_y and GA_z, of a rod with shear_y and shear_z; else leave it out",
    "closures": _CONSTRAINTS,
    "contacts": "connections=(...) has contacts, too",
    "couplings": _CONSTRAINTS,
    "damping": "an element has it: elements=(sf.Damper(...),)",
    "friction": "an element has it: elements=(sf.Friction(...),)",
    "lower": _LIMITS,
    "mass": "an Inertia has it: inertia=sf.Inertia(mass=...)",
    "nonholonomic": _CONSTRAINTS,
    "stiffness": "an element has it: elements=(sf.Spring(...),)",
    "upper": _LIMITS,
}


@cache
def descriptions(noun: type) -> dict[str, str]:
    """Entry -> its line in the docstring of a dataclass."""
    text = inspect.cleandoc(noun.__doc__ or "").partition("Attributes:\n")[2]
    return {name: " ".join(line.split()) for name, line in _ATTRIBUTE.findall(text)}


def shown_entries(noun: Any, without: Collection[str]) -> str:
    """The text of a dataclass with each field that counts but some."""
    names = [item.name for item in fields(noun) if item.repr and item.name not in without]
    return f"{type(noun).__name__}({', '.join(f'{name}={getattr(noun, name)!r}' for name in names)})"


class UnknownEntryError(DescriptionError, ArgumentError):
    """A keyword that the class does not have: a wrong description, and a wrong call."""


class EntryTypeError(DescriptionError, ArgumentError):
    """A value of another type than the entry has: a wrong description, and a wrong call."""


_Convert = Callable[[str, Any], Any]


def _convert(check: Callable[[str, object], None], what: str, value: Any) -> Any:
    """The value as it is, if it is allowed."""
    check(what, value)
    # A number of NumPy as Python's own: an array without dimensions can't be hashed.
    return value.item() if type(value).__module__ == "numpy" else value


def _collect(check: Callable[[str, object], None] | None, what: str, values: Any) -> tuple[Any, ...]:
    """The entries of a list as a tuple."""
    # A set of names, such as checks that are waived, has no order to lose.
    names = isinstance(values, Set) and all(isinstance(value, str) for value in values)
    listed = sorted(values) if names else entries_of(values)
    if listed is None:
        raise ArgumentError(f"{what} is not a list", shown(values), "it is a list", "put it in brackets")
    if check is not None:
        for i, value in enumerate(listed):
            check(f"{what}[{i}]", value)
    return tuple(listed)


def _anchor(what: str, value: Any) -> tuple[str, str | None]:
    """The end of a connection: a body and a frame of it."""
    if isinstance(value, tuple | list) and len(value) == 2:
        body, frame = value
        if isinstance(body, str) and (frame is None or isinstance(frame, str)):
            return body, frame
    rule = "it is (body, frame): the names, with None for the body's own frame"
    example = "for example ('arm', 'tip') or ('world', None)"
    raise ArgumentError(f"{what} is no frame of a body", shown(value), rule, example)


def _mapping(what: str, value: Any) -> Any:
    """A mapping, whose entries are not looked at: these are the importers' own."""
    if not isinstance(value, Mapping):
        raise ArgumentError(f"{what} is not a mapping", shown(value), "it is a mapping", "leave it out")
    return value


def _conversion(entry: str, annotation: Any) -> _Convert | None:
    """Function that converts or refuses an entry's value; None if the class does so, or any value is valid."""
    origin, parts = get_origin(annotation), get_args(annotation)
    if annotation is Rotation:
        return as_rotation
    if _holds_values(annotation):
        return None
    if annotation == _ANCHOR:
        return _anchor
    if origin is tuple and parts[-1] is Ellipsis:
        return partial(_collect, _check_load if entry == "loads" else _check_of(parts[0]))
    if origin is Mapping:
        return _mapping
    check = _check_scalar if entry in _CHECKED_BY_CLASS else _check_of(annotation)
    return None if check is None else partial(_convert, check)


def _check_of(annotation: Any) -> Callable[[str, object], None] | None:
    """Function that refuses values outside an annotation; of a Literal, only those that are no text."""
    return checker_of(str if get_origin(annotation) is Literal else annotation)


def _check_scalar(what: str, value: object) -> None:
    if value is not None and not isinstance(value, numbers.Number | str):
        raise ArgumentError(f"{what} is not a number", shown(value), "it is a number", "give one number")


def _check_load(what: str, value: object) -> None:
    """Which loads a kind of body bears is judged where all of the description is known."""
    if type(value).__name__ not in ("Load", "BeamLoad"):
        raise ArgumentError(f"{what} is no load", shown(value), "it is a Load or BeamLoad", "give a Load")


def _holds_values(annotation: Any) -> bool:
    return annotation is Expression or any(map(_holds_values, get_args(annotation)))


@cache
def _conversions(cls: type) -> dict[str, _Convert]:
    """Entry -> function that converts or refuses its value, for the entries that have one."""
    hints = get_type_hints(cls)
    stated = ((field.name, _conversion(field.name, hints[field.name])) for field in fields(cls) if field.init)
    return {name: convert for name, convert in stated if convert is not None}


def _converted(cls: type, what: str, entries: Mapping[str, Any]) -> dict[str, Any]:
    """The entries of a call, each as its class has it.

    Raises:
        EntryTypeError: One is of another type.
    """
    conversions = _conversions(cls)
    try:
        return {
            name: conversions[name](f"{what}: {name}", value) if name in conversions else value
            for name, value in entries.items()
        }
    except DescriptionError:
        raise
    except ArgumentError as error:
        raise EntryTypeError(error.problems) from None


def pairs_of(given: Any, what: str) -> list[tuple[str, Any]]:
    """Pairs of names and values, of a mapping or a list of them.

    Raises:
        EntryTypeError: They are none.
    """
    listed = list(given.items()) if isinstance(given, Mapping) else entries_of(given)
    if listed is not None:
        if all(isinstance(pair, tuple | list) and len(pair) == 2 and isinstance(pair[0], str) for pair in listed):
            return [(name, value) for name, value in listed]
    rule = "names with a value each"
    raise EntryTypeError(f"{what}: no names with values", shown(given), rule, "for example {'dq1': 'r'}")


def refuses_unknown_entries(cls: _Class) -> _Class:
    """A class decorator, above @dataclass: a keyword that is no field raises UnknownEntryError with the nearest one.

    Calls that lack an entry, or have too many, raise ArgumentError.
    """
    initialise: Any = vars(cls)["__init__"]
    known = tuple(field.name for field in fields(cls) if field.init)

    @wraps(initialise)
    def checked(self: Any, *args: Any, **entries: Any) -> None:
        unknown = [entry for entry in entries if entry not in known]
        name = entries.get("name", args[0] if args else None)
        what = cls.__name__ + (f" '{name}'" if isinstance(name, str) and known[0] == "name" else "")
        if unknown:
            raise UnknownEntryError(
                [
                    Problem(
                        f"{what}: no entry '{entry}'",
                        f"{entry} = {shown(entries[entry])}",
                        f"its entries are {', '.join(known)}",
                        _ABSENT.get(entry) or did_you_mean(entry, known),
                    )
                    for entry in unknown
                ]
            )
        if len(args) > len(known) or entries.keys() & set(known[: len(args)]):
            bound(cls.__name__, inspect.signature(cls), args, entries)
        stated = dict(zip(known, args, strict=False)) | entries
        try:
            initialise(self, **_converted(cls, what, stated))
        except TypeError:
            bound(cls.__name__, inspect.signature(cls), args, entries)
            raise

    type.__setattr__(cls, "__init__", checked)
    return cls
