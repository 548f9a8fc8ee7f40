"""Arguments of public functions, held against the types that their signatures state.

A wrong one is refused with a message where it enters, and not by an error from deep inside. Arrays are left to
`base/arrays.py`, which converts them.
"""

from __future__ import annotations

import inspect
import math
import numbers
import os
import types
from abc import ABCMeta
from collections.abc import Callable, Collection, Hashable, Iterable, Mapping, Sequence, Set
from dataclasses import dataclass, fields
from functools import cache, wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, ParamSpec, TypeVar, Union, get_args, get_origin, get_type_hints

import numpy as np

from symofros.errors import ArgumentError, Problem, did_you_mean

_Parameters = ParamSpec("_Parameters")
_Result = TypeVar("_Result")

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
class _Kind:
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
    fault: Callable[[Any], tuple[str, Any, _Kind] | None] = lambda _: None


def checked(function: Callable[_Parameters, _Result]) -> Callable[_Parameters, _Result]:
    """Refuse calls of a public function that its signature does not allow.

    Raises:
        ArgumentError: In each such call.
    """
    signature, title = inspect.signature(function), function.__qualname__.removesuffix(".__init__")
    rest = {p.name for p in signature.parameters.values() if p.kind in (p.VAR_POSITIONAL, p.VAR_KEYWORD)}
    by_name = _Names(signature)

    @wraps(function)
    def call(*args: _Parameters.args, **kwargs: _Parameters.kwargs) -> _Result:
        kinds = _kinds(function)
        given = by_name.given(args, kwargs)
        if given is None or not all(
            kind is None or kind.allows(given[name]) for name, kind in kinds.items() if name in given
        ):
            for name, value in bound(title, signature, args, kwargs).items():
                kind = None if name in rest else kinds.get(name)
                if kind is not None and not kind.allows(value):
                    raise _refusal(f"{title}: {name}", value, kind)
        return function(*args, **kwargs)

    return call


class _Names:
    """Arguments by name where a call is plain: a tenth of the time of `inspect.Signature.bind`.

    Args:
        signature: Signature of the function.
    """

    def __init__(self, signature: inspect.Signature) -> None:
        parameters = signature.parameters.values()
        self._plain = all(p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY) for p in parameters)
        self._positional = tuple(p.name for p in parameters if p.kind == p.POSITIONAL_OR_KEYWORD)
        self._names = frozenset(signature.parameters)
        self._required = frozenset(p.name for p in parameters if p.default is p.empty)

    def given(self, args: tuple[Any, ...], kwargs: dict[str, Any]) -> dict[str, Any] | None:
        """The arguments by name; None where the call does not fit, or the signature takes any number of them."""
        if not self._plain or len(args) > len(self._positional):
            return None
        given = dict(zip(self._positional, args, strict=False))
        if not given.keys().isdisjoint(kwargs) or not self._names.issuperset(kwargs):
            return None
        given.update(kwargs)
        return given if self._required.issubset(given) else None


def check_fields(stated: Any) -> None:
    """Refuse fields of a dataclass whose values its annotations do not allow.

    Raises:
        ArgumentError: For the first such field.
    """
    kinds = _kinds(stated.__class__)
    for item in fields(stated):
        kind, value = kinds.get(item.name), getattr(stated, item.name)
        if kind is not None and not kind.allows(value):
            raise _refusal(f"{type(stated).__name__}: {item.name}", value, kind)


class CheckedCalls(ABCMeta):
    """Metaclass of public classes: a call by keywords that does not fit is refused with a message.

    Only calls that fail are looked at. What the fields of a frozen dataclass state is its own, whatever becomes of the
    arrays, lists and tables that stated it, unless the class says that it `shares` them.
    """

    if not TYPE_CHECKING:  # Type checkers know the signature from __init__.

        def __call__(cls, *args: Any, **kwargs: Any) -> Any:
            """Make an object.

            Raises:
                ArgumentError: Arguments are missing, unknown, or too many.
            """
            try:
                made = super().__call__(*args, **kwargs)
            except TypeError:
                bound(cls.__name__, cls.__signature__, args, kwargs)
                raise
            parameters = getattr(cls, "__dataclass_params__", None)
            if parameters is not None and parameters.frozen and not getattr(cls, "shares", False):
                _own_fields(made)
            return made

        @property
        def __signature__(cls) -> inspect.Signature:
            """Signature of __init__; `inspect` would take that of the metaclass's __call__."""
            initialise = inspect.signature(cls.__init__)
            return initialise.replace(parameters=[*initialise.parameters.values()][1:])


def _own_fields(made: Any) -> None:
    """Make the fields of a frozen dataclass its own."""
    for item in fields(made):
        value = getattr(made, item.name)
        own = _own(value)
        if own is not value:
            object.__setattr__(made, item.name, own)


def _own(value: Any) -> Any:
    """A copy of arrays, lists and tables, and of those in them; anything else as it is."""
    if type(value) is np.ndarray:
        return value.copy()
    if type(value) is list:
        return [_own(item) for item in value]
    return {key: _own(item) for key, item in value.items()} if type(value) is dict else value


def bound(
    title: str, signature: inspect.Signature, args: Sequence[Any], kwargs: Mapping[str, Any]
) -> Mapping[str, Any]:
    """The arguments of a call by name.

    Raises:
        ArgumentError: Arguments are missing, unknown, or too many.
    """
    try:
        return signature.bind(*args, **kwargs).arguments
    except TypeError as error:
        raise _misfit(title, signature, str(error), kwargs) from None


def checker_of(annotation: Any) -> Callable[[str, object], None] | None:
    """A function that raises for values which an annotation does not allow; None if the annotation is not checked.

    The function raises ArgumentError.
    """
    kind = _kind(annotation)
    if kind is None:
        return None

    def check(what: str, value: object) -> None:
        if not kind.allows(value):
            raise _refusal(what, value, kind)

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


def entries_of(value: Any) -> list[Any] | None:
    """The entries of an iterable as a list; None for text, mappings, sets and what can't be iterated."""
    if isinstance(value, str | bytes | Mapping | Set) or not isinstance(value, Iterable):
        return None
    try:
        return list(value)
    except TypeError:  # An array without dimensions.
        return None


def _refusal(what: str, value: object, kind: _Kind) -> ArgumentError:
    entry = kind.fault(value)
    if entry is not None:
        name, part, wanted = entry
        return _refusal(f"{what}{name}", part, wanted)
    return ArgumentError(Problem(f"{what} is not {kind.noun}", shown(value), f"it is {kind.noun}", kind.remedy(value)))


def _misfit(name: str, signature: inspect.Signature, fault: str, given: Mapping[str, object]) -> ArgumentError:
    """A call with arguments that are missing, unknown, or too many."""
    known = list(signature.parameters)
    unknown = [argument for argument in given if argument not in known]
    remedy = did_you_mean(unknown[0], known) if unknown else "give what it takes, by name"
    fault = f"got an unexpected keyword argument '{unknown[0]}'" if unknown else fault
    return ArgumentError(Problem(f"{name}: the arguments do not fit", fault, f"it takes {', '.join(known)}", remedy))


@cache
def _kinds(annotated: Hashable) -> dict[str, _Kind | None]:
    """The values that each parameter of a function or field of a class allows; None where any value is allowed."""
    return {name: _kind(annotation) for name, annotation in get_type_hints(annotated).items()}


def _kind(annotation: Any) -> _Kind | None:
    """The values that an annotation allows; None for annotations that are not checked, such as arrays and protocols."""
    origin, parts = get_origin(annotation), get_args(annotation)
    if annotation in _SIMPLE:
        return _SIMPLE[annotation]
    if annotation is None or annotation is type(None):
        return _Kind("None", lambda value: value is None, lambda _: "leave it out")
    if origin in (Union, types.UnionType):
        return _any_of([_kind(part) for part in parts])
    if origin is Literal:
        return _one_of(parts)
    if origin is type:
        return _class_of(parts[0])
    if origin is tuple and parts[-1] is not Ellipsis:
        return _tuple_of([_kind(part) for part in parts])
    if origin is tuple:
        return _list_of(_kind(parts[0]), tuple)
    if origin in (Collection, Sequence, Iterable):
        return _list_of(_kind(parts[0]), origin)
    if origin is Mapping:
        return _mapping_of(*map(_kind, parts))
    if origin is Callable:
        return _Kind("a function", callable, lambda _: "give a function, without calling it")
    if origin is os.PathLike or annotation is Path:
        return _Kind("a path", lambda value: isinstance(value, os.PathLike), lambda _: "give the path of a file")
    if inspect.isclass(annotation) and annotation.__module__.startswith(("symofros.", "numpy.random.")):
        return _object_of(annotation)
    return None


def _object_of(stated: Any) -> _Kind:
    """Objects of a class, or with the methods of a protocol."""
    noun = _with_article(stated.__name__)
    remedy = _MAKERS.get(stated.__name__, f"give {noun}")
    if not getattr(stated, "_is_protocol", False):

        def instead(value: Any) -> str:
            return _INSTEAD.get((stated.__name__, type(value).__name__), remedy)

        return _Kind(noun, lambda value: isinstance(value, stated), instead)
    methods = [name for name in vars(stated) if not name.startswith("_")]
    remedy = f"it has {', '.join(methods)}"
    return _Kind(noun, lambda value: all(hasattr(value, name) for name in methods), lambda _: remedy)


def _class_of(base: type) -> _Kind:
    noun = f"a class derived from {base.__name__}"
    return _Kind(
        noun, lambda value: isinstance(value, type) and issubclass(value, base), lambda _: "give the class, no object"
    )


def _with_article(name: str) -> str:
    return f"{'an' if name[0] in 'AEIOU' else 'a'} {name}"


def _any_of(kinds: Sequence[_Kind | None]) -> _Kind | None:
    known = [kind for kind in kinds if kind is not None]
    if len(known) < len(kinds):
        return None
    listed = [kind for kind in known if kind.noun != "None"]
    noun = " or ".join(dict.fromkeys(kind.noun for kind in listed)) + ("" if len(listed) == len(known) else ", or None")

    def fault(value: Any) -> tuple[str, Any, _Kind] | None:
        return next((entry for kind in listed if (entry := kind.fault(value)) is not None), None)

    return _Kind(noun, lambda value: any(kind.allows(value) for kind in known), listed[0].remedy, fault)


def _one_of(choices: Sequence[Any]) -> _Kind:
    def remedy(value: Any) -> str:
        return did_you_mean(str(value)[:80], map(str, choices)) or "name one of these"

    listed = ", ".join(f"'{choice}'" for choice in choices)
    return _Kind(f"one of {listed}", lambda value: isinstance(value, str) and value in choices, remedy)


def _list_of(item: _Kind | None, container: Any) -> _Kind:
    def is_list(value: Any) -> bool:
        if isinstance(value, str | bytes) or (isinstance(value, Mapping) and container is not Iterable):
            return False
        if isinstance(value, np.ndarray) and not value.ndim:  # It has the methods of a list, which refuse.
            return False
        # An array of texts is a list of names, though not by its class.
        return isinstance(value, container) or (
            container is not tuple and isinstance(value, np.ndarray) and value.ndim == 1
        )

    def fault(value: Any) -> tuple[str, Any, _Kind] | None:
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
    return _Kind(noun, lambda value: is_list(value) and fault(value) is None, remedy, fault)


def _tuple_of(items: Sequence[_Kind | None]) -> _Kind:
    def allows(value: Any) -> bool:
        return (
            isinstance(value, tuple | list)
            and len(value) == len(items)
            and all(item is None or item.allows(part) for item, part in zip(items, value, strict=True))
        )

    noun = " and ".join("anything" if item is None else item.noun for item in items)
    return _Kind(f"a tuple of {noun}", allows, lambda _: f"put {len(items)} in a tuple")


def _mapping_of(key: _Kind | None, value: _Kind | None) -> _Kind:
    def fault(given: Any) -> tuple[str, Any, _Kind] | None:
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
    return _Kind(noun, allows, lambda _: "for example {'name': value}", fault)


def is_number(value: object) -> bool:
    """Whether a value is one real number that float64 holds; infinity is, NaN is not."""
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


_SIMPLE: dict[Any, _Kind] = {
    float: _Kind("a number", is_number, _number_of),
    int: _Kind("a whole number", _is_whole, lambda value: "give a whole number, such as 10"),
    bool: _Kind(
        "True or False", lambda value: isinstance(value, bool | np.bool_ | int), lambda _: "give True or False"
    ),
    str: _Kind("a text", lambda value: isinstance(value, str), lambda _: "give a text, in quotes"),
}
