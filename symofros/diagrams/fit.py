"""Whether signals fit where they go: shapes and units of both ends of a wire."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from symofros.base.units import agree, parse
from symofros.diagrams.block import Port, Ports, Shape
from symofros.diagrams.diagram import Diagram
from symofros.errors import DescriptionError, Problem


def check_fit(
    diagram: Diagram,
    ports: Mapping[str, Ports],
    sources: Mapping[tuple[str, str], tuple[str, str]],
    problems: list[Problem],
) -> None:
    """Add the faults of ports and wires: invalid units, unknown shapes, and shapes or units that differ.

    Args:
        diagram: Diagram that the faults are of.
        ports: Name of a block -> its ports, with their shapes as far as they are known.
        sources: (block, input) -> (block, output).
        problems: List that receives the faults.
    """
    outputs = {(block, item.name): item for block, block_ports in ports.items() for item in block_ports.outputs}
    odd: set[str] = set()  # Texts that are no units.
    for block, block_ports in ports.items():
        stated = [(port, unit) for port in (*block_ports.inputs, *block_ports.outputs) for unit in port.entry_units]
        for item, unit in stated:
            try:
                parse(unit)
            except DescriptionError as error:
                one = error.problems[0]
                what = f"diagram '{diagram.name}': '{block}.{item.name}': {one.what}"
                problems.append(replace(one, what=what, where=diagram.where(block, item.name)))
                odd.add(unit)
        unknown = [item.name for item in block_ports.outputs if item.shape is None]
        if unknown and not problems:  # Shapes that faults leave open are no faults of their own.
            problems.append(
                Problem(
                    f"diagram '{diagram.name}': the shape of '{block}.{unknown[0]}' is unknown",
                    "a loop of open shapes",
                    "the shape of a signal follows from one of its sources",
                    "give a block of the loop a first value, or a sum in it a signal of that shape",
                    diagram.where(block),
                )
            )
    for (block, port), source in sources.items():
        given, taking = outputs.get(source), [item for item in ports[block].inputs if item.name == port]
        if given is None or not taking:
            continue
        item = taking[0]
        wire = f"diagram '{diagram.name}': {'.'.join(source)} -> {block}.{port}"
        if None not in (item.shape, given.shape) and not fits(given.shape, item.shape):
            problems.append(
                Problem(
                    f"{wire}: shapes differ",
                    f"{given.shape}",
                    f"the input takes {item.shape}",
                    "pick or join entries in a block between",
                    diagram.where(block, port),
                )
            )
        differing = _differing(given, item, odd)
        if differing is not None:
            entry, unit, wanted = differing
            problems.append(
                Problem(
                    f"{wire}: units differ{entry}",
                    unit,
                    f"the input takes {wanted}",
                    "convert by a gain with units",
                    diagram.where(block, port),
                )
            )


# One number: alone, and as a vector of one.
_ONE_NUMBER = ((), (1,))


def fits(given: Shape | None, taken: Shape | None) -> bool:
    """Whether a signal of a shape can go where another one is taken: one number is one, alone or as a vector of one."""
    return given == taken or (given in _ONE_NUMBER and taken in _ONE_NUMBER)


def _differing(given: Port, taken: Port, odd: set[str]) -> tuple[str, str, str] | None:
    """Place, unit and expected unit of the first entry whose units differ; the place is "" if there is one entry."""
    own, other = given.entry_units, taken.entry_units
    count = max(len(own), len(other))
    if {len(own), len(other)} - {1, count}:
        return None  # Shapes differ, and that is said.
    for i, (a, b) in enumerate(zip(own * (count // len(own)), other * (count // len(other)), strict=True)):
        if not odd & {a, b} and not agree(a, b):
            return (f" at entry {i}" if count > 1 else ""), a, b
    return None
