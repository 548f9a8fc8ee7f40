"""Whether signals fit where they go: shapes and units of both ends of a wire."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from symofros.base.units import agree, parse
from symofros.diagrams.block import Ports
from symofros.diagrams.diagram import Diagram
from symofros.errors import DescriptionError, Problem


def check_fit(
    diagram: Diagram,
    ports: Mapping[str, Ports],
    sources: Mapping[tuple[str, str], tuple[str, str]],
    problems: list[Problem],
) -> None:
    """Add what does not fit of what is connected: units that are none, shapes and units that differ.

    Args:
        diagram: Diagram that the faults are of.
        ports: Name of a block -> its ports, with their shapes as far as they are known.
        sources: (block, input) -> (block, output).
        problems: List that receives the faults.
    """
    outputs = {(block, item.name): item for block, block_ports in ports.items() for item in block_ports.outputs}
    odd: set[str] = set()  # Texts that are no units.
    for block, block_ports in ports.items():
        for item in (*block_ports.inputs, *block_ports.outputs):
            try:
                parse(item.unit)
            except DescriptionError as error:
                one = error.problems[0]
                what = f"diagram '{diagram.name}': '{block}.{item.name}': {one.what}"
                problems.append(replace(one, what=what, where=diagram.where(block, item.name)))
                odd.add(item.unit)
        unknown = [item.name for item in block_ports.outputs if item.shape is None]
        if unknown and not problems:  # Shapes that faults leave open are no faults of their own.
            problems.append(
                Problem(
                    f"diagram '{diagram.name}': the shape of '{block}.{unknown[0]}' is unknown",
                    "a loop of open shapes",
                    "the shape of a signal follows from one of its sources",
                    "give a block of the loop a first value",
                    diagram.where(block),
                )
            )
    for (block, port), source in sources.items():
        given, taking = outputs.get(source), [item for item in ports[block].inputs if item.name == port]
        if given is None or not taking:
            continue
        item = taking[0]
        wire = f"diagram '{diagram.name}': {'.'.join(source)} -> {block}.{port}"
        if item.shape != given.shape and None not in (item.shape, given.shape):
            problems.append(
                Problem(
                    f"{wire}: shapes differ",
                    f"{given.shape}",
                    f"the input takes {item.shape}",
                    "pick or join entries in a block between",
                    diagram.where(block, port),
                )
            )
        if not odd & {given.unit, item.unit} and not agree(given.unit, item.unit):
            problems.append(
                Problem(
                    f"{wire}: units differ",
                    f"{given.unit}",
                    f"the input takes {item.unit}",
                    "convert by a gain with units",
                    diagram.where(block, port),
                )
            )
