"""Arguments of public functions, held against the types that their signatures state.

A wrong one is refused with a message where it enters, and not by an error from deep inside. Arrays are left to
`base/arrays.py`, which converts them.
"""

from __future__ import annotations

import inspect
from abc import ABCMeta
from collections.abc import Callable, Iterable, Mapping, Sequence, Set
from dataclasses import fields
from functools import cache, wraps
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

import numpy as np

from symofros.base.annotations import check_argument as check_argument
from symofros.base.annotations import kinds_of, refusal
from symofros.base.annotations import shown as shown
from symofros.errors import ArgumentError, did_you_mean

# Kinds of parameters that collect arguments.
_ONE_BY_ONE, _BY_NAME = inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD
_Parameters = ParamSpec("_Parameters")
_Result = TypeVar("_Result")


def checked(function: Callable[_Parameters, _Result]) -> Callable[_Parameters, _Result]:
    """Refuse calls of a public function that its signature does not allow.

    Raises:
        ArgumentError: In each such call.
    """
    signature, title = inspect.signature(function), function.__qualname__.removesuffix(".__init__")
    by_name = _Names(signature)

    @wraps(function)
    def call(*args: _Parameters.args, **kwargs: _Parameters.kwargs) -> _Result:
        kinds = kinds_of(function)
        given = by_name.given(args, kwargs, kinds)
        if given is None or not all(
            kind is None or kind.allows(given[name]) for name, kind in kinds.items() if name in given
        ):
            for name, value in bound(title, signature, args, kwargs).items():
                kind, collects = kinds.get(name), signature.parameters[name].kind
                values = value.values() if collects == _BY_NAME else value if collects == _ONE_BY_ONE else (value,)
                for one in values:
                    if kind is not None and not kind.allows(one):
                        raise refusal(f"{title}: {name}", one, kind)
        return function(*args, **kwargs)

    return call


class _Names:
    """Arguments by name where a call is plain: a tenth of the time of `inspect.Signature.bind`.

    Args:
        signature: Signature of the function.
    """

    def __init__(self, signature: inspect.Signature) -> None:
        parameters = signature.parameters.values()
        self._plain = all(p.kind in (p.POSITIONAL_OR_KEYWORD, p.KEYWORD_ONLY, _BY_NAME) for p in parameters)
        self._collects = next((p.name for p in parameters if p.kind == _BY_NAME), "")
        self._positional = tuple(p.name for p in parameters if p.kind == p.POSITIONAL_OR_KEYWORD)
        self._names = frozenset(signature.parameters)
        self._required = frozenset(p.name for p in parameters if p.default is p.empty and p.kind != _BY_NAME)

    def given(self, args: tuple[Any, ...], kwargs: dict[str, Any], kinds: Mapping[str, Any]) -> dict[str, Any] | None:
        """The arguments by name; None where the call does not fit, or collects some that are to be of a kind."""
        if not self._plain or len(args) > len(self._positional) or kinds.get(self._collects) is not None:
            return None
        given = dict(zip(self._positional, args, strict=False))
        if not given.keys().isdisjoint(kwargs) or not (self._collects or self._names.issuperset(kwargs)):
            return None
        given.update(kwargs)
        return given if self._required.issubset(given) else None


def check_fields(stated: Any, names: Iterable[str] | None = None) -> None:
    """Refuse fields of a dataclass whose values its annotations do not allow.

    Args:
        stated: The dataclass.
        names: Fields that are looked at; all if not given.

    Raises:
        ArgumentError: For the first such field.
    """
    kinds = kinds_of(stated.__class__)
    for name in _fields_of(stated.__class__) if names is None else names:
        kind, value = kinds.get(name), getattr(stated, name)
        if kind is not None and not kind.allows(value):
            raise refusal(f"{type(stated).__name__}: {name}", value, kind)


def with_fields(stated: _Result, changes: Mapping[str, Any]) -> _Result:
    """A frozen dataclass of checked fields with some of them replaced; only these are checked.

    Raises:
        ArgumentError: A value is not allowed.
    """
    made: _Result = object.__new__(stated.__class__)
    made.__dict__.update(stated.__dict__, **changes)
    check_fields(made, changes)
    made.__dict__.update({name: _own(value) for name, value in changes.items()})
    return made


@cache
def _fields_of(stated: type[Any]) -> tuple[str, ...]:
    """Names of the fields of a dataclass."""
    return tuple(item.name for item in fields(stated))


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
    for name in _fields_of(made.__class__):
        value = getattr(made, name)
        own = _own(value)
        if own is not value:
            object.__setattr__(made, name, own)


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


def entries_of(value: Any) -> list[Any] | None:
    """The entries of an iterable as a list; None for text, mappings, sets and what can't be iterated."""
    if isinstance(value, str | bytes | Mapping | Set) or not isinstance(value, Iterable):
        return None
    try:
        return list(value)
    except TypeError:  # An array without dimensions.
        return None


def _misfit(name: str, signature: inspect.Signature, fault: str, given: Mapping[str, object]) -> ArgumentError:
    """A call with arguments that are missing, unknown, or too many."""
    named = [
        p for p in signature.parameters.values() if p.name != "self" and p.kind not in (p.VAR_KEYWORD, p.VAR_POSITIONAL)
    ]
    known = [parameter.name for parameter in named]
    open_ended = any(p.kind == p.VAR_KEYWORD for p in signature.parameters.values())
    unknown = [argument for argument in given if argument not in known and not open_ended]
    remedy = did_you_mean(unknown[0], known) if unknown else "give what it takes, by name"
    fault = f"got an unexpected keyword argument '{unknown[0]}'" if unknown else fault
    takes = f"it takes {', '.join(known)}{', and options by name' * open_ended}"
    return ArgumentError(f"{name}: the arguments do not fit", fault, takes, remedy)
