"""What the palette of a diagram offers: the registry of blocks, by the folders of the library."""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any, get_args, get_origin

from symofros.diagrams.block import Block
from symofros.diagrams.files.fields import required, types_of
from symofros.diagrams.files.registry import entry_of, kinds
from symofros.diagrams.files.schema import json_schema

Json = dict[str, Any]

# Folders of symofros/blocks -> how the palette calls them, in the order of the paper's section 6.
GROUPS = {
    "initialisation": "Initialisation",
    "dynamics": "Dynamics",
    "kinematics": "Kinematics",
    "inputs": "Inputs",
    "controllers": "Controllers",
    "generic": "Generic",
    "graphics": "View",
    "fmu": "Functional mock-up units",
    "network": "Network",
}
_MODEL: Json = {
    "kind": "model",
    "section": "models",
    "group": "initialisation",
    "title": "Model",
    "name": "model",
    "help": "A mechanism that blocks refer to by its name: its file, its first state, its parameters.",
    "template": {"file": "model.yaml"},
}


@cache
def diagram_catalogue() -> Json:
    """The format, the groups, and the kinds of blocks with what each begins as."""
    entries = [_entry(kind, block) for kind, block in kinds().items()]
    groups = [{"key": key, "title": title} for key, title in GROUPS.items()]
    return {"schema": json_schema(), "groups": groups, "palette": [_MODEL, *entries]}


def group_of(kind: str) -> str:
    """The group of a kind of blocks; "" of one that is not known."""
    block = kinds().get(kind)
    return block.__module__.split(".")[2] if block else ""


def _entry(kind: str, block: type[Block]) -> Json:
    needed = required(block) - {"name"}
    template = {entry_of(name): _first(item) for name, item in types_of(block).items() if name in needed}
    return {
        "kind": kind,
        "section": "blocks",
        "group": group_of(kind),
        "title": kind.replace("_", " "),
        "name": kind,
        "help": (inspect.getdoc(block) or "").split("\n")[0],
        "page": f"docs/blocks.md, {block.__name__}",
        "about": (inspect.getdoc(block) or "").partition("\n\nAttributes:")[0],
        "template": {"kind": kind, **template},
    }


def _first(kind: Any) -> Any:
    """What a field that has no default begins as: something of its type, which its author then states."""
    if kind is str:
        return ""
    origin = get_origin(kind)
    if origin in (tuple, list, Sequence):
        return ["x"]
    if origin is Mapping:
        return {"x": _first(get_args(kind)[1])}
    if dataclasses.is_dataclass(kind) and isinstance(kind, type):
        types = types_of(kind)
        return {name: _first(types[name]) for name in required(kind)}
    return 1
