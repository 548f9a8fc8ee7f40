"""Integrator and derivative, continuous and sampled."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from symofros.blocks.checks import choice, number, numbers, refuse
from symofros.blocks.generic.nonlinear import ordered
from symofros.diagrams.block import (
    LEAST_ABOVE_ZERO,
    Block,
    Crossing,
    Environment,
    EvaluationContext,
    Port,
    Ports,
    Values,
)
from symofros.diagrams.tensor import Tensor

_DIRECTIONS = ("none", "rising", "falling", "both")
# How far an integral comes from a limit until it has left it, of the size of limit and start.
_LEFT = 1e-9


class _Limit(NamedTuple):
    """A limit of an integral.

    Attributes:
        name: "high" or "low".
        value: Where it is.
        sign: Sign of rates that push against it.
        margin: How far from it an integral has left it.
    """

    name: str
    value: float
    sign: float
    margin: float

    def beyond(self, x: Any) -> Any:
        """How far x is beyond it."""
        return self.sign * (x - self.value)


@dataclass(frozen=True, kw_only=True)
class Integrator(Block):
    """y' = u, y(0) = start; sampled, y[k + 1] = y[k] + T u[k]; entry by entry.

    At a limit, which is located in time, it stands still as long as u pushes against it. A reset takes y back to its
    start where the input "reset" changes from zero or less to above zero (rising), or back (falling), as conditions of
    parts do: continuous, located in time; sampled, at the first sample after.

    Attributes:
        start: First y, a number or one an entry, which also tells the shape inside loops.
        low: Lower limit.
        high: Upper limit.
        reset: Changes of the input "reset" that count: none (no such input), rising, falling, both.
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
        """Sampled: y, and the reset signal at the sample before. Continuous: whether entries are at a limit."""
        if self.period is None:
            first = self._first(environment)
            return {name: np.asarray(one.beyond(first) >= 0.0, dtype=np.float64) for name, one in self._limits.items()}
        return {"x": self._first(environment)} | ({} if self.reset == "none" else {"before": 0.0})

    def _limited(self, x: Tensor) -> Tensor:
        for limit in self._limits.values():
            x = x.apply("min" if limit.sign > 0.0 else "max", limit.value)
        return x

    def _now(self, context: EvaluationContext) -> Tensor:
        """The sampled integral at this instant: the stored value, or the start where the reset signal fires."""
        x = context.memory["x"]
        if self.reset == "none":
            return x
        was, now = (1.0 - (-signal).apply("step") for signal in (context.memory["before"], context.inputs["reset"]))
        rises, falls = now * (1.0 - was), was * (1.0 - now)
        hit = {"rising": rises, "falling": falls, "both": rises + falls}[self.reset]
        return x * (1.0 - hit) + hit * np.asarray(self.start, dtype=np.float64)

    def compute(self, context: EvaluationContext) -> Values:
        """The integral, within limits."""
        return {"y": self._limited(context.states["x"]) if self.period is None else self._now(context)}

    def memory_at_start(self, context: EvaluationContext) -> Values:
        """Continuous: entries that begin at a limit."""
        return {} if self.period is not None else self._at_limits(context.states["x"])

    def rates(self, context: EvaluationContext) -> Values:
        """U, unless it pushes against a limit."""
        if self.period is not None:
            return {}
        rate = context.inputs["u"]
        for name, limit in self._limits.items():
            rate = rate * (1.0 - context.memory[name] * (limit.sign * rate).apply("step"))
        return {"x": rate}

    def update(self, context: EvaluationContext) -> Values:
        """Sampled: one sample's share further. What is kept in continuous time changes at crossings alone."""
        if self.period is None:
            return {name: context.memory[name] for name in self._limits}
        memory = {"x": self._limited(self._now(context) + float(self.period) * context.inputs["u"])}
        return memory if self.reset == "none" else {**memory, "before": context.inputs["reset"]}

    def crossings(self, context: EvaluationContext) -> dict[str, Crossing]:
        """Continuous: limits that entries reach and leave, and zeros of the reset signal."""
        if self.period is not None:
            return {}
        found = {}
        for name, (limit, entry, leaves) in self._of_entries(context).items():
            beyond = limit.beyond(context.states["x"][entry])
            # What still pushes has left nothing, though a step over the instant at which it ceases errs by the margin.
            held = context.memory[limit.name][entry]
            stays = (beyond + limit.margin).apply("max", limit.sign * context.inputs["u"][entry])
            left = Crossing(stays * held + held - 1.0, "falling")
            found[name] = left if leaves else Crossing(beyond, "rising")
        if self.reset != "none":
            found["reset"] = Crossing(context.inputs["reset"] - LEAST_ABOVE_ZERO, self.reset)  # type: ignore[arg-type]
        return found

    def crossed(self, context: EvaluationContext, which: str) -> Values:
        """Back to the start; at a limit, exactly, or as far from it as has left it."""
        x = context.states["x"]
        if which == "reset":
            first = x * 0.0 + np.asarray(self.start, dtype=np.float64)
            return {"x": first, **self._at_limits(first)}
        limit, entry, leaves = self._of_entries(context)[which]
        own = np.zeros(x.shape)
        own[entry] = 1.0
        at_limit = context.memory[limit.name] * (1.0 - own)
        at_limit = at_limit if leaves else at_limit + own
        place = limit.value - limit.sign * limit.margin * leaves
        return {limit.name: at_limit, "x": x * (1.0 - own) + place * own}

    @cached_property
    def _limits(self) -> dict[str, _Limit]:
        """The limits that there are, by name."""
        starts = np.asarray(self.start, dtype=np.float64)
        stated = (("high", self.high, 1.0), ("low", self.low, -1.0))
        return {
            name: _Limit(name, value, sign, _LEFT * (max(abs(value), float(np.abs(starts - value).max())) or 1.0))
            for name, value, sign in stated
            if math.isfinite(value)
        }

    def _at_limits(self, x: Tensor) -> Values:
        return {name: limit.beyond(x).apply("step") for name, limit in self._limits.items()}

    def _of_entries(self, context: EvaluationContext) -> dict[str, tuple[_Limit, tuple[int, ...], bool]]:
        """Name of a crossing -> limit, the entry that it is of, and whether the limit is left."""
        return {
            "_".join((*(["left"] if leaves else []), name, *map(str, entry))): (limit, entry, leaves)
            for name, limit in self._limits.items()
            for entry in np.ndindex(context.states["x"].shape)
            for leaves in (False, True)
        }


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
