"""The JSON Schema of a diagram's file, made of the classes of blocks; editors complete and check by it."""

from __future__ import annotations

import dataclasses
import inspect
import json
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin

from symofros.base.events import Event
from symofros.description.yaml import json_schema as native_schema
from symofros.diagrams.block import Block
from symofros.diagrams.conditional import Condition
from symofros.diagrams.files.fields import MISSING, required, types_of, words_for, write
from symofros.diagrams.files.inlets import SCHEMA as INLET
from symofros.diagrams.files.reader import HEAD, VERSION
from symofros.diagrams.files.reading_options import READING
from symofros.diagrams.files.registry import entry_of, kinds
from symofros.diagrams.files.run_settings import SETTINGS
from symofros.simulation.stepping.methods import METHODS

SCHEMA_FILE = Path(__file__).with_name("schema.json")

_ATTRIBUTE = re.compile(r"    (?P<name>\w+): (?P<text>.+)")

Plain = dict[str, Any]
_PLAIN: dict[Any, Plain] = {
    float: {"type": "number"},
    int: {"type": "integer"},
    bool: {"type": "boolean"},
    str: {"type": "string"},
    NoneType: {"type": "null"},
}
_TEXTS: Plain = {"type": "object", "additionalProperties": {"type": "string"}}
_NUMBERS: Plain = {"type": "object", "additionalProperties": {"type": "number"}}
_ABOVE: Plain = {"type": "number", "exclusiveMinimum": 0}


def of_type(kind: Any) -> Plain:
    """The schema of a field of a type; without rules where no file can state one."""
    origin, arguments = get_origin(kind), get_args(kind)
    if kind in _PLAIN:
        return _PLAIN[kind]
    if origin is Literal:
        return {"enum": list(arguments)}
    if origin in (Union, UnionType):
        return {"anyOf": [of_type(item) for item in arguments]}
    if origin in (tuple, list, Sequence):
        is_open = len(arguments) == 1 or arguments[-1] is Ellipsis
        if is_open:
            return {"type": "array", "items": of_type(arguments[0])}
        return {"type": "array", "prefixItems": [of_type(item) for item in arguments], "items": False}
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return {"type": "object", "additionalProperties": of_type(arguments[1])}
    if kind is Event:  # As native files state it.
        return {"$ref": "#/$defs/EventEntry"}
    if dataclasses.is_dataclass(kind) and isinstance(kind, type):
        return _object(_described(kind), sorted(required(kind)))
    return {"description": words_for(kind)}


def json_schema() -> Plain:
    """The schema of a file with the blocks of the library."""
    blocks = {kind: _block(kind, owner) for kind, owner in kinds().items()}
    model = {
        "file": {"type": "string"},
        "functions": {"type": "integer", "minimum": 0, "maximum": 100},
        **{name: of_type(kind) for name, kind in READING.items()},
        "start": _NUMBERS,
        "parameters": _NUMBERS,
    }
    sections = {
        "name": {"type": "string"},
        "models": _named(_object(model, ["file"])),
        "blocks": _named({"oneOf": [{"$ref": f"#/$defs/{kind}"} for kind in blocks]}),
        "parts": _named({"$ref": "#/$defs/part"}),
        "wires": _TEXTS,
        "inlets": _named(INLET),
        "outlets": _TEXTS,
    }
    part = {"file": {"type": "string"}, "diagram": _object(sections), "models": _TEXTS, "inputs": _TEXTS}
    part |= {"condition": of_type(Condition), "parameters": _named({"type": ["number", "array"]})}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "A SYMOFROS diagram",
        **_object({HEAD: {"const": VERSION}, **sections, "simulation": _settings()}, [HEAD]),
        "$defs": {
            **_native("EventEntry", "Formula"),
            **blocks,
            "part": _object(part) | {"oneOf": [{"required": ["file"]}, {"required": ["diagram"]}]},
        },
    }


def _native(*names: str) -> Plain:
    """Definitions of the schema of native files."""
    return {name: native_schema()["$defs"][name] for name in names}


def _block(kind: str, owner: type[Block]) -> Plain:
    properties: Plain = {"kind": {"const": kind}}
    defaults = _defaults(owner)
    for name, item in _described(owner).items():
        if name != "name":
            properties[entry_of(name)] = item | defaults.get(name, {})
    schema = _object(properties | {"inputs": _TEXTS}, ["kind", *sorted(map(entry_of, required(owner) - {"name"}))])
    return {"description": (inspect.getdoc(owner) or "").split("\n")[0], **schema}


def _described(owner: type[Any]) -> dict[str, Plain]:
    """Field of a class -> its schema, with what the class says of it."""
    descriptions = _attributes(owner)
    return {
        name: of_type(item) | ({"description": descriptions[name]} if name in descriptions else {})
        for name, item in types_of(owner).items()
    }


def _attributes(owner: type[Any]) -> dict[str, str]:
    """Field -> its description in the docstrings of a class and its bases."""
    descriptions: dict[str, str] = {}
    for base in reversed(owner.__mro__):
        _, _, section = inspect.cleandoc(vars(base).get("__doc__") or "").partition("Attributes:\n")
        name = ""
        for line in section.split("\n\n")[0].splitlines():
            if match := _ATTRIBUTE.match(line):
                name, descriptions[match["name"]] = match["name"], match["text"]
            elif name:
                descriptions[name] += " " + line.strip()
    return descriptions


def _defaults(owner: type[Block]) -> dict[str, Plain]:
    """Field -> its default, where JSON can state it."""
    stated: dict[str, Plain] = {}
    for item in dataclasses.fields(owner):
        with suppress(TypeError, ValueError):
            if item.default is not MISSING:
                stated[item.name] = {"default": write(item.default)}
                json.dumps(stated[item.name], allow_nan=False)
                continue
        stated.pop(item.name, None)
    return stated


def _settings() -> Plain:
    signals: Plain = {"type": "array", "items": {"type": "string"}}
    titled = {"title": {"type": "string"}, "signals": signals, "xy": {"type": "boolean"}}
    plot = {"anyOf": [{"type": "string"}, signals, _object(titled, ["signals"])]}
    known: Plain = {name: _ABOVE for name in SETTINGS}
    known |= {
        "t0": {"type": "number"},
        "threads": {"type": "integer", "minimum": 1},
        "method": {"enum": list(METHODS)},
        "plots": {"type": "array", "items": plot},
    }
    return _object(known)


def _object(properties: Plain, needed: list[str] | None = None) -> Plain:
    schema: Plain = {"type": "object", "properties": properties, "additionalProperties": False}
    return schema | ({"required": needed} if needed else {})


def _named(of: Plain) -> Plain:
    return {"type": "object", "additionalProperties": of}


def schema_text() -> str:
    """The JSON Schema as it is published."""
    return json.dumps(json_schema(), indent=2) + "\n"


if __name__ == "__main__":
    SCHEMA_FILE.write_text(schema_text(), encoding="utf-8")
