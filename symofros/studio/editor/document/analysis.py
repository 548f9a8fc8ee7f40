"""Text -> its meaning: that of a mechanism is found here, that of a diagram in symofros/studio/editor/diagrams."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import Any

from symofros.base.units import parse
from symofros.description import System, in_order
from symofros.description.yaml import DIAGRAM, YamlFault, read_yaml
from symofros.errors import DescriptionError, Problem
from symofros.mechanics.topology import find_problems, unit_problems
from symofros.studio.editor.diagrams.analysis import analyse_diagram
from symofros.studio.editor.document.diagram import diagram
from symofros.studio.editor.document.element_lines import element_lines
from symofros.studio.editor.document.meaning import Analysis, Json, as_json
from symofros.studio.editor.document.problems import placed, schema_problems
from symofros.studio.editor.editing.yaml_spans import YamlText, yaml_text_of


def analyse(file: Path, text: str) -> Analysis:
    """Read and check a text.

    Args:
        file: Path of the document; files that it includes are relative to it.
        text: Text of the document.
    """
    try:
        source = yaml_text_of(text)
    except YamlFault as error:
        return Analysis(False, problems=[placed(error.problem, None, "", {})])
    if isinstance(source.root.value, dict) and DIAGRAM in source.root.value:
        return analyse_diagram(file, source)
    problems, system = _checked(file, source)
    exact = schema_problems(source, str(file)) if problems else {}
    shown_problems = [placed(problem, source, str(file), exact) for problem in problems]
    data = as_json(source.data)
    graph = diagram(data)
    blocks = {node["id"]: node for node in graph["nodes"]}
    base = next((node for node in graph["nodes"] if node["kind"] == "base"), None)
    for entry in shown_problems:
        if base and entry["path"][:2] == base["path"]:
            entry["node"] = base["id"]
        if entry["node"] in blocks:
            blocks[entry["node"]]["problems"] += 1
        else:
            entry["node"] = ""
    parameters = _parameters(data, system)
    inputs = [
        {"name": item.name, "unit": item.unit, "unit_fault": _unit_fault(item.unit)}
        for item in (system.inputs if system else ())
    ]
    lines = element_lines(source, [*graph["nodes"], *graph["edges"]])
    return Analysis(True, data, graph, shown_problems, parameters, inputs, system, lines=lines)


def _parameters(data: Any, system: System | None) -> list[Json]:
    """Parameters as the page's table has them; those that can't be read keep their text, and have no number.

    `unit_fault` says why a unit is none: files take any text there, a table that shows units does not pass it over.
    """
    read = {
        item.name: {"name": item.name, "value": item.value, "unit": item.unit, "constant": item.constant}
        | {"number": item.value}
        for item in (system.parameters if system else ())
    }
    written = data.get("parameters") if isinstance(data, dict) else None
    listed: dict[str, Json] = {}
    for name, entry in written.items() if isinstance(written, dict) else ():
        stated = entry if isinstance(entry, dict) else {"value": entry}
        unit = stated.get("unit")
        listed[name] = read.get(name) or {
            "name": name,
            "value": stated.get("value"),
            "unit": unit if isinstance(unit, str) else "",
            "constant": stated.get("constant") is True,
            "number": None,
        }
    return [{**item, "unit_fault": _unit_fault(item["unit"])} for item in (listed | read).values()]


@lru_cache(maxsize=1000)
def _unit_fault(text: str) -> str:
    """Why a text names no unit; "" if it does, or is none."""
    try:
        parse(text)
    except DescriptionError as error:
        return f"no such unit: {error.problem.found}; {error.problem.remedy}"
    return ""


def _checked(file: Path, source: YamlText) -> tuple[list[Problem], System | None]:
    """Every problem of the file and of its mechanism."""
    try:
        reading = read_yaml(file, source.text, (source.root, source.duplicates))
        system = reading.system
        problems = [] if system is None else [*find_problems(system, reading.broken), *unit_problems(system)]
    except DescriptionError as error:
        return list(error.problems), None
    return list(in_order([*reading.problems, *problems])), reading.system
