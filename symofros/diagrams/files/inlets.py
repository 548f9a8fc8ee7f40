"""The section `inlets` of a diagram's file: what each feeds, and what the inputs that it feeds do not say of it."""

from __future__ import annotations

from typing import Any

import numpy as np

from symofros.description.yaml import Node
from symofros.diagrams.block import Port
from symofros.diagrams.diagram import Diagram
from symofros.diagrams.files.entries import Entries

Plain = dict[str, Any]
STATED = ("to", "shape", "unit", "start")
_TARGETS: Plain = {"anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}}]}
_SIZES: Plain = {"type": "array", "items": {"type": "integer", "minimum": 1, "maximum": 10000}, "maxItems": 2}
_START: Plain = {"anyOf": [{"type": "number"}, {"type": "array", "items": {"type": "number"}}]}
SCHEMA: Plain = {
    "anyOf": [
        *_TARGETS["anyOf"],
        {
            "type": "object",
            "properties": {"to": _TARGETS, "shape": _SIZES, "unit": {"type": "string"}, "start": _START},
            "required": ["to"],
            "additionalProperties": False,
        },
    ]
}


def read_inlets(entries: Entries, diagram: Diagram, node: Node) -> None:
    """Read the inlets of a diagram."""
    for name, one in entries.mapping(node, "inlets").items():
        what = f"inlet '{name:.60}'"
        stated = entries.mapping(one, what, STATED) if isinstance(one.value, dict) else {"to": one}
        if entries.missing(one, what, "to", stated, "an inlet feeds inputs"):
            continue
        to = stated["to"]
        diagram.origin["inlet", name] = entries.where(one)
        items = [to] if isinstance(to.value, str) else entries.listed(to, what)
        diagram.inlets[name] = tuple(entries.text(item, what) for item in items)
        if len(stated) > 1:
            shape = _shape(entries, stated["shape"], f"{what}: shape") if "shape" in stated else None
            unit = entries.text(stated["unit"], f"{what}: unit") if "unit" in stated else ""
            start = _start(entries, stated["start"], f"{what}: start") if "start" in stated else None
            diagram.inlet_ports[name] = Port(name, shape, unit, start)


def _shape(entries: Entries, node: Node, what: str) -> tuple[int, ...] | None:
    sizes = [item.value for item in entries.listed(node, what)]
    if len(sizes) <= 2 and all(isinstance(n, int) and not isinstance(n, bool) and 0 < n <= 10000 for n in sizes):
        return tuple(sizes)
    entries.fault(
        node, f"{what} is none", node.plain(), "up to two sizes from 1 to 10000", "such as [3]; [] is one number"
    )
    return None


def _start(entries: Entries, node: Node, what: str) -> Any:
    if isinstance(node.value, list):
        return [entries.number(item, what) for item in node.value]
    return entries.number(node, what)


def written_inlets(diagram: Diagram) -> Plain:
    """The section as it is written down."""
    section: Plain = {}
    for name, targets in diagram.inlets.items():
        to = [targets] if isinstance(targets, str) else list(targets)
        port = diagram.inlet_ports.get(name)
        section[name] = to
        if port is not None:
            shape = {} if port.shape is None else {"shape": list(port.shape)}
            unit = {"unit": port.unit} if port.unit else {}
            start = {} if port.default is None else {"start": np.asarray(port.default, dtype=np.float64).tolist()}
            section[name] = {"to": to, **shape, **unit, **start}
    return section
