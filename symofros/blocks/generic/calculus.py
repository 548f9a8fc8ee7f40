"""Integrator and derivative, continuous and sampled."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from symofros.blocks.checks import choice, number, numbers, refuse
from symofros.blocks.generic.nonlinear import ordered
from symofros.diagrams.block import Block, Crossing, Environment, EvaluationContext, Port, Ports, Values
from symofros.diagrams.tensor import Tensor

_DIRECTIONS = ("none", "rising", "falling", "both")


@dataclass(frozen=True, kw_only=True)
class Integrator(Block):
    """y' = u, y(0) = start; sampled, y[k + 1] = y[k] + T u[k]; entry by entry.

    At a limit it stands still as long as u pushes against it. A reset takes y back to its start: continuous, where the
    input "reset" crosses zero, located in time; sampled, at the first sample after.

    Attributes:
        start: First y, a number or one an entry, which also tells the shape inside loops.
        low: Lower limit.
        high: Upper limit.
        reset: Crossings of the input "reset" that count: none (no such input), rising, falling, both.
        unit_in: Unit of u.
        unit_out: Unit of y.
    """

    start: Any = 0.0
    low: float = -math.inf
    high: float = math.inf
    reset: str = "none"
    unit_in: str = ""
    unit_out: str = ""

    def __post_init__(self) -> None:
        """A start within limits in order."""
        numbers(self.name, "start", self.start)
        for field in ("low", "high"):
            if math.isnan(getattr(self, field)):
                raise refuse(self.name, f"{field} is no limit", "nan", "a number, or infinite for none", "leave it out")
        ordered(self, "low", "high")
        ordered(self, "low", "start")
        ordered(self, "start", "high")
        choice(self.name, "reset", self.reset, _DIRECTIONS)

    def ports(self, environment: Environment) -> Ports:
        """Inputs u, and reset (scalar) if asked for; output y."""
        shape = np.shape(self.start) or environment.inputs.get("u")
        inputs = (Port("u", shape, self.unit_in), *([Port("reset", ())] if self.reset != "none" else []))
        return Ports(inputs, (Port("y", shape, self.unit_out),))

    def _first(self, environment: Environment) -> Any:
        return np.broadcast_to(np.asarray(self.start, dtype=np.float64), environment.inputs["u"])

    def states(self, environment: Environment) -> dict[str, Any]:
        """Continuous: y."""
        return {"x": self._first(environment)} if self.period is None else {}

    def memory(self, environment: Environment) -> dict[str, Any]:
        """Sampled: y, and the reset signal at the sample before."""
        if self.period is None:
            return {}
        return {"x": self._first(environment)} | ({} if self.reset == "none" else {"before": 0.0})

    def _limited(self, x: Tensor) -> Tensor:
        x = x if self.low == -math.inf else x.apply("max", self.low)
        return x if self.high == math.inf else x.apply("min", self.high)

    def _now(self, context: EvaluationContext) -> Tensor:
        """The sampled integral at this instant: the stored value, or the start where the reset signal fires."""
        x = context.memory["x"]
        if self.reset == "none":
            return x
        before, now = context.memory["before"], context.inputs["reset"]
        rises, falls = _rises(before, now), _rises(-before, -now)
        hit = {"rising": rises, "falling": falls, "both": rises.apply("max", falls)}[self.reset]
        return x * (1.0 - hit) + hit * np.asarray(self.start, dtype=np.float64)

    def compute(self, context: EvaluationContext) -> Values:
        """The integral, within limits."""
        return {"y": self._limited(context.states["x"]) if self.period is None else self._now(context)}

    def rates(self, context: EvaluationContext) -> Values:
        """U, unless it pushes against a limit."""
        if self.period is not None:
            return {}
        x, rate = context.states["x"], context.inputs["u"]
        if self.high < math.inf:
            rate = rate * (1.0 - (x - self.high).apply("step") * rate.apply("step"))
        if self.low > -math.inf:
            rate = rate * (1.0 - (self.low - x).apply("step") * (-rate).apply("step"))
        return {"x": rate}

    def update(self, context: EvaluationContext) -> Values:
        """One sample's share further."""
        if self.period is None:
            return {}
        memory = {"x": self._limited(self._now(context) + float(self.period) * context.inputs["u"])}
        return memory if self.reset == "none" else {**memory, "before": context.inputs["reset"]}

    def crossings(self, context: EvaluationContext) -> dict[str, Crossing]:
        """Continuous: zeros of the reset signal."""
        if self.period is not None or self.reset == "none":
            return {}
        return {"reset": Crossing(context.inputs["reset"], self.reset)}  # type: ignore[arg-type]

    def crossed(self, context: EvaluationContext, which: str) -> Values:
        """Back to the start."""
        return {"x": context.states["x"] * 0.0 + np.asarray(self.start, dtype=np.float64)}


def _rises(before: Tensor, now: Tensor) -> Tensor:
    """1 where a signal was below zero and is not now."""
    return (1.0 - before.apply("step")) * now.apply("step")


@dataclass(frozen=True, kw_only=True)
class Derivative(Block):
    """y = s u / (tau s + 1); sampled, y[k] = a y[k - 1] + (1 - a) (u[k] - u[k - 1]) / T, a = exp(-T / tau).

    Attributes:
        tau: Time constant of the filter [s]; above zero, or zero for plain differences of samples.
        start: U before the start: its own first value keeps y from jumping.
        unit_in: Unit of u.
        unit_out: Unit of y.
    """

    tau: float = 0.01
    start: Any = 0.0
    unit_in: str = ""
    unit_out: str = ""

    def __post_init__(self) -> None:
        """A time constant."""
        number(self.name, "tau", self.tau, 0.0, exclusive=self.period is None)
        numbers(self.name, "start", self.start)

    def ports(self, environment: Environment) -> Ports:
        """Input u, output y."""
        shape = environment.inputs.get("u", np.shape(self.start) or None)
        return Ports((Port("u", shape, self.unit_in),), (Port("y", shape, self.unit_out),))

    def _first(self, environment: Environment) -> Any:
        return np.broadcast_to(np.asarray(self.start, dtype=np.float64), environment.inputs["u"])

    def states(self, environment: Environment) -> dict[str, Any]:
        """Continuous: u, late by the filter."""
        return {"x": self._first(environment)} if self.period is None else {}

    def memory(self, environment: Environment) -> dict[str, Any]:
        """Sampled: u and y of the sample before."""
        return {} if self.period is None else {"u": self._first(environment), "y": np.zeros(environment.inputs["u"])}

    def compute(self, context: EvaluationContext) -> Values:
        """Filtered time derivative of u."""
        if self.period is None:
            return {"y": (context.inputs["u"] - context.states["x"]) / self.tau}
        a = math.exp(-self.period / self.tau) if self.tau else 0.0
        return {"y": a * context.memory["y"] + (1.0 - a) * (context.inputs["u"] - context.memory["u"]) / self.period}

    def rates(self, context: EvaluationContext) -> Values:
        """Continuous: u is followed."""
        return {"x": (context.inputs["u"] - context.states["x"]) / self.tau} if self.period is None else {}

    def update(self, context: EvaluationContext) -> Values:
        """Sampled: u and y are kept."""
        return {} if self.period is None else {"u": context.inputs["u"], "y": self.compute(context)["y"]}
