"""Diagram -> Wired: every name found, every port fed, every shape known, every unit fitting; or all faults at once."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from symofros.diagrams.block import Block, Port, Ports, Shape
from symofros.diagrams.conditional import unconditional
from symofros.diagrams.diagram import Diagram
from symofros.diagrams.fit import check_fit
from symofros.diagrams.inlets import Inlet, fed_ports, settled
from symofros.diagrams.program.model_environment import Models
from symofros.diagrams.settings import Plot
from symofros.diagrams.signals import check_entry, split
from symofros.diagrams.surroundings import Surroundings
from symofros.errors import DescriptionError, Problem, did_you_mean

Source = tuple[str, str]


@dataclass(frozen=True)
class Wired:
    """A diagram that holds together.

    Attributes:
        name: Name.
        blocks: Name -> block.
        ports: Name -> its ports, all shapes known.
        sources: (block, input) -> (block, output); inputs on their defaults are left out.
        models: Models that blocks refer to.
        outlets: Name -> (block, output), of included parts and of the diagram's own.
        origin: Origin as of the diagram.
        plots: Plots that the diagram asks for.
    """

    name: str
    blocks: Mapping[str, Block]
    ports: Mapping[str, Ports]
    sources: Mapping[Source, Source]
    models: Models
    outlets: Mapping[str, Source]
    origin: Mapping[tuple[str, ...], str]
    plots: tuple[Plot, ...] = ()

    def output(self, text: str) -> Source:
        """The (block, output) of "block.port", of "block" where it has one output, or of an outlet.

        Raises:
            DescriptionError: There is none.
        """
        return _output(self.name, text, self.blocks, self.ports, self.outlets)

    def check_signal(self, text: str) -> None:
        """Refuse text that names neither a signal "block.port" nor an entry "block.port[i]" of one.

        Raises:
            DescriptionError: There is none.
        """
        name, index = split(text)
        check_entry(text, index, self.shape(self.output(name)))

    def behind(self, block: str, inputs: Collection[str] | None = None) -> list[Source]:
        """Sources of some or all inputs of a block, in the order of its ports; unconnected inputs are skipped."""
        wanted = [port.name for port in self.ports[block].inputs if inputs is None or port.name in inputs]
        return [self.sources[block, port] for port in wanted if (block, port) in self.sources]

    def mechanisms(self) -> dict[str, str]:
        """Block that moves a mechanism -> the mechanism's model."""
        return {name: model for name, block in self.blocks.items() if (model := block.mechanism())}

    def driving(self, block: str) -> Source | None:
        """The output that prescribes motions of the mechanism that a block moves; None where none are, or none does."""
        driven = self.models.record(self.blocks[block].mechanism()).driven
        return self.sources.get((block, "u")) if driven else None

    def shape(self, source: Source) -> Shape:
        """Shape of a block's output; () for a scalar."""
        return next(port.shape or () for port in self.ports[source[0]].outputs if port.name == source[1])

    def unit(self, source: Source) -> str:
        """Unit of a block's output."""
        return next(port.unit for port in self.ports[source[0]].outputs if port.name == source[1])


def surroundings(wired: Wired, block: str) -> Surroundings:
    """Environment of a block in a wired diagram: models, shapes and units of its inputs."""
    shapes = {port.name: port.shape or () for port in wired.ports[block].inputs}
    units = {port.name: port.entry_units for port in wired.ports[block].inputs}
    buses = {port.name: port.signals for port in wired.ports[block].inputs if port.signals}
    return Surroundings(wired.models, shapes, units, buses)


@dataclass(frozen=True)
class Draft:
    """A diagram as far as it holds together, with everything that keeps it from being run.

    Attributes:
        models: Models that blocks refer to.
        ports: Name of a block -> its ports; blocks whose ports are not known are left out.
        sources: (block, input) -> (block, output), as far as both are known.
        outlets: Name -> (block, output), as far as known.
        problems: Every fault found.
    """

    models: Models
    ports: Mapping[str, Ports]
    sources: Mapping[Source, Source]
    outlets: Mapping[str, Source]
    problems: Sequence[Problem]


def draft(diagram: Diagram, unread: Collection[str] = ()) -> Draft:
    """Wire a diagram as far as it is valid, and collect all its faults.

    Args:
        diagram: Diagram as its author stated it, as far as it could be read.
        unread: Names of the blocks that could not be read, whose faults are known: wires from them are no others.
    """
    models = Models(diagram.name, diagram.models)
    problems: list[Problem] = []
    for name in diagram.models:
        try:
            models.start(name), models.parameters(name)
        except DescriptionError as error:
            problems += located(error.problems, diagram.origin.get(("model", name), ""))
    for block in diagram.blocks.values():
        problems += located(_sampling(diagram.name, block), diagram.where(block.name))
    ports = _first_ports(diagram, models, problems)
    silent = {*unread, *(diagram.blocks.keys() - ports.keys())}
    outlets: dict[str, Source] = {}
    for name, text in diagram.outlet_sources().items():
        if _block_of(text) not in silent:
            where = diagram.origin.get(("outlet", name), "")
            source = _collected(problems, where, diagram.name, text, diagram.blocks, ports, outlets)
            outlets |= {name: source} if source else {}
    sources = _sources(diagram, ports, outlets, silent, problems)
    ports = _settle(diagram, models, ports, sources, problems)
    if any(isinstance(block, Inlet) for block in diagram.blocks.values()):
        ports = _settle(diagram, models, ports, sources, problems, last=True)
        for name, known in ports.items():
            block = settled(diagram.blocks[name], known)
            problems += located(block.misfit(), diagram.where(name)) if isinstance(block, Inlet) else ()
    scalar = () if problems else _numbers_of_loops(diagram, ports)
    ports = _settle(diagram, models, ports, sources, problems, scalar=scalar) if scalar else ports
    check_fit(diagram, ports, sources, problems)
    return Draft(models, ports, sources, outlets, problems)


def wire(diagram: Diagram) -> Wired:
    """Check a diagram.

    Raises:
        DescriptionError: With every fault found.
    """
    return whole(diagram, draft(diagram))


def whole(diagram: Diagram, drafted: Draft) -> Wired:
    """A diagram of which everything holds together.

    Raises:
        DescriptionError: With every fault found.
    """
    if drafted.problems:
        raise DescriptionError(list(drafted.problems))
    parts = (drafted.ports, drafted.sources, drafted.models, drafted.outlets)
    blocks = {name: settled(block, drafted.ports[name]) for name, block in diagram.blocks.items()}
    wired = Wired(diagram.name, blocks, *parts, diagram.origin, diagram.simulation.plots)
    problems = _unseen(wired)
    if problems:
        raise DescriptionError(problems)
    return wired


def _unseen(wired: Wired) -> list[Problem]:
    """Signals that are to be shown and do not exist."""
    problems: list[Problem] = []
    for i, plot in enumerate(wired.plots):
        for text in plot.signals:
            try:
                wired.check_signal(text)
                if plot.xy:
                    _check_plane(wired, text)
            except DescriptionError as error:
                problems += located(error.problems, wired.origin.get(("plot", str(i)), ""))
    return problems


def _check_plane(wired: Wired, text: str) -> None:
    """Refuse a signal that gives no points of a plane."""
    name, index = split(text)
    shape = wired.shape(wired.output(name))
    if index is not None or len(shape) != 1 or shape[0] < 2:
        raise DescriptionError(
            f"plot: '{text:.80}' over a plane",
            "one entry" if index is not None else f"shape {shape}",
            "with xy, the second entry of a signal is drawn over its first",
            "name a vector of two entries or more, or leave xy out",
        )


def located(problems: Sequence[Problem], where: str) -> list[Problem]:
    """Problems at a place, except those that have a place of their own."""
    return [replace(problem, where=problem.where or where) for problem in problems]


def _sampling(name: str, block: Block) -> list[Problem]:
    period, offset = block.period, block.offset
    stated = [np.asarray(value) for value in (period, offset) if value is not None]
    good = all(value.ndim == 0 and value.dtype.kind in "iuf" for value in stated)
    good = good and (period is None or (math.isfinite(period) and period > 0.0))
    if not good or not 0.0 <= offset < (period or 1e-300):
        return [
            Problem(
                f"diagram '{name}': block '{block.name}' has no sample time",
                f"period {period}, offset {offset}",
                "a period above zero, an offset from zero to less than the period",
                "leave both out for a continuous block",
            )
        ]
    return []


def _first_ports(diagram: Diagram, models: Models, problems: list[Problem]) -> dict[str, Ports]:
    ports = {}
    for name, block in diagram.blocks.items():
        try:
            ports[name] = block.ports(Surroundings(models, {}, {}, {}))
        except DescriptionError as error:
            problems += located(error.problems, diagram.where(name))
    return ports


def _block_of(text: str) -> str:
    """The block, or the part, that the text of a source names."""
    return text.rpartition(".")[0] if "." in text else text


def _sources(
    diagram: Diagram,
    ports: Mapping[str, Ports],
    outlets: Mapping[str, Source],
    silent: Collection[str],
    problems: list[Problem],
) -> dict[Source, Source]:
    sources = {}
    for (block, port), text in diagram.wires.items():
        if block in silent or (_block_of(text) in silent and text not in outlets):
            continue
        if block not in diagram.blocks:
            problems.append(
                Problem(
                    f"diagram '{diagram.name}': no block '{block}'",
                    f"'{block}.{port}' is fed",
                    "wires end at blocks of the diagram",
                    did_you_mean(block, diagram.blocks) or "add the block",
                    diagram.where(block, port),
                )
            )
            continue
        known = [item.name for item in ports[block].inputs]
        if port not in known:
            problems.append(
                Problem(
                    f"diagram '{diagram.name}': block '{block}' has no input '{port}'",
                    f"'{port}'",
                    f"inputs: {', '.join(known) or 'none'}",
                    did_you_mean(port, known) or "feed one of them",
                    diagram.where(block, port),
                )
            )
            continue
        where = diagram.where(block, port)
        source = _collected(problems, where, diagram.name, text, diagram.blocks, ports, outlets)
        if source is not None:
            sources[block, port] = source
    for block, block_ports in ports.items():
        for item in block_ports.inputs:
            if item.default is None and (block, item.name) not in diagram.wires:
                problems.append(
                    Problem(
                        f"diagram '{diagram.name}': input '{block}.{item.name}' is not connected",
                        "nothing",
                        "an input without a default has a source",
                        f"connect a signal{_in_unit(item)} to it",
                        diagram.where(block),
                    )
                )
    return sources


def _in_unit(port: Port) -> str:
    shape = f" of shape {port.shape}" if port.shape is not None else ""
    return f"{shape} in {port.unit}" if port.unit else shape


def _collected(problems: list[Problem], where: str, *arguments: object) -> Source | None:
    try:
        return _output(*arguments)  # type: ignore[arg-type]
    except DescriptionError as error:
        problems += located(error.problems, where)
        return None


def _output(
    name: str, text: str, blocks: Mapping[str, Block], ports: Mapping[str, Ports], outlets: Mapping[str, Source]
) -> Source:
    if text in outlets:
        return outlets[text]
    block, _, port = text.rpartition(".") if "." in text else (text, "", "")
    if block not in blocks:
        known = [*blocks, *outlets]
        raise DescriptionError(
            f"diagram '{name}': no block '{block:.80}'",
            f"source '{text:.80}'",
            "a source is written block.port",
            did_you_mean(block, known) or "add the block",
        )
    there = [item.name for item in ports[block].outputs]
    if not port and len(there) == 1:
        return block, there[0]
    if port not in there:
        fault = f"has no output '{port}'" if port else f"has {len(there)} outputs, and none is named"
        raise DescriptionError(
            f"diagram '{name}': block '{block}' {fault}",
            f"source '{text}'",
            f"outputs: {', '.join(there) or 'none'}",
            did_you_mean(port, there) or "name one of them",
        )
    return block, port


def _numbers_of_loops(diagram: Diagram, ports: Mapping[str, Ports]) -> list[str]:
    """Blocks of loops in which nothing says a shape, but whose first value is one number."""
    blocks = {name: unconditional(diagram.blocks[name]) for name in ports}
    unknown = [name for name, known in ports.items() if any(item.shape is None for item in known.outputs)]
    if any(isinstance(blocks[name], Inlet) for name in unknown):
        return []
    return [name for name in unknown if np.ndim(getattr(blocks[name], "start", [])) == 0]


def _settle(
    diagram: Diagram,
    models: Models,
    ports: dict[str, Ports],
    sources: Mapping[Source, Source],
    problems: list[Problem],
    last: bool = False,
    scalar: Collection[str] = (),
) -> dict[str, Ports]:
    """Carry shapes along the wires until nothing changes; in the last round inlets take those of what is given.

    Of blocks in `scalar` inputs that nothing tells the shape of are scalars.
    """
    for _ in range(len(ports) + 1):
        outputs = {(block, item.name): item for block, known in ports.items() for item in known.outputs}
        now = {}
        for name, stated in ports.items():
            inputs, units, buses = {}, {}, {}
            for item in stated.inputs:
                source = sources.get((name, item.name))
                given = outputs.get(source) if source else None
                shape = (given.shape if given else None) if source else np.shape(item.default) or item.shape
                if shape is None and name in scalar:
                    shape = ()
                if shape is not None:
                    inputs[item.name] = shape
                if given is not None and any(given.entry_units):
                    units[item.name] = given.entry_units
                if given is not None and given.signals:
                    buses[item.name] = given.signals
            block = diagram.blocks[name]
            try:
                if isinstance(block, Inlet):
                    stated_ports = fed_ports(block, sources, ports, last)
                else:
                    stated_ports = block.ports(Surroundings(models, inputs, units, buses))
            except DescriptionError as error:
                problems += located(error.problems, diagram.where(name))
                return ports
            arrived = [
                replace(item, shape=inputs.get(item.name)) if item.shape is None else item
                for item in stated_ports.inputs
            ]
            now[name] = Ports(tuple(arrived), stated_ports.outputs)
        if now == ports:
            break
        ports = now
    return ports
