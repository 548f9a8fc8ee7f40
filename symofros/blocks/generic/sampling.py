"""Between samples and continuous time: delays and holds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from symofros.blocks.checks import numbers, refuse
from symofros.blocks.quantities import passing
from symofros.diagrams.block import Block, Environment, EvaluationContext, Ports, Values


@dataclass(frozen=True, kw_only=True)
class UnitDelay(Block):
    """y[k] = u[k - 1], y[0] = start; it breaks algebraic loops.

    Attributes:
        start: First output; a number for all entries, or all of them, which also tells the shape inside loops.
        unit: Unit of input and output.
    """

    start: Any = 0.0
    unit: str = ""

    def __post_init__(self) -> None:
        """A start, and a sample time."""
        numbers(self.name, "start", self.start)
        needs_period(self)

    def ports(self, environment: Environment) -> Ports:
        """Input u, output y."""
        shape = np.shape(self.start) or environment.inputs.get("u")
        return passing(environment, shape, self.unit)

    def memory(self, environment: Environment) -> dict[str, Any]:
        """The input of the sample before."""
        return {"before": np.broadcast_to(np.asarray(self.start, dtype=np.float64), environment.inputs["u"])}

    def compute(self, context: EvaluationContext) -> Values:
        """The input at the previous sample."""
        return {"y": context.memory["before"]}

    def update(self, context: EvaluationContext) -> Values:
        """Keep the input."""
        return {"before": context.inputs["u"]}


@dataclass(frozen=True, kw_only=True)
class Hold(Block):
    """The input at the last sample: y(t) = u(t_k) for t_k <= t < t_k+1.

    Attributes:
        unit: Unit of input and output.
    """

    unit: str = ""

    def __post_init__(self) -> None:
        """It has a sample time."""
        needs_period(self)

    def ports(self, environment: Environment) -> Ports:
        """Input u, output y."""
        shape = environment.inputs.get("u")
        return passing(environment, shape, self.unit)

    def compute(self, context: EvaluationContext) -> Values:
        """The input."""
        return {"y": context.inputs["u"]}


def needs_period(block: Block) -> None:
    """Refuse a block that works at samples and has none.

    Raises:
        DescriptionError: Its period is None.
    """
    if block.period is None:
        raise refuse(block.name, "no sample time", "period None", "this block works at samples", "give a period [s]")
