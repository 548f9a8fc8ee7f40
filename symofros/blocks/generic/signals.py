"""Signals put together and taken apart: constants, gains, sums, products, entries."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from symofros.base.units import parse
from symofros.blocks.checks import known_name, numbers, refuse, whole
from symofros.blocks.quantities import actuated_names, common_shape, entry_units, passed_units, with_units
from symofros.diagrams.block import Block, Environment, EvaluationContext, Port, Ports, Values
from symofros.diagrams.tensor import joined

# Inputs that a block with a free number of them may have.
MAX_INPUTS = 64


@dataclass(frozen=True, kw_only=True)
class Constant(Block):
    """Always the same numbers: y = value.

    Attributes:
        value: Value of any shape.
        unit: Unit of the values.
    """

    value: Any
    unit: str = ""
    tunable: ClassVar[tuple[str, ...]] = ("value",)

    def __post_init__(self) -> None:
        """Values are finite numbers."""
        numbers(self.name, "value", self.value)

    def ports(self, environment: Environment) -> Ports:
        """Output y."""
        return Ports((), (Port("y", np.shape(self.value), self.unit),))

    def compute(self, context: EvaluationContext) -> Values:
        """The value, a run-time parameter."""
        return {"y": context.parameters["value"]}


@dataclass(frozen=True, kw_only=True)
class Gain(Block):
    """y = gain u, where a matrix multiplies a vector and anything else goes entry by entry.

    Where the two units measure the same quantity, as deg and rad do, the conversion comes on top of the gain; where
    they don't, the gain is in units of the output per unit of the input.

    Attributes:
        gain: A number, one a component (n), or a matrix (m, n).
        unit_in: Unit of the input; "" takes any.
        unit_out: Unit of the output.
    """

    gain: Any = 1.0
    unit_in: str = ""
    unit_out: str = ""
    tunable: ClassVar[tuple[str, ...]] = ("gain",)

    def __post_init__(self) -> None:
        """Gains are numbers, vectors or matrices."""
        if numbers(self.name, "gain", self.gain).ndim > 2:
            raise refuse(
                self.name,
                "gain has the wrong shape",
                np.shape(self.gain),
                "a number, (n) or (m, n)",
                "give a matrix at most",
            )

    @property
    def conversion(self) -> float:
        """Factor that converts `unit_in` to `unit_out`; 1 if either is empty or their dimensions differ."""
        if not self.unit_in or not self.unit_out:
            return 1.0
        a, b = parse(self.unit_in), parse(self.unit_out)
        return a.scale / b.scale if a.powers == b.powers else 1.0

    def ports(self, environment: Environment) -> Ports:
        """Input u, output y."""
        gain, into = np.shape(self.gain), environment.inputs.get("u")
        if len(gain) == 2:
            into = (gain[1],)
        out = (gain[0],) if len(gain) == 2 else into
        if len(gain) == 1:
            into, out = (() if into == () else gain), gain
        return Ports((Port("u", into, self.unit_in),), (Port("y", out, self.unit_out),))

    def compute(self, context: EvaluationContext) -> Values:
        """The product."""
        gain, u = context.parameters["gain"], context.inputs["u"]
        product = gain @ u if len(gain.shape) == 2 else gain * u
        return {"y": product * self.conversion}


def _require_one_per_input(name: str, field: str, given: str, pair: str) -> None:
    """Refuse a text unless it has 1 to MAX_INPUTS characters, each one of the pair."""
    if not given or set(given) - {*pair} or len(given) > MAX_INPUTS:
        rule = f"1 to {MAX_INPUTS} {field} {pair[0]} or {pair[1]}, one an input"
        raise refuse(name, field, repr(given), rule, f'write for example "{pair}"')


@dataclass(frozen=True, kw_only=True)
class Sum(Block):
    """y = +-u1 +-u2 ..., entry by entry.

    Attributes:
        signs: One sign an input, such as "+-".
        unit: Unit of all signals; "" takes that of what is connected.
    """

    signs: str = "++"
    unit: str = ""

    def __post_init__(self) -> None:
        """Signs are plus and minus."""
        _require_one_per_input(self.name, "signs", self.signs, "+-")

    def ports(self, environment: Environment) -> Ports:
        """Inputs u1, u2, ..., output y, all of one shape."""
        names = [f"u{i + 1}" for i in range(len(self.signs))]
        shape, units = common_shape(environment, names), passed_units(environment, self.unit, names)
        ports = [with_units(Port(name, shape), units) for name in (*names, "y")]
        return Ports(tuple(ports[:-1]), (ports[-1],))

    def compute(self, context: EvaluationContext) -> Values:
        """The sum, left to right."""
        total = context.numbers(np.zeros(context.inputs["u1"].shape))
        for i, sign in enumerate(self.signs):
            value = context.inputs[f"u{i + 1}"]
            total = total + value if sign == "+" else total - value
        return {"y": total}


@dataclass(frozen=True, kw_only=True)
class Product(Block):
    """y = u1 u2 / u3 ..., entry by entry.

    Attributes:
        operations: "*" or "/" for each input.
    """

    operations: str = "**"

    def __post_init__(self) -> None:
        """Operations multiply or divide."""
        _require_one_per_input(self.name, "operations", self.operations, "*/")

    def ports(self, environment: Environment) -> Ports:
        """Inputs u1, u2, ..., output y, all of one shape."""
        names = [f"u{i + 1}" for i in range(len(self.operations))]
        shape = common_shape(environment, names)
        return Ports(tuple(Port(name, shape) for name in names), (Port("y", shape),))

    def compute(self, context: EvaluationContext) -> Values:
        """The product, left to right."""
        total = context.numbers(np.ones(context.inputs["u1"].shape))
        for i, operation in enumerate(self.operations):
            value = context.inputs[f"u{i + 1}"]
            total = total * value if operation == "*" else total / value
        return {"y": total}


@dataclass(frozen=True, kw_only=True)
class Pick(Block):
    """Some entries of a vector, by number or by the names of a model.

    Attributes:
        entries: One or several: numbers from 0 on, or names; "actuated" stands for a model's actuated joints, in the
            order of its inputs.
        model: Model whose names they are; "" where entries are numbers.
        of: Vector of the model that the input is: q, v (also a, tau) or u.
        unit: Unit of the entries; "" takes those of what is connected.
    """

    entries: Any
    model: str = ""
    of: str = "v"
    unit: str = ""

    def __post_init__(self) -> None:
        """Entries are numbers, or names of a model."""
        entries = self._wanted
        named = not isinstance(entries, (list, tuple)) or any(isinstance(item, str) for item in entries)
        if not isinstance(entries, (list, tuple)) or not entries or (named and not self.model):
            raise refuse(
                self.name,
                "entries",
                repr(self.entries),
                "numbers from 0 on, or names or 'actuated' with the model whose they are",
                "name the model, or give numbers",
            )
        if self.of not in ("q", "v", "u"):
            raise refuse(self.name, "unknown vector", repr(self.of), "of is q, v or u", "name one of them")

    @property
    def _wanted(self) -> Any:
        return [self.entries] if isinstance(self.entries, (str, int)) else self.entries

    def _indices(self, environment: Environment) -> tuple[list[int], int | None]:
        """Which entries, of how many."""
        if not self.model:
            return [whole(self.name, "an entry", item, 0, 10**6) for item in self._wanted], None
        record = environment.model(self.model)
        names = {"q": record.q_names, "v": record.v_names, "u": record.u_names}[self.of]
        if self.entries == "actuated":
            wanted: Any = actuated_names(record)
            if not wanted:
                raise refuse(
                    self.name,
                    "no actuated joints",
                    f"inputs {', '.join(record.u_names) or 'none'}",
                    f"joints of model '{self.model}' that are actuated have inputs of their names",
                    "name the entries",
                )
        else:
            wanted = self._wanted
        indices = []
        for item in wanted:
            named = isinstance(item, str)
            indices.append(
                names.index(known_name(self.name, f"entry of {self.of}", item, names))
                if named
                else whole(self.name, "an entry", item, 0, len(names) - 1)
            )
        return indices, len(names)

    def ports(self, environment: Environment) -> Ports:
        """Input u, a vector; output y (number of entries)."""
        indices, size = self._indices(environment)
        into = (size,) if size is not None else environment.inputs.get("u")
        if into == ():  # One number, as a vector of one.
            into = (1,)
        if into is not None and (len(into) != 1 or max(indices) >= into[0]):
            raise refuse(
                self.name,
                "no such entry",
                f"entry {max(indices)} of a signal {into}",
                "entries count from 0 along a vector",
                "choose smaller numbers",
            )
        units = self._units(environment)
        picked = [units[i] if len(units) > 1 else units[0] for i in indices]
        return Ports((with_units(Port("u", into), units),), (with_units(Port("y", (len(indices),)), picked),))

    def _units(self, environment: Environment) -> tuple[str, ...]:
        """Units of the input: the stated one, those that it has, or of a model's q and u those that they have."""
        units = passed_units(environment, self.unit, ["u"])
        if any(units) or not self.model or self.of == "v":
            return units
        return entry_units(environment.model(self.model), "q" if self.of == "q" else "u")

    def compute(self, context: EvaluationContext) -> Values:
        """The entries."""
        return {"y": context.inputs["u"][self._indices(context.environment)[0]]}


@dataclass(frozen=True, kw_only=True)
class Join(Block):
    """Scalars and vectors, one after the other, as one vector.

    Attributes:
        count: Number of inputs.
        unit: Unit of all signals; "" takes those of what is connected.
    """

    count: int = 2
    unit: str = ""

    def __post_init__(self) -> None:
        """A number of inputs."""
        whole(self.name, "count", self.count, 1, MAX_INPUTS)

    def ports(self, environment: Environment) -> Ports:
        """Inputs u1, u2, ..., output y."""
        names = [f"u{i + 1}" for i in range(self.count)]
        shapes = [environment.inputs.get(name) for name in names]
        sizes = [int(np.prod(shape)) for shape in shapes if shape is not None]
        out = (sum(sizes),) if len(sizes) == self.count else None
        units = [passed_units(environment, self.unit, [name]) for name in names]
        inputs = (with_units(Port(name, shape), own) for name, shape, own in zip(names, shapes, units, strict=True))
        counts = [(own * size)[:size] for own, size in zip(units, sizes, strict=False)]
        joint = [unit for own in counts for unit in own] if out is not None else [self.unit]
        return Ports(tuple(inputs), (with_units(Port("y", out), joint),))

    def compute(self, context: EvaluationContext) -> Values:
        """All entries, row by row."""
        return {"y": joined([context.inputs[f"u{i + 1}"] for i in range(self.count)])}


@dataclass(frozen=True, kw_only=True)
class Reshape(Block):
    """The same entries, row by row, in another shape: nine numbers as a matrix, say.

    Attributes:
        shape: Shape of the output; () for a scalar.
    """

    shape: Any = ()

    def __post_init__(self) -> None:
        """Sizes are whole numbers."""
        if not isinstance(self.shape, (list, tuple)):
            raise refuse(self.name, "shape", repr(self.shape), "a list of sizes", "write for example [3, 3]")
        for size in self.shape:
            whole(self.name, "shape", size, 1, 10**4)

    def ports(self, environment: Environment) -> Ports:
        """Input u, output y."""
        into, out = environment.inputs.get("u"), tuple(self.shape)
        if into is not None and np.prod(into) != np.prod(out):
            raise refuse(
                self.name,
                "sizes differ",
                into,
                f"{int(np.prod(out))} entries, as shape {out} has",
                "choose a shape of as many",
            )
        return Ports((Port("u", into),), (Port("y", out),))

    def compute(self, context: EvaluationContext) -> Values:
        """The entries of u, unchanged, in the new shape."""
        return {"y": context.inputs["u"].reshape(*self.shape)}
