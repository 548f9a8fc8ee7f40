"""Static non-linearities, entry by entry: limits, dead zone, steps, switches, tables."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from symofros.base.arrays import Array
from symofros.blocks.checks import choice, increasing, numbers, refuse
from symofros.blocks.quantities import common_shape, passed_units, passing, with_units
from symofros.diagrams.block import Block, Environment, EvaluationContext, Port, Ports, Shape, Values
from symofros.diagrams.tensor import Tensor, joined

# Of a table, whose formula grows with its points.
MAX_POINTS = 1000


@dataclass(frozen=True, kw_only=True)
class _OneToOne(Block):
    """An input u and an output y of one shape; fields that are tunable are one number, or one an entry."""

    unit: str = ""

    def __post_init__(self) -> None:
        """The fields are numbers."""
        for field in self.tunable:
            numbers(self.name, field, getattr(self, field))

    def ports(self, environment: Environment) -> Ports:
        """Input u, output y."""
        shape: Shape | None = environment.inputs.get("u")
        for field in self.tunable:
            own = np.shape(getattr(self, field))
            if own and shape is not None and own != shape:
                raise refuse(
                    self.name,
                    f"{field} does not fit the input",
                    own,
                    f"one number, or shape {shape}",
                    "give one an entry",
                )
            shape = shape if shape is not None else own or None
        return passing(environment, shape, self.unit)


def ordered(block: Block, low: str, high: str) -> None:
    """Refuse bounds of which the lower is above the upper.

    Raises:
        DescriptionError: They cross.
    """
    a, b = getattr(block, low), getattr(block, high)
    if np.any(np.asarray(a) > np.asarray(b)):
        raise refuse(block.name, f"{low} is above {high}", f"{a} and {b}", f"{low} is at most {high}", "exchange them")


@dataclass(frozen=True, kw_only=True)
class _Bounded(_OneToOne):
    """Two bounds, in order."""

    low: Any = -1.0
    high: Any = 1.0
    tunable: ClassVar[tuple[str, ...]] = ("low", "high")

    def __post_init__(self) -> None:
        """Bounds in order."""
        super().__post_init__()
        ordered(self, "low", "high")


@dataclass(frozen=True, kw_only=True)
class Saturation(_Bounded):
    """y = u within bounds.

    Attributes:
        low: Least output.
        high: Greatest output.
        unit: Unit of input and output.
    """

    def compute(self, context: EvaluationContext) -> Values:
        """The nearest value within."""
        return {"y": context.inputs["u"].clipped(context.parameters["low"], context.parameters["high"])}


@dataclass(frozen=True, kw_only=True)
class DeadZone(_Bounded):
    """y = 0 between two bounds, beyond them u less the bound.

    Attributes:
        low: Lower end of the zone.
        high: Upper end.
        unit: Unit of input and output.
    """

    def compute(self, context: EvaluationContext) -> Values:
        """Signed excess of the input beyond the nearer bound of the dead zone; zero inside it."""
        u = context.inputs["u"]
        return {"y": u - u.clipped(context.parameters["low"], context.parameters["high"])}


@dataclass(frozen=True, kw_only=True)
class Quantizer(_OneToOne):
    """y = the nearest multiple of a step, as an encoder gives it: step floor(u / step + 1/2).

    Attributes:
        step: Distance of neighbouring values, above zero.
        unit: Unit of input and output.
    """

    step: Any = 1.0
    tunable: ClassVar[tuple[str, ...]] = ("step",)

    def __post_init__(self) -> None:
        """Steps are above zero."""
        super().__post_init__()
        if np.min(self.step) <= 0.0:
            raise refuse(self.name, "step", self.step, "a number above zero", "give another")

    def compute(self, context: EvaluationContext) -> Values:
        """The input rounded to the nearest multiple of `step`; halves are rounded up."""
        step = context.parameters["step"]
        return {"y": step * (context.inputs["u"] / step + 0.5).apply("floor")}


@dataclass(frozen=True, kw_only=True)
class Switch(Block):
    """y = u1 where by >= threshold, else u2.

    Attributes:
        threshold: Threshold of the input `by`, a scalar.
        unit: Unit of u1, u2 and y.
    """

    threshold: float = 0.5
    unit: str = ""
    tunable: ClassVar[tuple[str, ...]] = ("threshold",)

    def __post_init__(self) -> None:
        """The threshold is a number."""
        numbers(self.name, "threshold", self.threshold, ())

    def ports(self, environment: Environment) -> Ports:
        """Inputs u1, u2 of one shape, by (scalar); output y."""
        shape = common_shape(environment, ("u1", "u2"))
        units = passed_units(environment, self.unit, ("u1", "u2"))
        u1, u2, y = (with_units(Port(name, shape), units) for name in ("u1", "u2", "y"))
        return Ports((u1, u2, Port("by", ())), (y,))

    def compute(self, context: EvaluationContext) -> Values:
        """One of the two; both must be finite."""
        on = (context.inputs["by"] - context.parameters["threshold"]).apply("step")
        return {"y": on * context.inputs["u1"] + (1.0 - on) * context.inputs["u2"]}


@dataclass(frozen=True, kw_only=True)
class LookupTable(Block):
    """y(u) by straight lines between points: sum y[i] (a[i - 1] - a[i]), a[i] how far u is along interval i, 0 to 1.

    Attributes:
        x: Positions of the points (n), increasing.
        y: Values there (n), or vectors (n, m).
        outside: "hold" the first and last value, or "extend" the first and last line.
        unit_in: Unit of u.
        unit_out: Unit of y.
    """

    x: Any
    y: Any
    outside: str = "hold"
    unit_in: str = ""
    unit_out: str = ""

    def __post_init__(self) -> None:
        """Increasing points, as many values."""
        x, y = increasing(self.name, "x", self.x), numbers(self.name, "y", self.y)
        if y.ndim not in (1, 2) or len(y) != len(x) or y.size > MAX_POINTS:
            raise refuse(
                self.name,
                "y does not fit x",
                y.shape,
                f"({len(x)}) or ({len(x)}, any), {MAX_POINTS} numbers in all",
                "one row a point",
            )
        choice(self.name, "outside", self.outside, ("hold", "extend"))

    def ports(self, environment: Environment) -> Ports:
        """Input u, a scalar; output y."""
        return Ports((Port("u", (), self.unit_in),), (Port("y", np.shape(self.y)[1:], self.unit_out),))

    def compute(self, context: EvaluationContext) -> Values:
        """Piecewise linear interpolation: values at the points, each by its weight."""
        x, y = np.asarray(self.x, dtype=np.float64), np.asarray(self.y, dtype=np.float64)
        total = context.numbers(np.zeros(y.shape[1:]))
        for weight, value in zip(_weights(context, context.inputs["u"], x, self.outside), y, strict=True):
            total = total + weight * value
        return {"y": total}


def _weights(context: EvaluationContext, u: Tensor, x: Array, outside: str) -> list[Tensor]:
    """Weights of the points (n), of sum 1: zero but beside u, so that large values elsewhere cost no digits."""
    shares = [context.numbers(1.0)]
    for i in range(len(x) - 1):
        along = (u - float(x[i])) / float(x[i + 1] - x[i])
        if outside == "hold" or i > 0:
            along = along.apply("max", 0.0)
        if outside == "hold" or i < len(x) - 2:
            along = along.apply("min", 1.0)
        shares.append(along)
    return [*(before - after for before, after in zip(shares, shares[1:], strict=False)), shares[-1]]


@dataclass(frozen=True, kw_only=True)
class LookupTable2D(Block):
    """y(u1, u2), linear in each of both between the points of a grid.

    With weights a_i of the points along u1, as of a LookupTable, and b_k along u2, y = sum a_i y_ik b_k.

    Attributes:
        x1: Positions along u1 (n), increasing.
        x2: Positions along u2 (m), increasing.
        y: Values there (n, m).
        outside: "hold" the values at the edge, or "extend" the cells there.
        unit_in: Unit of u1 and u2.
        unit_out: Unit of y.
    """

    x1: Any
    x2: Any
    y: Any
    outside: str = "hold"
    unit_in: str = ""
    unit_out: str = ""

    def __post_init__(self) -> None:
        """Increasing points, a value for each of the grid's."""
        n, m = (len(increasing(self.name, field, getattr(self, field))) for field in ("x1", "x2"))
        if numbers(self.name, "y", self.y, (n, m)).size > MAX_POINTS:
            raise refuse(self.name, "too many points", (n, m), f"at most {MAX_POINTS}", "leave some out")
        choice(self.name, "outside", self.outside, ("hold", "extend"))

    def ports(self, environment: Environment) -> Ports:
        """Inputs u1, u2, scalars; output y."""
        inputs = (Port("u1", (), self.unit_in), Port("u2", (), self.unit_in))
        return Ports(inputs, (Port("y", (), self.unit_out),))

    def compute(self, context: EvaluationContext) -> Values:
        """Interpolation, linear in each input."""
        grid = [np.asarray(x, dtype=np.float64) for x in (self.x1, self.x2)]
        a, b = (
            joined(_weights(context, context.inputs[key], x, self.outside))
            for key, x in zip(("u1", "u2"), grid, strict=True)
        )
        return {"y": a @ (context.numbers(np.asarray(self.y, dtype=np.float64)) @ b)}
