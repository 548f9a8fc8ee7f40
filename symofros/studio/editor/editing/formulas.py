"""Which entries of a document are formulas: the format's schema says so; and their names, token by token."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from symofros.base.names import symbol_in
from symofros.description import ExpressionError, tokenize
from symofros.description.yaml import json_schema
from symofros.expr import spelled
from symofros.studio.editor.editing.data_edits import Path

_FORMULA = "#/$defs/Formula"


def formulas(data: Any) -> Iterator[tuple[Path, str]]:
    """Path and text of every formula in a document."""
    yield from _formulas(data, [json_schema()], ())


def keys_of(section: str) -> set[str]:
    """The keys that an entry of a section may have."""
    return {
        key
        for entry in _alternatives(json_schema()["properties"].get(section, {}))
        for one in _alternatives(entry.get("additionalProperties", {}))
        for key in one.get("properties", {})
    }


def _formulas(data: Any, schemas: list[dict[str, Any]], path: Path) -> Iterator[tuple[Path, str]]:
    known = [one for schema in schemas for one in _alternatives(schema)]
    if isinstance(data, str):
        if any(schema.get("$ref") == _FORMULA for schema in known):
            yield path, data
        return
    pairs = list(data.items()) if isinstance(data, dict) else list(enumerate(data)) if isinstance(data, list) else []
    for key, value in pairs:
        yield from _formulas(value, list(_inner(known, key)), (*path, key))


def _inner(schemas: list[dict[str, Any]], key: str | int) -> Iterator[dict[str, Any]]:
    """The schemas of an entry's value."""
    for schema in schemas:
        if isinstance(key, int):
            inner = schema.get("items")
        else:
            inner = schema.get("properties", {}).get(key) or schema.get("additionalProperties")
        if isinstance(inner, dict):
            yield inner


def _alternatives(schema: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """A schema without references and choices; that of formulas as its reference."""
    if schema.get("$ref") == _FORMULA:
        yield schema
    elif "$ref" in schema:
        yield from _alternatives(json_schema()["$defs"][schema["$ref"].rpartition("/")[2]])
    elif "anyOf" in schema:
        for choice in schema["anyOf"]:
            yield from _alternatives(choice)
    else:
        yield schema


def names_in(text: str) -> list[str]:
    """The names that a formula uses, functions left out; none of a text that is no formula."""
    return [name for name, _, _ in _names(text)]


def with_names(text: str, new: Mapping[str, str]) -> str:
    """A formula with names exchanged, between backquotes where they need them; all else of its text stays."""
    done, at = "", 0
    for name, start, end in _names(text):
        done += text[at:start] + (spelled(new[name]) if name in new else text[start:end])
        at = end
    return done + text[at:]


def _names(text: str) -> Iterator[tuple[str, int, int]]:
    """Symbols of a formula, and where each begins and ends."""
    try:
        tokens = tokenize(text)
    except ExpressionError:
        return
    for (kind, name, start), following in zip(tokens, tokens[1:], strict=False):
        if kind == "quoted":
            yield symbol_in(name), start, start + len(name)
        elif kind == "name" and following[:2] != ("sign", "("):
            yield name, start, start + len(name)
