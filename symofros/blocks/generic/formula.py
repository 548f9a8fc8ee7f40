"""What users write themselves: formulas, and functions of Python's."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Set
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.blocks.checks import numbers, refuse
from symofros.blocks.generic.sampling import needs_period
from symofros.description import ExpressionError, parse
from symofros.diagrams.block import Block, Environment, EvaluationContext, Port, Ports, Values
from symofros.diagrams.external_block import ExternalBlock, Running
from symofros.diagrams.tensor import Tensor
from symofros.errors import DescriptionError
from symofros.expr import Edge, Expression, NoValueError, lower
from symofros.simulation.user_functions import check_called_with

_ENTRY = re.compile(r"(?P<name>\w+)\[(?P<index>\d+)\]$", re.ASCII)
_NAME = re.compile(r"[A-Za-z]\w*$", re.ASCII)
MAX_FORMULAS = 256


@dataclass(frozen=True, kw_only=True)
class Formula(Block):
    """Outputs by formulas of the inputs, of constants, and of the time t.

    Names in formulas are inputs (scalars, or entries of vectors such as u[0]), constants, or t. They are read by the
    parser of model files: nothing in them is run.

    Attributes:
        formulas: Output -> formula, or formulas of its entries; one formula alone is that of y.
        constants: Name -> number, run-time parameters.
        units: Input or output -> unit.
    """

    formulas: Any
    constants: Any = None
    units: Any = None

    def __post_init__(self) -> None:
        """Formulas that can be read."""
        for name, value in dict(self.constants or {}).items():
            numbers(self.name, f"constant '{name:.40}'", value, ())
        stated = {*self._parsed, *self._entries}
        for name in (*stated, *dict(self.constants or {})):
            if not _NAME.match(name) or "__" in name or name == "t":
                raise refuse(
                    self.name,
                    f"name '{name:.40}'",
                    repr(name),
                    "letters, digits and single underscores, a letter first; t is the time",
                    "rename it",
                )
        for name in dict(self.units or {}):
            if name not in stated:
                raise refuse(
                    self.name,
                    f"a unit of '{name:.40}'",
                    repr(name),
                    f"inputs and outputs: {', '.join(sorted(stated))}",
                    "rename it",
                )

    @cached_property
    def _parsed(self) -> dict[str, list[Expression] | Expression]:
        """Output -> formula, or those of its entries."""
        given = dict(self.formulas) if isinstance(self.formulas, Mapping) else {"y": self.formulas}
        count = sum(len(value) if isinstance(value, (list, tuple)) else 1 for value in given.values())
        if not 0 < count <= MAX_FORMULAS or any(isinstance(v, (list, tuple)) and not v for v in given.values()):
            raise refuse(self.name, "formulas", f"{count} of them", f"1 to {MAX_FORMULAS}", "state one, or part them")
        return {
            name: [self._read(name, text) for text in value]
            if isinstance(value, (list, tuple))
            else self._read(name, value)
            for name, value in given.items()
        }

    def _read(self, name: str, text: object) -> Expression:
        return read_formula(self.name, name, text)

    def _expressions(self) -> list[Expression]:
        return [item for value in self._parsed.values() for item in (value if isinstance(value, list) else [value])]

    @cached_property
    def _entries(self) -> dict[str, int | None]:
        """Input -> least size of its vector; None: a scalar."""
        return input_sizes(self.name, self._expressions(), {"t", *dict(self.constants or {})})

    def ports(self, environment: Environment) -> Ports:
        """An input for each name, an output for each formula."""
        units = dict(self.units or {})
        outputs = (
            Port(name, (len(value),) if isinstance(value, list) else (), units.get(name, ""))
            for name, value in self._parsed.items()
        )
        return Ports(input_ports(self.name, self._entries, environment, units), tuple(outputs))

    def parameters(self) -> dict[str, Array]:
        """The constants."""
        return {name: np.asarray(value, dtype=np.float64) for name, value in dict(self.constants or {}).items()}

    def with_parameters(self, values: Mapping[str, Any]) -> Block:
        """Block with other values of constants."""
        return replace(self, constants={**dict(self.constants or {}), **values})

    def compute(self, context: EvaluationContext) -> Values:
        """The formulas, lowered into the graph."""
        bindings = bindings_of(context)
        try:
            symbols = {
                name: ([lower(item, context.g, bindings) for item in value], (len(value),))
                if isinstance(value, list)
                else ([lower(value, context.g, bindings)], ())
                for name, value in self._parsed.items()
            }
        except NoValueError as error:
            raise refuse(
                self.name,
                "a formula has no value",
                error.problem.found,
                "constant parts are within the domain of functions",
                "mend the formula",
            ) from None
        return {name: Tensor.of(context.g, edges, shape) for name, (edges, shape) in symbols.items()}


@dataclass(frozen=True, kw_only=True)
class PythonBlock(ExternalBlock):
    """A function of Python's, called at samples by the loop in C; its outputs are held between.

    Attributes:
        function: (t, inputs) -> outputs, both mappings from ports to arrays.
        inputs: Input -> shape, or None where any will do.
        outputs: Output -> shape.
        on_begin: Called before a run.
        on_end: Called after a run, however it ended.
        feedthrough: Whether outputs answer to inputs of the same sample; else it gets those of the one before.
    """

    function: Callable[[float, Mapping[str, Array]], Mapping[str, Any]]
    inputs: Any = None
    outputs: Any = None
    on_begin: Callable[[], None] | None = None
    on_end: Callable[[], None] | None = None
    feedthrough: bool = True

    def __post_init__(self) -> None:
        """A function, an output or more, a sample time."""
        if not callable(self.function):
            raise refuse(self.name, "nothing to call", repr(self.function), "function takes (t, inputs)", "give one")
        check_called_with(f"block '{self.name}': its function", self.function, "t", "inputs")
        if not dict(self.outputs or {}):
            raise refuse(
                self.name, "no outputs", "none", "an output or more, with their shapes", 'write for example {"y": (3,)}'
            )
        needs_period(self)

    def ports(self, environment: Environment) -> Ports:
        """The ports that the user stated; an input without a shape takes that of the signal connected to it."""
        given = {
            name: environment.inputs.get(name) if shape is None else tuple(shape)
            for name, shape in dict(self.inputs or {}).items()
        }
        return Ports(
            tuple(Port(name, shape) for name, shape in given.items()),
            tuple(Port(name, tuple(shape)) for name, shape in dict(self.outputs).items()),
        )

    def feeds_through(self) -> bool:
        """Whether outputs depend on inputs at once, as stated."""
        return self.feedthrough

    def begin(self, environment: Environment) -> Running:
        """Call the user's `on_begin`, if given, and return the running function."""
        if self.on_begin:
            self.on_begin()
        return _Function(self)


class _Function(Running):
    """A user's function in one run; what it remembers is the user's own."""

    def __init__(self, block: PythonBlock) -> None:
        self._block = block

    def call(self, t: float, inputs: Mapping[str, Array]) -> Mapping[str, Any]:
        """Call the user's function, and check that it returns exactly the declared outputs.

        Raises:
            DescriptionError: Outputs are missing, or have other shapes.
        """
        outputs = self._block.function(t, inputs)
        shapes = {name: tuple(shape) for name, shape in dict(self._block.outputs).items()}
        given = (
            {name: np.shape(value) for name, value in outputs.items()}
            if isinstance(outputs, Mapping)
            else type(outputs)
        )
        if given != shapes:
            raise refuse(
                self._block.name,
                "its function returned something else",
                given,
                f"outputs {shapes}",
                "return a mapping of these",
            )
        return outputs

    def end(self) -> None:
        """Call the user's `on_end`, if given."""
        if self._block.on_end:
            self._block.on_end()


def read_formula(block: str, name: str, text: object) -> Expression:
    """A formula of a block, read by the parser of model files.

    Raises:
        DescriptionError: It is none.
    """
    try:
        return parse(str(text))
    except ExpressionError as error:
        raise DescriptionError(error.problem_of(f"block '{block}': formula of '{name:.40}'")) from None


def input_sizes(block: str, formulas: Iterable[Expression], known: Set[str]) -> dict[str, int | None]:
    """Input that formulas name -> least size of its vector; None: a scalar.

    Raises:
        DescriptionError: An input is a scalar here and a vector there.
    """
    sizes: dict[str, int | None] = {}
    for symbol in sorted(set().union(*(item.symbols() for item in formulas))):
        match = _ENTRY.match(symbol)
        name = match["name"] if match else symbol
        if name in known:
            continue
        size = int(match["index"]) + 1 if match else None
        if name in sizes and (size is None) != (sizes[name] is None):
            raise refuse(
                block,
                f"input '{name:.40}' is a scalar and a vector",
                symbol,
                "an input is one of them",
                f"write {name}[0] for its first entry",
            )
        sizes[name] = size if size is None else max(size, sizes.get(name) or 0)
    return sizes


def input_ports(
    block: str, sizes: Mapping[str, int | None], environment: Environment, units: Mapping[str, str]
) -> tuple[Port, ...]:
    """A port for each input that formulas name.

    Args:
        block: Name of the block.
        sizes: Input -> least size, of `input_sizes`.
        environment: Shapes of what is connected.
        units: Input -> unit.

    Raises:
        DescriptionError: What is connected has not the entries that formulas name.
    """
    inputs = []
    for name, least in sizes.items():
        shape = environment.inputs.get(name) if least is not None else ()
        if least is not None and shape is not None and (len(shape) != 1 or shape[0] < least):
            raise refuse(
                block,
                f"input '{name}' has no entry {least - 1}",
                shape,
                "a vector that has the entries which formulas name",
                "correct the formula",
            )
        inputs.append(Port(name, shape, units.get(name, "")))
    return tuple(inputs)


def bindings_of(context: EvaluationContext) -> dict[str, Edge]:
    """Names in formulas -> their values: the time t, parameters, scalar inputs, entries of vectors."""
    bindings = {"t": context.t.flat[0], **{name: value.flat[0] for name, value in context.parameters.items()}}
    for name, value in context.inputs.items():
        if value.shape:
            bindings |= {f"{name}[{i}]": edge for i, edge in enumerate(value.flat)}
        else:
            bindings[name] = value.flat[0]
    return bindings
