"""What the export of a diagram shows: inputs (its inlets), outputs (signals that it tells) and run-time parameters."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from math import prod

from symofros.base.names import identifier
from symofros.diagrams.block import Shape
from symofros.diagrams.diagram import Diagram
from symofros.diagrams.inlets import open_inlets
from symofros.diagrams.program.compiled import Resolved
from symofros.diagrams.wiring import Source
from symofros.exports.functions import cell


@dataclass(frozen=True)
class Quantity:
    """An input, an output or a parameter.

    Attributes:
        name: Its name in the diagram.
        shape: Its shape; () for one number.
        units: Unit of each entry; "" for none.
        start: First value of each entry; none of outputs.
        depends: Names of the inputs that an output answers to at once.
    """

    name: str
    shape: Shape
    units: tuple[str, ...]
    start: tuple[float, ...] = ()
    depends: frozenset[str] = frozenset()

    @property
    def entries(self) -> Iterator[str]:
        """Name of each entry, row by row."""
        return (self.name + "".join(f"[{i}]" for i in at) for at in product(*map(range, self.shape)))

    @property
    def width(self) -> int:
        """Number of entries."""
        return prod(self.shape)


@dataclass(frozen=True)
class Interface:
    """All quantities, in the order of the arrays of symofros_program.h.

    Attributes:
        inputs: Entries of `inputs`.
        outputs: Entries of `signals`.
        parameters: Entries of `par`.
        sources: Where the outputs are read.
    """

    inputs: tuple[Quantity, ...]
    outputs: tuple[Quantity, ...]
    parameters: tuple[Quantity, ...]
    sources: tuple[Source, ...]

    @staticmethod
    def of(resolved: Resolved, outputs: Sequence[str]) -> Interface:
        """The interface of a diagram whose program tells some signals.

        Raises:
            DescriptionError: There is no such signal.
        """
        wired, layout = resolved.wired, resolved.layout
        inputs = []
        for inlet in open_inlets(wired.blocks):
            shape, units = inlet.port.shape or (), inlet.port.entry_units
            inputs.append(Quantity(inlet.name, shape, _spread(units, shape), tuple(inlet.start().tolist())))
        sources = tuple(map(wired.output, outputs))
        exported = []
        for text, source in zip(outputs, sources, strict=True):
            units = next(port for port in wired.ports[source[0]].outputs if port.name == source[1]).entry_units
            shape, depends = wired.shape(source), _inlets_behind(resolved, source)
            name = text if text in wired.outlets else ".".join(source)
            exported.append(Quantity(name, shape, _spread(units, shape), depends=depends))
        parameters = []
        for (block, key), place in layout.parameters.items():
            values = layout.par[place.slice]
            if block:
                units = ("",) * place.size
                parameters.append(Quantity(f"{block}.{key}", place.shape, units, tuple(values)))
                continue
            stated = {parameter.name: parameter.unit for parameter in wired.models.system(key).parameters}
            for name, value in zip(wired.models.record(key).par_names, values, strict=True):
                parameters.append(Quantity(f"{key}.{name}", (), (stated.get(name, ""),), (value,)))
        return Interface(tuple(inputs), tuple(exported), tuple(parameters), sources)

    def enumerations(self, prefix: str) -> list[str]:
        """Lines of C: where each quantity begins in its array, and how many entries it has."""
        lines, taken = list[str](), set[str]()
        groups = (
            ("IN", "INPUTS", self.inputs),
            ("OUT", "OUTPUTS", self.outputs),
            ("PAR", "PARAMETERS", self.parameters),
        )
        for kind, total, quantities in groups:
            at, rows = 0, []
            for quantity in quantities:
                label = f"{prefix}_{kind}_{identifier(quantity.name).upper()}"
                while taken & {label, f"{label}_WIDTH"}:
                    label += "_"
                taken |= {label, f"{label}_WIDTH"}
                rows.append(f"{label} = {at}, {label}_WIDTH = {quantity.width}")
                at += quantity.width
            lines.append("enum {")
            lines += [f"    {row}," for row in rows]
            lines += [f"    {prefix}_{total} = {at}", "};"]
        return lines


def _inlets_behind(resolved: Resolved, source: Source) -> frozenset[str]:
    """The open inlets that an output answers to at once."""
    wired, pieces = resolved.wired, resolved.pieces
    open_ones = {inlet.name for inlet in open_inlets(wired.blocks)}
    found, seen, stack = set[str](), set[Source](), [source]
    while stack:
        name, port = one = stack.pop()
        if one in seen:
            continue
        seen.add(one)
        if name in open_ones:
            found.add(name)
            continue
        piece = pieces[name]
        solved = port in piece.outputs and not {"a", "lam"}.isdisjoint(piece.groups(piece.outputs[port].flat))
        stack += wired.behind(name, None if solved else piece.needs[port])
    return frozenset(found)


def entry_names(quantities: Iterable[Quantity]) -> list[str]:
    """Names of the entries of all."""
    return [entry for quantity in quantities for entry in quantity.entries]


def entry_units(quantities: Iterable[Quantity]) -> list[str]:
    """Units of the entries of all."""
    return [unit for quantity in quantities for unit in quantity.units]


def entry_starts(quantities: Iterable[Quantity]) -> list[float]:
    """First values of the entries of all."""
    return [value for quantity in quantities for value in quantity.start]


def table(quantities: Sequence[Quantity]) -> str:
    """Quantities as a table of Markdown: name, first entry, width, unit, start."""
    if not quantities:
        return "None."
    rows, at = ["| name | first entry | entries | unit | start |", "|---|---|---|---|---|"], 0
    for item in quantities:
        units, start = dict.fromkeys(filter(None, item.units)), ", ".join(map(repr, item.start))
        rows.append(f"| `{item.name}` | {at} | {item.width} | {cell(', '.join(units))} | {cell(start)} |")
        at += item.width
    return "\n".join(rows)


def default_outputs(diagram: Diagram, resolved: Resolved) -> list[str]:
    """Signals that an export tells where nobody names any: the diagram's own outlets, or else what moves."""
    own = [name for name in diagram.outlets if name.rpartition(".")[0].partition(".")[0] not in diagram.parts]
    return own or [
        f"{name}.{port.name}"
        for name in resolved.wired.mechanisms()
        for port in resolved.wired.ports[name].outputs
        if port.name in ("q", "v")
    ]


def _spread(units: tuple[str, ...], shape: Shape) -> tuple[str, ...]:
    """A unit for each entry, of units along the last axis."""
    size = prod(shape)
    return units * (size // len(units)) if units and size % len(units) == 0 else ("",) * size
