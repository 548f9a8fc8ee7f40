"""Where in a document a problem is: the path of the entry, its line, and the block that shows it."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Any

from pydantic import ValidationError

from symofros.description import ExpressionError, parse
from symofros.description.yaml import NativeFile, default_joint_name, placed_problems
from symofros.errors import Problem, first_of
from symofros.studio.editor.editing.data_edits import Path, section_of
from symofros.studio.editor.editing.formulas import formulas, keys_of
from symofros.studio.editor.editing.yaml_spans import YamlText

ShownProblem = dict[str, Any]

_NAMED = re.compile(
    r"(joint|body|beam|constraint|connection|contact|virtual power|virtual_power|potential|state|event|parameter|input)"
    r" '([^']*)'"
)
_FRAME = re.compile(r"frame '([^']*)' of body '([^']*)'")
_SECTION_OF = {
    "connection": ("connections",),
    "contact": ("contacts",),
    "constraint": ("closures", "couplings", "nonholonomic"),
    "virtual power": ("virtual_power",),
    "virtual_power": ("virtual_power",),
    "potential": ("potentials",),
    "state": ("states",),
    "event": ("events",),
    "parameter": ("parameters",),
    "input": ("inputs",),
    "body": ("bodies",),
    "beam": ("bodies",),
}
# Words of messages -> keys of the file, where they differ.
_WORDS = {"inertia": "moments", "modes": "family", "functions": "family"}


def schema_problems(source: YamlText, file: str) -> dict[Problem, Path]:
    """Violations of the format in the main file, each with its exact path."""
    try:
        NativeFile.model_validate(source.data)
    except ValidationError as error:
        placed = dict(placed_problems(error, source.root, file, source.data))
        return {problem: placed.get(problem, ()) for problem in first_of(placed)}
    return {}


def placed(problem: Problem, source: YamlText | None, file: str, exact: dict[Problem, Path]) -> ShownProblem:
    """A problem as the page shows it."""
    where, _, number = problem.where.rpartition(":")
    line = int(number) if number.isdigit() and where == file else 0
    path: Path = ()
    if problem in exact:
        path = exact[problem]
    elif source is not None and (line or not problem.where):
        path = _path_of(problem, source, line)
    path = (*path, *_left_out(problem.what, path))
    if path and source is not None and line:
        line = source.root.at(path).key_line if source.node(path) else line
    what = problem.what if where in ("", file) or not number.isdigit() else f"{problem.where}: {problem.what}"
    return {
        "path": list(path),
        "line": line,
        "object": what,
        "found": problem.found,
        "rule": problem.rule,
        "remedy": problem.remedy,
        "node": node_of(path, source.data if source else None),
    }


def node_of(path: Path, data: Any) -> str:
    """The block of the diagram that an entry belongs to; "" if it has none."""
    if len(path) >= 2 and path[0] in ("bodies", "nonholonomic"):
        return f"{path[0]}/{path[1]}"
    if path[:1] == ("system",):
        return "world"
    return ""


def _path_of(problem: Problem, source: YamlText, line: int) -> Path:
    data = source.data
    if not isinstance(data, dict):
        return ()
    entry = _named(problem.what, data) or _by_line(source, line)
    inner = _at(data, entry)
    field = _by_formula(problem, data, entry) or _by_name(problem, inner) or _by_word(problem.what, inner)
    return (*entry, *field)


def _named(what: str, data: dict[str, Any]) -> Path:
    """The entry that a message names first."""
    if frame := _FRAME.search(what):
        path: Path = ("bodies", frame[2], "frames", frame[1])
        return path if _at(data, path) is not None else ()
    if what.startswith("system "):
        return ("system",) if "system" in data else ()
    for kind, name in _NAMED.findall(what):
        if kind == "joint":
            for body, entry in section_of(data, "bodies").items():
                joint = entry.get("joint") if isinstance(entry, dict) else None
                if isinstance(joint, dict) and joint.get("name", default_joint_name(body)) == name:
                    return ("bodies", body, "joint")
        else:
            for section in _SECTION_OF[kind]:
                if name in section_of(data, section):
                    return (section, name)
    return ()


def _by_line(source: YamlText, line: int) -> Path:
    """The entry that begins at a line; the outermost one if there are several."""
    best: Path = ()
    for path, node in _walk(source):
        if node.key_line <= line and path and node.key_line == line:
            return path
        if node.key_line < line and len(path) == 1:
            best = path
    return best


def _walk(source: YamlText) -> Iterator[tuple[Path, Any]]:
    stack: list[tuple[Path, Any]] = [((), source.root)]
    while stack:
        path, node = stack.pop()
        yield path, node
        pairs = list(node.value.items()) if isinstance(node.value, dict) else []
        pairs += list(enumerate(node.value)) if isinstance(node.value, list) else []
        stack += [((*path, key), child) for key, child in reversed(pairs)]


def _by_formula(problem: Problem, data: Any, entry: Path) -> Path:
    """The formula within an entry that reads as the problem's; of several, the one whose keys the message names."""
    wanted = problem.found.strip("'")
    if not problem.found.startswith("'") or not wanted:
        return ()
    candidates = [
        path[len(entry) :]
        for path, text in formulas(data)
        if path[: len(entry)] == entry and _canonical(text) == wanted
    ]
    mentioned = {_WORDS.get(word, word) for word in re.findall(r"\w+", problem.what.partition(": ")[2])}
    return next((path for path in candidates if mentioned & {*path}), candidates[0] if candidates else ())


def _canonical(text: str) -> str:
    try:
        return str(parse(text))
    except ExpressionError:
        return text


def _by_name(problem: Problem, data: Any) -> Path:
    """The first entry within one whose value is a name that the message quotes, after the entry's own name."""
    message = _NAMED.sub("", problem.what.partition(": ")[2])
    quoted = re.findall(r"'([^']*)'", f"{message} {problem.found}")
    for name in quoted:
        if path := _first(data, lambda _, value, name=name: value == name):
            return path
    return ()


def _by_word(what: str, data: Any) -> Path:
    """The first key within an entry that the message mentions, after the entry's name."""
    message = what.partition(": ")[2] or what
    for word in re.findall(r"[A-Za-z_]\w*", re.sub(r"'[^']*'", "", message)):
        for key in (word, _WORDS.get(word, word)):
            if path := _first(data, lambda step, _, key=key: step == key):
                return path
    return ()


def _left_out(what: str, entry: Path) -> Path:
    """The key that a message begins with behind the name of an entry, which may have it and leaves it out."""
    key = what.rpartition(": ")[2].partition(" ")[0]
    return (key,) if len(entry) == 2 and key in keys_of(str(entry[0])) else ()


def _first(data: Any, matches: Callable[..., bool]) -> Path:
    """The first entry that matches, level by level."""
    level: list[tuple[Path, Any]] = [((), data)]
    while level:
        deeper: list[tuple[Path, Any]] = []
        for path, value in level:
            pairs = list(value.items()) if isinstance(value, dict) else []
            pairs += list(enumerate(value)) if isinstance(value, list) else []
            for key, child in pairs:
                if matches(key, child):
                    return (*path, key)
                deeper.append(((*path, key), child))
        level = deeper
    return ()


def _at(data: Any, path: Path) -> Any:
    for step in path:
        if isinstance(data, dict) and step in data:
            data = data[step]
        elif isinstance(data, list) and isinstance(step, int) and step < len(data):
            data = data[step]
        else:
            return None
    return data
