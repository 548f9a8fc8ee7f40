"""What pydantic found wrong with a file, as Problems: where it stands, what it is, the rule, the remedy."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import Any

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from symofros.description.yaml.schema import VERSION, json_schema
from symofros.description.yaml.yaml_nodes import Node
from symofros.errors import Problem, did_you_mean, near_name

Path = tuple[str | int, ...]

# The mappings whose keys are names of things.
_THINGS = {"bodies": "body", "parameters": "parameter", "inputs": "input", "frames": "frame", "events": "event"}

# What URDF, SDF, MJCF and textbooks call an entry -> its key here.
_FOREIGN_TERMS = {
    **dict.fromkeys(("com", "cog", "cm", "center", "centre", "centre_of_mass"), "center_of_mass"),
    **dict.fromkeys(("inertia", "diaginertia", "fullinertia", "tensor", "i", "j", "ixx"), "moments"),
    **dict.fromkeys(("pos", "xyz", "origin", "offset", "translation"), "position"),
    **dict.fromkeys(("rpy", "quat", "quaternion", "orientation", "euler"), "rotation"),
    **dict.fromkeys(("lower", "upper", "range", "limit"), "limits"),
    **dict.fromkeys(("springs", "dampers", "spring", "damper", "damping", "friction", "stiffness"), "elements"),
    **dict.fromkeys(("gear", "mimic"), "couplings"),
    **dict.fromkeys(("actions", "triggers"), "events"),
    **dict.fromkeys(("condition", "when", "trigger"), "formula"),
    **dict.fromkeys(("modes", "engaged"), "switches"),
    **dict.fromkeys(("set", "sets", "then", "do"), "action"),
    "type": "kind",
    "m": "mass",
}

# Pydantic's error types -> what the value must be, and how to write it.
_NUMBER = ("a number", "write a finite number, such as 0.5; formulas are not read here")
_WHOLE = ("a whole number", "write a whole number, such as 2")
_MAPPING = ("a mapping", "write it as {name: value}, or on lines of their own")
_KINDS = {
    "float_type": _NUMBER,
    "finite_number": ("a finite number", _NUMBER[1]),
    "int_type": _WHOLE,
    "int_from_float": _WHOLE,
    "int_parsing": _WHOLE,
    "string_type": ("a text", "put it in quotes"),
    "string_too_short": ("a text of one character or more", "write a name"),
    "bool_type": ("true or false", "write true or false"),
    "list_type": ("a list", "write it as [x, y, z]"),
    "dict_type": _MAPPING,
    "model_type": _MAPPING,
}
# Pydantic's error type -> its bound in the error's context, and how a rule states it.
_BOUNDS = {
    "greater_than_equal": ("ge", "at least"),
    "greater_than": ("gt", "above"),
    "less_than_equal": ("le", "at most"),
    "less_than": ("lt", "below"),
}


def placed_problems(error: ValidationError, root: Node, file: str, data: Any) -> list[tuple[Problem, Path]]:
    """Problems found by pydantic, each with its path in the data.

    Args:
        error: What validation raised.
        root: The document, for lines.
        file: Name of the file, for messages.
        data: What was validated.
    """
    faults = error.errors(include_url=False)
    return [(problem_of(fault, f"{file}:{_line_of(fault, root)}", data), _path_of(fault)) for fault in faults]


def _path_of(error: ErrorDetails) -> Path:
    """Path of an error in the data, without the last item "[key]" by which pydantic marks an error of a key."""
    loc = error["loc"]
    return loc[:-1] if loc and loc[-1] == "[key]" else loc


def _line_of(error: ErrorDetails, root: Node) -> int:
    """The line of a wrong key or value; of the mapping's key where an entry is missing."""
    path = _path_of(error)
    if error["type"] == "missing":
        return root.at(path[:-1]).key_line
    node = root.at(path)
    return node.key_line if error["type"] == "extra_forbidden" else node.line


def problem_of(error: ErrorDetails, where: str, data: Any) -> Problem:
    """One of pydantic's errors as a Problem.

    Args:
        error: One of ValidationError.errors().
        where: "file:line" of it.
        data: What was validated.
    """
    path = _path_of(error)
    context = error.get("ctx", {})
    kind = error["type"]
    if kind == "problem":
        what, found, rule, remedy = (str(context[part]) for part in ("what", "found", "rule", "remedy"))
        return Problem(_about(path, what), found, rule, remedy, where)
    if kind == "extra_forbidden":
        known = _known_keys(path[:-1])
        key = _short(path[-1])
        return Problem(
            _about(path[:-1], f"unknown entry '{key}'"),
            f"'{key}'",
            f"the entries here are {', '.join(known)}",
            _where_it_belongs(str(path[-1]), path[:-1], known, _keys_at(data, path[:-1])),
            where,
        )
    if kind == "missing":
        return _missing(path, error["input"], where)
    if kind == "literal_error":
        return _not_a_choice(path, error["input"], where)
    if kind in ("too_short", "too_long"):
        return _wrong_count(path, kind, context, where)
    if kind in _BOUNDS:
        return _out_of_range(path, kind, error, where)
    expected, remedy = _KINDS.get(kind, ("", ""))
    what = f"not {expected}" if expected else "not allowed"
    rule = f"this is {expected}" if expected else error["msg"].lower()
    return Problem(_about(path, what), f"'{_short(error['input'])}'", rule, remedy, where)


def _missing(path: Path, owner: Any, where: str) -> Problem:
    if path == ("symofros",):
        return Problem(
            "the file does not state its format",
            "no entry 'symofros'",
            "a description states the version of its format",
            f"begin with: symofros: {VERSION}",
            where,
        )
    stated_keys = ", ".join(map(_short, owner)) if isinstance(owner, Mapping) and owner else "nothing"
    choices = " | ".join(str(choice) for schema in _schemas(path) for choice in _choices(schema))
    return Problem(
        _about(path[:-1], f"entry '{path[-1]}' is missing"),
        stated_keys,
        f"'{path[-1]}' is always given here",
        f"add {path[-1]}: {choices or '…'}",
        where,
    )


def _not_a_choice(path: Path, value: Any, where: str) -> Problem:
    choices = [str(choice) for schema in _schemas(path) for choice in _choices(schema)]
    if path == ("symofros",):
        return Problem(
            "another version of the format",
            _short(value),
            f"this program reads version {VERSION}",
            "update symofros, or convert the file",
            where,
        )
    quoted = f"'{_short(value)}'"
    return Problem(
        _about(path, f"unknown choice {quoted}"),
        quoted,
        f"one of {', '.join(choices)}",
        did_you_mean(str(value), choices),
        where,
    )


def _wrong_count(path: Path, kind: str, context: Mapping[str, Any], where: str) -> Problem:
    count = context.get("actual_length") or "too many"
    limit = context["min_length" if kind == "too_short" else "max_length"]
    rule = f"at {'least' if kind == 'too_short' else 'most'} {limit}"
    remedy = "add entries" if kind == "too_short" else "remove entries"
    sizes = {(s.get("minItems"), s.get("maxItems")) for s in _schemas(path)}
    if sizes == {(limit, limit)}:
        rule, remedy = f"{limit} entries, in order", f"give all {limit}, zeros included"
    return Problem(_about(path, "wrong number of entries"), f"{count} entries", rule, remedy, where)


def _out_of_range(path: Path, kind: str, error: ErrorDetails, where: str) -> Problem:
    name, words = _BOUNDS[kind]
    bound = error.get("ctx", {})[name]
    ranges = [(s["minimum"], s["maximum"]) for s in _schemas(path) if "minimum" in s and "maximum" in s]
    rule = f"from {ranges[0][0]:g} to {ranges[0][1]:g}" if ranges else f"{words} {bound:g}"
    remedy = f"write {bound:g}, the nearest that is allowed" if name in ("ge", "le") else f"write a number {rule}"
    return Problem(_about(path, "out of range"), f"'{_short(error['input'])}'", f"a number {rule}", remedy, where)


def _short(value: Any) -> str:
    text = "nothing" if value is None else str(value)
    return text if len(text) <= 60 else text[:59] + "…"


def _about(path: Path, what: str) -> str:
    """Message of a fault after its path in words: "body 'arm1': joint: axis[2]: not a number"."""
    return ": ".join([*_words(path), what.removeprefix("value: ")])


def _words(path: Path) -> Iterator[str]:
    i = 0
    while i < len(path):
        step = path[i]
        if step in _THINGS and i + 1 < len(path):
            yield f"{_THINGS[str(step)]} '{_short(path[i + 1])}'"
            i += 1
        else:
            indices = ""
            while i + 1 < len(path) and isinstance(path[i + 1], int):
                i += 1
                indices += f"[{path[i]}]"
            yield f"{_short(step)}{indices}"
        i += 1


def _where_it_belongs(key: str, path: Path, known: list[str], stated: Collection[str]) -> str:
    """The remedy for an unknown key: the entry here that other formats call so, another level, or one spelt nearly so.

    Args:
        key: The key.
        path: Path of the mapping that it stands in.
        known: Entries that the mapping may have.
        stated: Entries that it has: of several that would take the key, one that is there.
    """
    term = _FOREIGN_TERMS.get(key.lower())
    if term in known:
        return f"write it as '{term}'"
    inside = [entry for entry in known if key in _known_keys((*path, entry))]
    inside = [entry for entry in inside if entry in stated] or inside
    if inside:
        return "write it under " + " or ".join(f"'{entry}'" for entry in inside)
    near = near_name(key, known)
    if not near and path and key in _known_keys(path[:-1]):
        return f"write it one level up, beside '{_short(path[-1])}'"
    return near or "remove it, or rename it"


def _keys_at(data: Any, path: Path) -> Collection[str]:
    """Keys of the mapping at a path of the data."""
    for step in path:
        data = data[step]
    return tuple(map(str, data)) if isinstance(data, Mapping) else ()


def _known_keys(path: Path) -> list[str]:
    return [key for schema in _schemas(path) for key in schema.get("properties", {})]


def _choices(schema: Mapping[str, Any]) -> list[Any]:
    return [*schema.get("enum", []), *([schema["const"]] if "const" in schema else [])]


def _schemas(path: Path) -> list[dict[str, Any]]:
    """The JSON Schemas of the value at a path; several where there are alternatives."""
    schemas = _alternatives(json_schema())
    for step in path:
        inner: list[dict[str, Any]] = []
        for schema in schemas:
            child = schema.get("properties", {}).get(step) or schema.get("additionalProperties")
            child = schema.get("items") if isinstance(step, int) else child
            inner += _alternatives(child) if isinstance(child, dict) else []
        schemas = inner
    return schemas


def _alternatives(schema: dict[str, Any]) -> list[dict[str, Any]]:
    if "$ref" in schema:
        return _alternatives(json_schema()["$defs"][schema["$ref"].rpartition("/")[2]])
    if "anyOf" in schema:
        return [one for choice in schema["anyOf"] for one in _alternatives(choice)]
    return [schema]
