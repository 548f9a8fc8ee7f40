"""Non-linearities with memory: relay, rate limit."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from symofros.blocks.checks import number, numbers, refuse
from symofros.blocks.generic.sampling import needs_period
from symofros.blocks.quantities import passing
from symofros.diagrams.block import Block, Crossing, Environment, EvaluationContext, Port, Ports, Values


@dataclass(frozen=True, kw_only=True)
class Relay(Block):
    """On from u >= upper until u <= lower: sampled, at samples; continuous, at the crossings, located in time.

    Attributes:
        lower: Level at which it switches off.
        upper: Level at which it switches on, above `lower`.
        on: Output while on.
        off: Output while off.
        starts_on: Whether it is on at first.
        unit: Unit of the output.
    """

    lower: float = 0.0
    upper: float = 1.0
    on: float = 1.0
    off: float = 0.0
    starts_on: bool = False
    unit: str = ""
    tunable: ClassVar[tuple[str, ...]] = ("lower", "upper", "on", "off")

    def __post_init__(self) -> None:
        """Numbers, with the thresholds apart."""
        for field in self.tunable:
            number(self.name, field, getattr(self, field))
        if not self.lower < self.upper:
            raise refuse(
                self.name,
                "no hysteresis",
                f"lower {self.lower}, upper {self.upper}",
                "lower is below upper",
                "use a Switch, or part them",
            )

    def ports(self, environment: Environment) -> Ports:
        """Input u, output y, scalars."""
        return Ports((Port("u", ()),), (Port("y", (), self.unit),))

    def memory(self, environment: Environment) -> dict[str, Any]:
        """Whether it is on."""
        return {"is_on": float(self.starts_on)}

    def _next(self, context: EvaluationContext) -> Any:
        u, par = context.inputs["u"], context.parameters
        comes_on, stays = (u - par["upper"]).apply("step"), 1.0 - (par["lower"] - u).apply("step")
        return comes_on.apply("max", stays * context.memory["is_on"])

    def memory_at_start(self, context: EvaluationContext) -> Values:
        """Continuous: on or off where the input is beyond a threshold from the start."""
        return {} if self.period is not None else {"is_on": self._next(context)}

    def compute(self, context: EvaluationContext) -> Values:
        """One of two values."""
        is_on = context.memory["is_on"] if self.period is None else self._next(context)
        return {"y": is_on * context.parameters["on"] + (1.0 - is_on) * context.parameters["off"]}

    def update(self, context: EvaluationContext) -> Values:
        """Switch at samples, if sampled; a continuous relay keeps its state here and switches at crossings."""
        return {"is_on": context.memory["is_on"] if self.period is None else self._next(context)}

    def crossings(self, context: EvaluationContext) -> dict[str, Crossing]:
        """Continuous: both thresholds."""
        if self.period is not None:
            return {}
        u = context.inputs["u"]
        return {
            "on": Crossing(u - context.parameters["upper"], "rising"),
            "off": Crossing(u - context.parameters["lower"], "falling"),
        }

    def crossed(self, context: EvaluationContext, which: str) -> Values:
        """Memory after a crossing: on or off, as `which` names it."""
        return {"is_on": context.numbers(float(which == "on"))}


@dataclass(frozen=True, kw_only=True)
class RateLimit(Block):
    """y follows u as fast as it may: y += clip(u - y, -falling T, rising T) at each sample; y = u at the first.

    Attributes:
        rising: Greatest rate, above zero [1/s].
        falling: Greatest rate downwards, above zero [1/s].
        unit: Unit of input and output.
    """

    rising: Any = 1.0
    falling: Any = 1.0
    unit: str = ""
    tunable: ClassVar[tuple[str, ...]] = ("rising", "falling")

    def __post_init__(self) -> None:
        """Rates above zero, and a sample time."""
        for field in self.tunable:
            if np.min(numbers(self.name, field, getattr(self, field))) <= 0.0:
                raise refuse(self.name, field, getattr(self, field), "a rate above zero", "give another")
        needs_period(self)

    def ports(self, environment: Environment) -> Ports:
        """Input u, output y."""
        shape = environment.inputs.get("u")
        return passing(environment, shape, self.unit)

    def memory(self, environment: Environment) -> dict[str, Any]:
        """The output before, and whether there was one."""
        return {"before": np.zeros(environment.inputs["u"]), "began": 0.0}

    def compute(self, context: EvaluationContext) -> Values:
        """The signal that follows u as closely as the rate limits allow; u itself at the first sample."""
        u, before, began = context.inputs["u"], context.memory["before"], context.memory["began"]
        T = float(self.period or 0.0)
        limited = before + (u - before).clipped(-T * context.parameters["falling"], T * context.parameters["rising"])
        return {"y": began * limited + (1.0 - began) * u}

    def update(self, context: EvaluationContext) -> Values:
        """Store the output, and that a first sample was taken."""
        return {"before": self.compute(context)["y"], "began": context.numbers(1.0)}
