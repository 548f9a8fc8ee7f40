"""Values of a block's fields, read and written by the types that its class declares."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

import numpy as np

from symofros.base.events import Event
from symofros.description.yaml import Node, event_data, read_event

MISSING = dataclasses.MISSING
# A field of blocks that run native code of files: who reads a diagram consents, no file does.
CONSENT = "allow_native"
# What a field of any type may be: numbers of any shape, texts, true and false.
_ANY = "numbers, lists of them, texts, or a mapping to such"


class Misfit(Exception):
    """A value is not of a type."""

    def __init__(self, node: Node, rule: str) -> None:
        self.node, self.rule = node, rule
        super().__init__(rule)


def types_of(owner: type[Any]) -> dict[str, Any]:
    """Field -> type of a dataclass, for fields that its constructor takes and that files may state."""
    hints = get_type_hints(owner)
    return {item.name: hints[item.name] for item in dataclasses.fields(owner) if item.init and item.name != CONSENT}


def runs_native_code(owner: type[Any]) -> bool:
    """Whether blocks of a class run native code of files, once there is consent."""
    return any(item.name == CONSENT for item in dataclasses.fields(owner))


def required(owner: type[Any]) -> frozenset[str]:
    """Fields without a default."""
    return frozenset(
        item.name
        for item in dataclasses.fields(owner)
        if item.init and item.default is MISSING and item.default_factory is MISSING
    )


def words_for(kind: Any) -> str:
    """A type as a noun phrase for messages."""
    origin, arguments = get_origin(kind), get_args(kind)
    if kind is Any or _is_array(kind):
        return _ANY
    if origin is Literal:
        return " or ".join(map(str, arguments))
    if origin in (Union, UnionType):
        return " or ".join(words_for(item) for item in arguments)
    if origin in (tuple, list) or _is_a(origin, Sequence):
        return f"a list of {words_for(arguments[0])}" if arguments else "a list"
    if origin is not None and _is_a(origin, Mapping):
        return f"a mapping to {words_for(arguments[1])}"
    if dataclasses.is_dataclass(kind) and isinstance(kind, type):
        return f"a mapping of {', '.join(types_of(kind))}"
    plain = {float: "a number", int: "a whole number", bool: "true or false", str: "a text", NoneType: "null"}
    return plain.get(kind, "an object of Python's, which no file can state")


def read(kind: Any, node: Node) -> Any:
    """The value of a field from a node.

    Raises:
        Misfit: The node is not of that type.
        YamlFault: An event is none.
    """
    origin, arguments, value = get_origin(kind), get_args(kind), node.value
    if kind is Any or _is_array(kind):
        return _any(node)
    if origin is Literal:
        if isinstance(value, (dict, list)) or value not in arguments:
            raise Misfit(node, words_for(kind))
        return value
    if origin in (Union, UnionType):
        return _first_fit(arguments, node, kind)
    if origin in (tuple, list) or _is_a(origin, Sequence):
        return _listed(arguments, node, kind)
    if origin is not None and _is_a(origin, Mapping):
        if not isinstance(value, dict):
            raise Misfit(node, words_for(kind))
        if Event in get_args(arguments[1]):
            return {key: None if item.value is None else read_event(key, item) for key, item in value.items()}
        return {key: read(arguments[1], item) for key, item in value.items()}
    if dataclasses.is_dataclass(kind) and isinstance(kind, type):
        return _object(kind, node)
    return _scalar(kind, node)


def _scalar(kind: Any, node: Node) -> Any:
    value = node.value
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool) and not math.isnan(value)
    if kind is float and is_number:
        return float(value)
    if kind is int and is_number and isinstance(value, int):
        return value
    if kind in (bool, str, NoneType) and isinstance(value, kind):
        return value
    raise Misfit(node, words_for(kind))


def _any(node: Node) -> Any:
    """A value of any type; a mapping holds no others."""
    if isinstance(node.value, dict):
        return {key: _plain(item) for key, item in node.value.items()}
    return _plain(node)


def _plain(node: Node) -> Any:
    value = node.value
    if isinstance(value, list):
        return tuple(_plain(item) for item in value)
    if isinstance(value, dict) or (isinstance(value, float) and math.isnan(value)):
        raise Misfit(node, _ANY)
    return value


def _first_fit(arguments: tuple[Any, ...], node: Node, kind: Any) -> Any:
    deepest = Misfit(node, words_for(kind))
    for item in arguments:
        try:
            return read(item, node)
        except Misfit as error:
            deepest = error if error.node is not node else deepest
    raise deepest


def _listed(arguments: tuple[Any, ...], node: Node, kind: Any) -> Any:
    if not isinstance(node.value, list):
        raise Misfit(node, words_for(kind))
    count = len(node.value)
    is_open = not arguments or len(arguments) == 1 or arguments[-1] is Ellipsis
    of = [arguments[0] if arguments else Any] * count if is_open else list(arguments)
    if len(of) != count:
        raise Misfit(node, f"a list of {len(of)}")
    return tuple(read(item, entry) for item, entry in zip(of, node.value, strict=True))


def _object(kind: type[Any], node: Node) -> Any:
    """Read a dataclass from a mapping; its own checks may raise any exception."""
    if not isinstance(node.value, dict):
        raise Misfit(node, words_for(kind))
    types = types_of(kind)
    for key, item in node.value.items():
        if key not in types:
            raise Misfit(item, f"one of {', '.join(types)}")
    lacking = required(kind) - node.value.keys()
    if lacking:
        raise Misfit(node, f"with {', '.join(sorted(lacking))}")
    return kind(**{key: read(types[key], item) for key, item in node.value.items()})


def write(value: Any) -> Any:
    """A field's value as plain data for YAML: numbers, texts, lists and mappings.

    Raises:
        TypeError: No file can state it.
    """
    if isinstance(value, np.ndarray):
        return write(value.tolist())
    if isinstance(value, np.generic):
        return write(value.item())
    if isinstance(value, (tuple, list)):
        return [write(item) for item in value]
    if isinstance(value, Mapping):
        return {str(key): write(item) for key, item in value.items()}
    if isinstance(value, Event):
        return write(event_data(value))
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {item.name: write(getattr(value, item.name)) for item in dataclasses.fields(value)}
    if isinstance(value, float):
        return int(value) if value.is_integer() and abs(value) < 1e15 and str(value) != "-0.0" else value
    if value is None or isinstance(value, (bool, int, str)):
        return value
    raise TypeError(type(value).__name__)


def same(a: Any, b: Any) -> bool:
    """Whether two values of a field say the same; arrays and lists of one content do."""
    try:
        return bool(write(a) == write(b))
    except TypeError:
        return a is b


def _is_a(origin: Any, base: type[Any]) -> bool:
    return isinstance(origin, type) and issubclass(origin, base)


def _is_array(kind: Any) -> bool:
    return kind is np.ndarray or get_origin(kind) is np.ndarray
