"""Buses: signals that go together under names, and what takes some of them out by these."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from math import prod

from symofros.blocks.checks import refuse
from symofros.blocks.quantities import with_units
from symofros.diagrams.block import Block, Environment, EvaluationContext, Port, Ports, Values
from symofros.diagrams.tensor import joined
from symofros.errors import did_you_mean

MAX_SIGNALS = 100
BUS = "bus"
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*\Z")


def _check_names(block: Block, names: Sequence[str], form: str) -> None:
    """Refuse a list of names that are none, or are not one for each signal.

    Raises:
        DescriptionError: They are so.
    """
    rule = f"1 to {MAX_SIGNALS} names of {form}, each once"
    if not 0 < len(names) <= MAX_SIGNALS:
        raise refuse(block.name, "signals", f"{len(names)} of them", rule, "name them")
    for name in names:
        if not all(map(_NAME.match, name.split("."))) or names.count(name) > 1:
            raise refuse(block.name, f"signal '{name:.60}'", repr(name), rule, "rename it, or name it once")


@dataclass(frozen=True, kw_only=True)
class BusCreator(Block):
    """Signals under names, one after the other as one vector; a bus among them is a part of the bus.

    Attributes:
        signals: Names of the signals, which are those of the inputs.
    """

    signals: Sequence[str]

    def __post_init__(self) -> None:
        """Names."""
        _check_names(self, list(self.signals), "letters, digits and underscores")
        if BUS in self.signals:
            raise refuse(self.name, f"signal '{BUS}'", BUS, "the output has that name", "rename it")

    def ports(self, environment: Environment) -> Ports:
        """An input for each name; output bus."""
        inputs = []
        for name in self.signals:
            port = with_units(Port(name, environment.inputs.get(name)), environment.units.get(name, ("",)))
            inputs.append(replace(port, signals=environment.buses.get(name, ())))
        if any(port.shape is None for port in inputs):
            return Ports(tuple(inputs), (Port(BUS, None),))
        sizes = [prod(port.shape or ()) for port in inputs]
        units = [unit for port, size in zip(inputs, sizes, strict=True) for unit in (port.entry_units * size)[:size]]
        return Ports(tuple(inputs), (replace(with_units(Port(BUS, (sum(sizes),)), units), signals=tuple(inputs)),))

    def compute(self, context: EvaluationContext) -> Values:
        """All entries."""
        return {BUS: joined([context.inputs[name] for name in self.signals])}


@dataclass(frozen=True, kw_only=True)
class BusSelector(Block):
    """Signals of a bus, by their names.

    Attributes:
        signals: Names; "arm.q" is the signal q of the bus arm within the bus, and the output `arm_q`.
    """

    signals: Sequence[str]

    def __post_init__(self) -> None:
        """Names, of which no two have one output."""
        _check_names(self, list(self.signals), "letters, digits and underscores, with dots between buses")
        outputs = list(map(_output, self.signals))
        if len(set(outputs)) < len(outputs):
            rule = "different names, dots read as underscores"
            raise refuse(self.name, "two signals have one output", ", ".join(self.signals), rule, "rename one")

    def ports(self, environment: Environment) -> Ports:
        """Input bus; an output for each name."""
        outputs = [Port(_output(name), None) for name in self.signals]
        shape, signals = environment.inputs.get(BUS), environment.buses.get(BUS, ())
        bus = replace(with_units(Port(BUS, shape), environment.units.get(BUS, ("",))), signals=signals)
        if shape is not None:
            found = self._found(signals)
            outputs = [replace(port, name=_output(name)) for name, (port, _) in found.items()]
        return Ports((bus,), tuple(outputs))

    def compute(self, context: EvaluationContext) -> Values:
        """Entries of each signal, in its shape."""
        bus, found = context.inputs[BUS], self._found(context.environment.buses.get(BUS, ()))
        return {
            _output(name): bus[start : start + prod(port.shape or ())].reshape(*(port.shape or ()))
            for name, (port, start) in found.items()
        }

    def _found(self, signals: Sequence[Port]) -> dict[str, tuple[Port, int]]:
        """Name -> signal, and where it begins in the bus.

        Raises:
            DescriptionError: What is connected is no bus, or has no such signal.
        """
        known = {name: (port, start) for name, port, start in _listed(signals)}
        for name in self.signals:
            if not known:
                rule = "names are those of a bus creator"
                raise refuse(self.name, "its input is no bus", "a signal without names", rule, "connect a bus")
            if name not in known:
                there = f"signals: {', '.join(list(known)[:20])}"
                remedy = did_you_mean(name, known) or "name one of them"
                raise refuse(self.name, f"no signal '{name:.60}' in the bus", repr(name), there, remedy)
        return {name: known[name] for name in self.signals}


def _output(name: str) -> str:
    """The output of a signal."""
    return name.replace(".", "_")


def _listed(signals: Sequence[Port], path: str = "", start: int = 0) -> Iterator[tuple[str, Port, int]]:
    """Name, signal, and place in the bus, of all signals and of those within them."""
    for port in signals:
        yield path + port.name, port, start
        yield from _listed(port.signals, f"{path}{port.name}.", start)
        start += prod(port.shape or ())
