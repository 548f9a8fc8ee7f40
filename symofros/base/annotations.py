"""The values that an annotation allows, in words, and what is wrong with another one."""

from __future__ import annotations

import inspect
import math
import numbers
import os
import types
from collections.abc import Callable, Collection, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

import numpy as np

from symofros.errors import ArgumentError, did_you_mean

# Name of a class -> how to get an object of it.
_MAKERS = {
    "System": "sf.load(path) reads one",
    "Model": "sf.compile(system) makes one of a System, sf.compile(sf.load(path)) of a file",
    "ModelRecord": "sf.compile(system) makes a Model",
    "Diagram": "sf.load_diagram(path) reads one",
    "Options": "sf.Options(functions=..., ...)",
    "SimulationOptions": "sf.SimulationOptions(method=..., ...), or its fields by name",
    "Target": "sf.Target(position=..., rotation=...)",
    "Scene": "sf.load_scene(path) reads one",
    "Generator": "numpy.random.default_rng(seed) makes one",
}
# Names of the class that is wanted and of that which is given -> what does for the latter what was asked.
_INSTEAD = {("Model", "Diagram"): "sf.Simulation(diagram).run(t_end=...) runs a diagram, .stepper() steps it by hand"}


@dataclass(frozen=True)
class Kind:
    """The values that an annotation allows.

    Attributes:
        noun: The allowed values as a noun phrase: "a number".
        allows: Whether a value is one of them.
        remedy: What to do about another one, given it.
        fault: Name of the entry that is at fault in a container of the right kind, the entry, and what it should be;
            None where the value as a whole is another.
    """

    noun: str
    allows: Callable[[Any], bool]
    remedy: Callable[[Any], str]
    fault: Callable[[Any], tuple[str, Any, Kind] | None] = lambda _: None


def checker_of(annotation: Any) -> Callable[[str, object], None] | None:
    """A function that raises for values which an annotation does not allow; None if the annotation is not checked.

    The function raises ArgumentError.
    """
    kind = _kind(annotation)
    if kind is None:
        return None

    def check(what: str, value: object) -> None:
        if not kind.allows(value):
            raise refusal(what, value, kind)

    return check


def check_argument(what: str, value: object, annotation: Any) -> None:
    """Refuse a value that an annotation does not allow.

    Raises:
        ArgumentError: It is another.
    """
    check = checker_of(annotation)
    if check is not None:
        check(what, value)


def shown(value: object) -> str:
    """Type and beginning of a value, of which some can't be written: integers of thousands of digits, odd objects."""
    try:
        return f"{type(value).__name__} {value!r:.60}"
    except Exception:  # Whatever its own method raises.
        return f"{type(value).__name__}, which can't be written"


def refusal(what: str, value: object, kind: Kind) -> ArgumentError:
    """The error of a value that is not of a kind; of a container, at the entry that is at fault."""
    entry = kind.fault(value)
    if entry is not None:
        name, part, wanted = entry
        return refusal(f"{what}{name}", part, wanted)
    return ArgumentError(f"{what} is not {kind.noun}", shown(value), f"it is {kind.noun}", kind.remedy(value))


@cache
def kinds_of(annotated: Hashable) -> dict[str, Kind | None]:
    """The values that each parameter of a function or field of a class allows; None where any value is allowed."""
    return {name: _kind(annotation) for name, annotation in get_type_hints(annotated).items()}


def _kind(annotation: Any) -> Kind | None:
    """The values that an annotation allows; None for annotations that are not checked, such as arrays and protocols."""
    if annotation in _SIMPLE:
        return _SIMPLE[annotation]
    origin, parts = get_origin(annotation), get_args(annotation)
    if origin in _GENERIC:
        return _GENERIC[origin](parts)
    if inspect.isclass(annotation) and annotation.__module__.startswith(("symofros.", "numpy.random.")):
        return _object_of(annotation)
    return None


def _object_of(stated: Any) -> Kind:
    """Objects of a class, or with the methods of a protocol."""
    noun = _with_article(stated.__name__)
    remedy = _MAKERS.get(stated.__name__, f"give {noun}")
    if not getattr(stated, "_is_protocol", False):

        def instead(value: Any) -> str:
            return _INSTEAD.get((stated.__name__, type(value).__name__), remedy)

        return Kind(noun, lambda value: isinstance(value, stated), instead)
    methods = [name for name in vars(stated) if not name.startswith("_")]
    remedy = f"it has {', '.join(methods)}"
    return Kind(noun, lambda value: all(hasattr(value, name) for name in methods), lambda _: remedy)


def _class_of(base: type) -> Kind:
    noun = f"a class derived from {base.__name__}"
    return Kind(
        noun, lambda value: isinstance(value, type) and issubclass(value, base), lambda _: "give the class, no object"
    )


def _with_article(name: str) -> str:
    return f"{'an' if name[0] in 'AEIOU' else 'a'} {name}"


def _any_of(parts: Sequence[Any]) -> Kind | None:
    known = [kind for kind in map(_kind, parts) if kind is not None]
    if len(known) < len(parts):
        return None
    listed = [kind for kind in known if kind.noun != "None"]
    noun = " or ".join(dict.fromkeys(kind.noun for kind in listed)) + ("" if len(listed) == len(known) else ", or None")

    def fault(value: Any) -> tuple[str, Any, Kind] | None:
        return next((entry for kind in listed if (entry := kind.fault(value)) is not None), None)

    return Kind(noun, lambda value: any(kind.allows(value) for kind in known), listed[0].remedy, fault)


def _one_of(choices: Sequence[Any]) -> Kind:
    def remedy(value: Any) -> str:
        return did_you_mean(str(value)[:80], map(str, choices)) or "name one of these"

    listed = ", ".join(f"'{choice}'" for choice in choices)
    return Kind(f"one of {listed}", lambda value: isinstance(value, str) and value in choices, remedy)


def _list_of(item: Kind | None, container: Any) -> Kind:
    def is_list(value: Any) -> bool:
        if isinstance(value, str | bytes) or (isinstance(value, Mapping) and container is not Iterable):
            return False
        if isinstance(value, np.ndarray) and not value.ndim:  # It has the methods of a list, which refuse.
            return False
        # An array of texts is a list of names, though not by its class.
        return isinstance(value, container) or (
            container is not tuple and isinstance(value, np.ndarray) and value.ndim == 1
        )

    def fault(value: Any) -> tuple[str, Any, Kind] | None:
        # What can be gone through once only is not looked at.
        if item is None or not is_list(value) or not isinstance(value, Collection):
            return None
        return next(((f"[{i}]", part, item) for i, part in enumerate(value) if not item.allows(part)), None)

    def remedy(value: Any) -> str:
        if isinstance(value, str):
            return f"one alone: ({value[:40]!r},)" if container is tuple else f"one alone: [{value[:40]!r}]"
        return "put them in a tuple" if container is tuple else "put them in a list"

    what = f", each {item.noun}" if item is not None else ""
    noun = ("a tuple" if container is tuple else "a list") + what
    return Kind(noun, lambda value: is_list(value) and fault(value) is None, remedy, fault)


def _lists_of(container: Any) -> Callable[[Sequence[Any]], Kind]:
    return lambda parts: _list_of(_kind(parts[0]), container)


def _tuple_of(parts: Sequence[Any]) -> Kind:
    if parts[-1] is Ellipsis:
        return _list_of(_kind(parts[0]), tuple)
    items = [_kind(part) for part in parts]

    def allows(value: Any) -> bool:
        return (
            isinstance(value, tuple | list)
            and len(value) == len(items)
            and all(item is None or item.allows(part) for item, part in zip(items, value, strict=True))
        )

    noun = " and ".join("anything" if item is None else item.noun for item in items)
    return Kind(f"a tuple of {noun}", allows, lambda _: f"put {len(items)} in a tuple")


def _mapping_of(key: Kind | None, value: Kind | None) -> Kind:
    def fault(given: Any) -> tuple[str, Any, Kind] | None:
        for name, part in given.items() if isinstance(given, Mapping) else ():
            if key is not None and not key.allows(name):
                return ": a name", name, key
            if value is not None and not value.allows(part):
                return f": {name!r:.60}", part, value
        return None

    def allows(given: Any) -> bool:
        return isinstance(given, Mapping) and fault(given) is None

    parts = [f"{kind.noun} for {what}" for what, kind in (("the name", key), ("the value", value)) if kind is not None]
    noun = "a mapping" + (", with " + " and ".join(parts) if parts else "")
    return Kind(noun, allows, lambda _: "for example {'name': value}", fault)


def is_number(value: object) -> bool:
    """Whether a value is one real number that float64 holds; infinity is, NaN is not."""
    if type(value) is float:  # As nearly always: without the registry of numbers.
        return value == value
    if isinstance(value, np.ndarray):
        return value.ndim == 0 and value.dtype.kind in "fiub" and not bool(np.isnan(value))
    if not isinstance(value, numbers.Real):
        return False
    try:
        return not math.isnan(float(value))
    except OverflowError:
        return False


def _is_whole(value: object) -> bool:
    return isinstance(value, numbers.Integral)


def _number_of(value: object) -> str:
    """The remedy for text that reads as a number: the number to write instead."""
    try:
        return f"write {float(value):g}, without quotes" if isinstance(value, str) else "give one number"
    except ValueError:
        return "give one number"


_PATH = Kind("a path", lambda value: isinstance(value, os.PathLike), lambda _: "give the path of a file")
_SIMPLE: dict[Any, Kind] = {
    float: Kind("a number", is_number, _number_of),
    int: Kind("a whole number", _is_whole, lambda value: "give a whole number, such as 10"),
    bool: Kind("True or False", lambda value: isinstance(value, bool | np.bool_ | int), lambda _: "give True or False"),
    str: Kind("a text", lambda value: isinstance(value, str), lambda _: "give a text, in quotes"),
    type(None): Kind("None", lambda value: value is None, lambda _: "leave it out"),
    Path: _PATH,
}
# Annotations with parts, by their origin.
_GENERIC: dict[Any, Callable[[Sequence[Any]], Kind | None]] = {
    Union: _any_of,
    types.UnionType: _any_of,
    Literal: _one_of,
    type: lambda parts: _class_of(parts[0]),
    tuple: _tuple_of,
    **{origin: _lists_of(origin) for origin in (Collection, Sequence, Iterable)},
    Mapping: lambda parts: _mapping_of(*map(_kind, parts)),
    Callable: lambda _: Kind("a function", callable, lambda _: "give a function, without calling it"),
    os.PathLike: lambda _: _PATH,
}
