"""Where in a diagram's document a problem is: the path of the entry, its line, the block and the port that show it."""

from __future__ import annotations

import re
from typing import Any

from symofros.errors import Problem
from symofros.studio.editor.editing.data_edits import Path, section_of
from symofros.studio.editor.editing.yaml_spans import YamlText

ShownProblem = dict[str, Any]

_NAME = r"[A-Za-z]\w*"
# What messages of the reader and of the wiring name, the more exact first: group `block`, group `port` or `field`.
_PORTS = (
    re.compile(rf"-> (?P<block>{_NAME})\.(?P<port>{_NAME}): "),
    re.compile(rf"input '(?P<block>{_NAME})\.(?P<port>{_NAME})'"),
    re.compile(rf"'(?P<block>{_NAME})\.(?P<port>{_NAME})'"),
    re.compile(rf"block '(?P<block>{_NAME})' has no input '(?P<port>{_NAME})'"),
)
_FIELD = re.compile(rf"(?P<what>block|model|part) '(?P<name>{_NAME})'(?: \(\w+\))?(?:: (?P<field>\w+))?")
_SOURCE = re.compile(r"source '(?P<source>[^']*)'")
_SECTIONS = {"block": "blocks", "model": "models", "part": "parts"}


def placed(problem: Problem, source: YamlText, file: str, data: Any) -> ShownProblem:
    """A problem as the page shows it."""
    where, _, number = problem.where.rpartition(":")
    is_here = number.isdigit() and where in ("", file)
    path, port = _place(problem, data)
    if not path and is_here:
        path = _by_line(source, int(number))
    elsewhere = number.isdigit() and not is_here
    return {
        "path": list(path),
        "line": int(number) if is_here else 0,
        "object": f"{problem.where}: {problem.what}" if elsewhere else problem.what,
        "found": problem.found,
        "rule": problem.rule,
        "remedy": problem.remedy,
        "node": "/".join(map(str, path[:2])) if len(path) >= 2 and path[0] in _SECTIONS.values() else "",
        "port": port,
    }


def _place(problem: Problem, data: Any) -> tuple[Path, str]:
    """The entry that a message names, and the input of the block that it is about; () and "" if none."""
    what = re.sub(r"^diagram '[^']*': ", "", problem.what)
    for pattern in _PORTS:
        if (match := pattern.search(what)) and match["block"] in section_of(data, "blocks"):
            entry = section_of(data, "blocks")[match["block"]]
            inputs = entry.get("inputs") if isinstance(entry, dict) else None
            inside = ("inputs", match["port"]) if isinstance(inputs, dict) and match["port"] in inputs else ()
            return ("blocks", match["block"], *inside), match["port"]
    if (match := _SOURCE.match(problem.found)) and (path := _fed_by(match["source"], data)):
        return path, str(path[-1])
    for match in _FIELD.finditer(what):
        section = _SECTIONS[match["what"]]
        if match["name"] in section_of(data, section):
            entry = section_of(data, section)[match["name"]]
            known = isinstance(entry, dict) and match["field"] in entry
            return (section, match["name"], *([match["field"]] if known else [])), ""
    return (), ""


def _fed_by(source: str, data: Any) -> Path:
    """The first input that a source is written for."""
    for section in ("blocks", "parts"):
        for name, entry in section_of(data, section).items():
            inputs = entry.get("inputs") if isinstance(entry, dict) else None
            for port, text in inputs.items() if isinstance(inputs, dict) else ():
                if text == source:
                    return (section, name, "inputs", port)
    return ()


def _by_line(source: YamlText, line: int) -> Path:
    """The innermost entry of a section that begins at a line or above it."""
    best: Path = ()
    root = source.root.value
    for section, owner in root.items() if isinstance(root, dict) else ():
        if owner.key_line > line:
            break
        best = (section,)
        for name, entry in owner.value.items() if isinstance(owner.value, dict) else ():
            if entry.key_line > line:
                break
            best = (section, name)
    return best
