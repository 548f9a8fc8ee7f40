"""docs/blocks.md: its code runs, and it names every block with all its ports."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import Any

import pytest

import symofros as sf
import symofros.blocks as library
from symofros.diagrams.block import Block
from tests.docs.pages import blocks

PAGE = (Path(__file__).parents[2] / "docs" / "blocks.md").read_text()
CLASSES = {name: item for name, item in vars(library).items() if isinstance(item, type)}
BLOCKS = {name: item for name, item in CLASSES.items() if issubclass(item, Block) and item is not Block}


@cache
def ports_seen() -> dict[str, set[str]]:
    """Runs the page; class -> ports of its blocks in the diagrams there."""
    namespace: dict[str, Any] = {}
    simulations: list[sf.Simulation] = []

    class Watched(sf.Simulation):
        def __init__(self, diagram: sf.Diagram) -> None:
            super().__init__(diagram)
            simulations.append(self)

    original, sf.Simulation = sf.Simulation, Watched  # type: ignore[misc]
    try:
        for block in blocks("docs/blocks.md", "python"):
            exec(compile("\n" * block.line + block.text, "blocks.md", "exec"), namespace)
    finally:
        sf.Simulation = original  # type: ignore[misc]
    found: dict[str, set[str]] = {}
    for simulation in simulations:
        wired = simulation.resolved.wired
        for name, block in wired.blocks.items():
            ports = wired.ports[name]
            found.setdefault(type(block).__name__, set()).update(p.name for p in (*ports.inputs, *ports.outputs))
    return found


def test_the_code_of_the_blocks_page_runs() -> None:
    assert ports_seen().keys() <= BLOCKS.keys()


@pytest.mark.parametrize("name", BLOCKS)
def test_every_block_is_documented_with_its_ports(name: str) -> None:
    section = re.search(rf"^### {name}\n(.*?)(?=^##|\Z)", PAGE, re.DOTALL | re.MULTILINE)
    assert section, f"docs/blocks.md has no section '{name}'"
    if name == "FMU":  # Its example needs a unit: docs/howto/fmu.md makes one.
        return
    ports = ports_seen().get(name)
    assert ports is not None, f"docs/blocks.md has no example of '{name}'"
    if name in (
        "Formula",
        "PythonBlock",
        "Sequence",
        "ModelFunction",
        "StateMachine",
        "BusCreator",
        "BusSelector",
    ):  # Whose ports users name, or a function.
        return
    missing = {port for port in ports if f"`{port}`" not in section[1].replace("`wrench_FRAME`", "`wrench_tool`")}
    assert not missing, f"{name}: ports not named"


def test_docstrings_of_blocks_describe_every_field() -> None:
    for name, block in BLOCKS.items():
        stated = block.__doc__ or ""
        for field in block.form():
            assert re.search(rf"^\s+{field}: ", stated, re.MULTILINE), f"{name}.{field} is not documented"
