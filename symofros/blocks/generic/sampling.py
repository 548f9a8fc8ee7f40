"""Between samples and continuous time: delays and holds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from symofros.blocks.checks import number, numbers, refuse
from symofros.blocks.quantities import passing
from symofros.diagrams.block import Block, Environment, EvaluationContext, Ports, Values
from symofros.diagrams.tensor import stacked

# Samples of a delay, which move on at each; share of one that is rounding.
MOST_KEPT = 1000
_ROUNDING = 1e-9


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
class TransportDelay(Block):
    """y(t) = u(t - delay), between samples of u by straight lines; before the start, u is `start`.

    Attributes:
        delay: Time by which the signal is late [s]; a delay of a period or more breaks algebraic loops.
        start: What comes out first; a number for all entries, or all of them, which also tells the shape inside loops.
        unit: Unit of input and output.
    """

    delay: float
    start: Any = 0.0
    unit: str = ""

    def __post_init__(self) -> None:
        """A delay, a start, and a sample time."""
        numbers(self.name, "start", self.start)
        number(self.name, "delay", self.delay, 0.0, exclusive=True)
        needs_period(self)
        if self._kept > MOST_KEPT:
            rule = f"at most {MOST_KEPT} samples are kept"
            raise refuse(self.name, "delay is too long", f"{self._kept} samples", rule, "sample less often")

    @property
    def _places(self) -> tuple[int, float]:
        """Whole samples, and the share of another."""
        samples = self.delay / (self.period or 1.0)
        whole = int(samples + _ROUNDING)
        share = samples - whole
        return whole, share if share > _ROUNDING else 0.0

    @property
    def _kept(self) -> int:
        whole, share = self._places
        return whole + (share > 0.0)

    def ports(self, environment: Environment) -> Ports:
        """Input u, output y."""
        shape = np.shape(self.start) or environment.inputs.get("u")
        return passing(environment, shape, self.unit)

    def memory(self, environment: Environment) -> dict[str, Any]:
        """The inputs of the samples before, the last one first."""
        start, shape = np.asarray(self.start, dtype=np.float64), environment.inputs["u"]
        return {"before": np.broadcast_to(start, (self._kept, *shape))}

    def compute(self, context: EvaluationContext) -> Values:
        """The input as it was."""
        (whole, share), before = self._places, context.memory["before"]
        later = context.inputs["u"] if whole == 0 else before[whole - 1]
        return {"y": later if share == 0.0 else (1.0 - share) * later + share * before[whole]}

    def update(self, context: EvaluationContext) -> Values:
        """Keep the input, and forget the oldest."""
        before = context.memory["before"]
        return {"before": stacked([context.inputs["u"], *(before[i] for i in range(self._kept - 1))])}


@dataclass(frozen=True, kw_only=True)
class Hold(Block):
    """The input at the last sample: y(t) = u(t_k) for t_k <= t < t_k+1.

    Attributes:
        unit: Unit of input and output.
    """

    unit: str = ""

    def __post_init__(self) -> None:
        """Require a sample time."""
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
