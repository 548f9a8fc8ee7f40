"""Inlets of an outermost diagram as blocks: what comes from outside, held, by samples, or by formulas of t."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from symofros.base.arrays import Array, numeric, real_array
from symofros.description import ExpressionError, parse
from symofros.diagrams.block import Block, Environment, EvaluationContext, Port, Ports, Shape, Values
from symofros.diagrams.diagram import Diagram
from symofros.diagrams.tensor import Tensor
from symofros.errors import DescriptionError, Problem, did_you_mean
from symofros.expr import Expression, lower
from symofros.simulation.inputs import Signal

# Name of the output of an inlet: signals are called by the inlet's name.
VALUE = "value"


@dataclass(frozen=True, kw_only=True)
class Inlet(Block):
    """An input of a diagram from outside.

    Attributes:
        port: The signal, as far as it is stated or known from the inputs that it feeds; `default` is its start.
        given: Numbers, a Signal, or formulas of t; None: an input of an export.
    """

    port: Port
    given: Any = None

    @property
    def is_open(self) -> bool:
        """Whether nothing is given, so that the signal is an input of an export."""
        return self.given is None

    @cached_property
    def formulas(self) -> tuple[Expression, ...]:
        """The formulas of t that are given, one an entry; none for numbers and signals."""
        texts = [self.given] if isinstance(self.given, str) else self.given
        if not (isinstance(texts, (list, tuple)) and any(isinstance(text, str) for text in texts)):
            return ()
        try:
            read = tuple(parse(str(text)) for text in texts)
        except ExpressionError as error:
            raise DescriptionError(error.problem_of(f"inlet '{self.name}'")) from None
        for name in sorted(set[str]().union(*(item.symbols() for item in read)) - {"t"}):
            raise _refused(self.name, name, "formulas of inlets are of the time t", "write a number for it")
        return read

    @cached_property
    def signal(self) -> Signal:
        """The numbers over time; a start, or a number, holds."""
        if isinstance(self.given, Signal):
            return self.given
        value = self.port.default if self.given is None else self.given
        numbers = numeric(f"inlet '{self.name}'", 0.0 if value is None else value)
        return Signal([0.0], np.reshape(numbers, (1, -1)), "hold")

    @property
    def own_shape(self) -> Shape:
        """Shape of what is given."""
        if isinstance(self.given, Signal):
            return tuple(self.given.values.shape[1:])
        if self.formulas:
            return () if isinstance(self.given, str) else (len(self.formulas),)
        return np.shape(self.port.default if self.given is None else self.given)

    def start(self) -> Array:
        """First values, one an entry."""
        size = int(np.prod(self.port.shape or ()))
        return np.array(np.broadcast_to(self.signal.values.reshape(len(self.signal.t), -1)[0], size))

    def taking(self, taken: Iterable[Port], last: bool) -> Port:
        """The signal as the inputs that it feeds take it.

        Args:
            taken: These inputs.
            last: Whether its shape is to be that of what is given, or of its start, where no input says another.
        """
        taken = list(taken)
        shapes = [port.shape for port in (self.port, *taken) if port.shape is not None]
        units = next((port.entry_units for port in (self.port, *taken) if any(port.entry_units)), ("",))
        starts = [port.default for port in (self.port, *taken) if port.default is not None]
        known = last and not (self.is_open and self.port.default is None)
        shape = shapes[0] if shapes else self.own_shape if known else None
        unit = {"unit": units[0]} if len(units) == 1 else {"units": units}
        return Port(VALUE, shape, default=starts[0] if starts else None, **unit)

    def misfit(self) -> Sequence[Problem]:
        """A shape that nothing says, or of what is given another than the signal's."""
        found, rule, remedy = f"shape {self.own_shape}", f"it feeds inputs of shape {self.port.shape}", "mend it"
        if self.port.shape is None:
            found, remedy = "its shape is unknown", "add_inlet(..., shape=(n,)); () is one number"
            rule = "a shape follows from an input that it feeds, from what is given, or is stated"
        elif self._fits(self.own_shape):
            if self.port.default is None or self._fits(np.shape(self.port.default)):
                return ()
            found = f"a start of shape {np.shape(self.port.default)}"
        return _refused(self.name, found, rule, remedy).problems

    def _fits(self, shape: Shape) -> bool:
        """Whether numbers of a shape are one for all entries, or one each: in the signal's shape, or in a row."""
        size = int(np.prod(self.port.shape or ()))
        return int(np.prod(shape)) == 1 or shape in (self.port.shape, (size,))

    def ports(self, environment: Environment) -> Ports:
        """The signal."""
        return Ports((), (self.port,))

    def samples(self) -> Mapping[str, Signal]:
        """The signal, unless formulas give it."""
        return {} if self.formulas else {VALUE: self.signal}

    def compute(self, context: EvaluationContext) -> Values:
        """The formulas, lowered into the graph."""
        if not self.formulas:
            return {}
        edges = [lower(item, context.g, {"t": context.t.flat[0]}) for item in self.formulas]
        shape = self.port.shape or ()
        return {VALUE: Tensor.of(context.g, edges * (int(np.prod(shape)) // len(edges)), shape)}


def with_inlets(diagram: Diagram, inputs: Mapping[str, Any] | None = None) -> Diagram:
    """A diagram whose inlets are blocks.

    Args:
        diagram: Diagram as its author stated it.
        inputs: Inlet -> numbers, a Signal, or formulas of t; None: all are inputs of an export.

    Raises:
        DescriptionError: Names that no inlet has, inlets that nothing is given for, or names that a block has, too.
    """
    problems = list(_misnamed(diagram, inputs))
    inlets, wires = dict[str, Block](), dict(diagram.wires)
    for name in diagram.inlets:
        port = replace(diagram.inlet_ports.get(name, Port(VALUE, None)), name=VALUE)
        inlets[name] = Inlet(name=name, port=port, given=None if inputs is None else inputs.get(name))
        for target in diagram.fed_by(name):
            block, _, input_name = target.rpartition(".")
            if (block, input_name) in wires:
                fed = f"by {wires[block, input_name]} and inlet '{name}'"
                what, rule = f"diagram '{diagram.name}': input '{target}' is fed twice", "an input has one source"
                problems.append(Problem(what, fed, rule, "leave one of them out"))
            wires[block, input_name] = name
    if problems:
        raise DescriptionError(problems)
    lines: dict[tuple[str, ...], str] = {
        ("block", name): diagram.origin[kind, name] for kind, name, *_ in diagram.origin if kind == "inlet"
    }
    if not inlets:
        return diagram
    return replace(diagram, blocks={**inlets, **diagram.blocks}, wires=wires, origin={**diagram.origin, **lines})


def _misnamed(diagram: Diagram, inputs: Mapping[str, Any] | None) -> Iterable[Problem]:
    for name in diagram.inlets:
        if name in diagram.blocks:
            what, rule = (
                f"diagram '{diagram.name}': an inlet and a block are named '{name}'",
                "signals bear these names",
            )
            yield Problem(what, f"'{name}'", rule, "rename one")
    if inputs is None:
        return
    known = ", ".join(diagram.inlets) or "none"
    for name in inputs:
        if name not in diagram.inlets:
            meant = did_you_mean(name, diagram.inlets) or "leave it out"
            yield Problem(
                f"diagram '{diagram.name}': no inlet '{name:.60}'", f"'{name:.60}'", f"inlets: {known}", meant
            )
    for name in diagram.inlets:
        if inputs.get(name) is None:
            yield not_given(diagram.name, name)
        elif not isinstance(inputs[name], Signal) and not are_finite(inputs[name]):
            yield not_finite(name, inputs[name])


def not_given(diagram: str, inlet: str) -> Problem:
    """What is wrong with a run of an open diagram."""
    return Problem(
        f"diagram '{diagram}': inlet '{inlet}' is not given",
        "a run without it",
        "what enters from outside is given by name: numbers, a Signal, or formulas of t",
        f"run(t_end, inputs={{'{inlet}': 0.0}}), or include the diagram in another",
    )


def are_finite(given: Any) -> bool:
    """Whether numbers for an inlet are finite; what is no number is judged elsewhere."""
    array = real_array(given)
    return array is None or bool(np.isfinite(array).all())


def not_finite(inlet: str, given: Any) -> Problem:
    """What is wrong with numbers for an inlet that are not finite."""
    return Problem(f"inlet '{inlet}': a number is not finite", f"{given!r:.60}", "signals are finite", "give another")


def _refused(name: str, found: str, rule: str, remedy: str) -> DescriptionError:
    return DescriptionError(f"inlet '{name}': does not fit", found, rule, remedy)


def settled(block: Block, ports: Ports) -> Block:
    """An inlet that knows its signal; other blocks as they are."""
    return replace(block, port=ports.outputs[0]) if isinstance(block, Inlet) else block


def fed_ports(
    block: Inlet, sources: Mapping[tuple[str, str], tuple[str, str]], ports: Mapping[str, Ports], last: bool
) -> Ports:
    """Ports of an inlet, as far as the inputs that it feeds are known."""
    fed = [target for target, source in sources.items() if source[0] == block.name]
    taken = [port for name, key in fed if name in ports for port in ports[name].inputs if port.name == key]
    return Ports((), (block.taking(taken, last),))


def open_inlets(blocks: Mapping[str, Block]) -> Sequence[Inlet]:
    """Inlets that are inputs of an export, in order."""
    return [block for block in blocks.values() if isinstance(block, Inlet) and block.is_open]
