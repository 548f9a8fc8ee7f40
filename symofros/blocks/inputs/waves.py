"""Test signals: step, ramp, pulse, sine, chirp. All numbers broadcast: one signal, or one an entry."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from symofros.base.units import parse
from symofros.blocks.checks import choice, number, numbers, refuse
from symofros.diagrams.block import Block, Environment, EvaluationContext, Port, Ports, Shape, Values
from symofros.diagrams.tensor import Tensor


def _rates(unit: str) -> tuple[str, str, str]:
    return (unit, f"{unit}/s", f"{unit}/s^2") if unit else ("", "", "")


# Share of times by which a flank comes early: more than all roundings of an instant and of the time stated for it.
_ROUNDING = 2.0**-50


def _since(context: EvaluationContext, time: Tensor) -> Tensor:
    """Time since one that is stated; not below zero, by rounding, at a sample that falls on it."""
    return (context.t - time) + _ROUNDING * (context.t.apply("abs") + time.apply("abs"))


@dataclass(frozen=True, kw_only=True)
class _Wave(Block):
    """Base class of the wave blocks: parameters that broadcast, a unit and the output y."""

    unit: str = ""

    def __post_init__(self) -> None:
        """Numbers that broadcast, a unit that exists."""
        _ = self.shape
        parse(self.unit)

    @property
    def shape(self) -> Shape:
        """Shape of the signal: that to which all tunable parameters broadcast."""
        arrays = [numbers(self.name, field, getattr(self, field)) for field in self.tunable]
        try:
            return np.broadcast_shapes(*(array.shape for array in arrays))
        except ValueError:
            raise refuse(
                self.name,
                "shapes differ",
                ", ".join(str(array.shape) for array in arrays),
                f"{', '.join(self.tunable)} broadcast to one shape",
                "give as many of each",
            ) from None

    def ports(self, environment: Environment) -> Ports:
        """Output y."""
        return Ports((), (Port("y", self.shape, self.unit),))

    def _whole(self, context: EvaluationContext, value: Tensor) -> Tensor:
        return value + np.zeros(self.shape)


@dataclass(frozen=True, kw_only=True)
class Step(_Wave):
    """y = before, and after from some time on.

    Attributes:
        time: Time when it steps [s].
        before: Value before.
        after: Value from then on.
        unit: Unit of the signal.
    """

    time: Any = 1.0
    before: Any = 0.0
    after: Any = 1.0
    tunable: ClassVar[tuple[str, ...]] = ("time", "before", "after")

    def compute(self, context: EvaluationContext) -> Values:
        """One or the other."""
        time, before, after = (context.parameters[key] for key in self.tunable)
        on = _since(context, time).apply("step")
        return {"y": self._whole(context, before * (1.0 - on) + after * on)}


@dataclass(frozen=True, kw_only=True)
class Ramp(_Wave):
    """y = start, from some time on start + slope (t - time), until it has risen for a duration.

    Attributes:
        time: Time when it begins to rise [s].
        slope: Rate [1/s].
        start: First value.
        duration: Time that it rises [s].
        unit: Unit of the signal.
    """

    time: Any = 0.0
    slope: Any = 1.0
    start: Any = 0.0
    duration: Any = 1e9
    tunable: ClassVar[tuple[str, ...]] = ("time", "slope", "start", "duration")

    def ports(self, environment: Environment) -> Ports:
        """Output y, and its rate."""
        y, rate, _ = _rates(self.unit)
        return Ports((), (Port("y", self.shape, y), Port("rate", self.shape, rate)))

    def compute(self, context: EvaluationContext) -> Values:
        """Value and rate of the ramp; the rate is zero before `time` and after `duration`."""
        time, slope, start, duration = (context.parameters[key] for key in self.tunable)
        since = _since(context, time)
        rises = since.apply("step") * (1.0 - (since - duration).apply("step"))
        risen = (context.t - time).apply("max", 0.0).apply("min", duration)
        return {"y": self._whole(context, start + slope * risen), "rate": self._whole(context, slope * rises)}


@dataclass(frozen=True, kw_only=True)
class Pulse(_Wave):
    """A square wave: high for a part of every interval, low otherwise, low before it starts.

    Attributes:
        time: Time when it starts [s].
        every: Seconds from pulse to pulse.
        width: Part of the interval that is high, 0 to 1.
        high: Value during pulses.
        low: Value otherwise.
        unit: Unit of the signal.
    """

    time: Any = 0.0
    every: Any = 1.0
    width: Any = 0.5
    high: Any = 1.0
    low: Any = 0.0
    tunable: ClassVar[tuple[str, ...]] = ("time", "every", "width", "high", "low")

    def __post_init__(self) -> None:
        """Intervals are above zero, of which pulses are a part."""
        super().__post_init__()
        if np.min(self.every) <= 0.0:
            raise refuse(self.name, "every", self.every, "seconds above zero", "give another")
        if np.min(self.width) < 0.0 or np.max(self.width) > 1.0:
            rule = "width is the part of an interval that is high, 0 to 1"
            raise refuse(self.name, "width", self.width, rule, "divide seconds by `every`")

    def compute(self, context: EvaluationContext) -> Values:
        """High or low level, by the position within the current period; low before `time`."""
        time, every, width, high, low = (context.parameters[key] for key in self.tunable)
        turns = _since(context, time) / every
        place = turns - turns.apply("floor")
        on = turns.apply("step") * (1.0 - (place - width).apply("step"))
        return {"y": self._whole(context, low + (high - low) * on)}


@dataclass(frozen=True, kw_only=True)
class Sine(_Wave):
    """y = mean + amplitude sin(2 pi f t + phase), with its rates: an excitation, or a trajectory.

    Attributes:
        amplitude: Amplitude.
        frequency: f [Hz].
        phase: Phase [rad].
        mean: Mean of the signal.
        unit: Unit of the signal.
    """

    amplitude: Any = 1.0
    frequency: Any = 1.0
    phase: Any = 0.0
    mean: Any = 0.0
    tunable: ClassVar[tuple[str, ...]] = ("amplitude", "frequency", "phase", "mean")

    def ports(self, environment: Environment) -> Ports:
        """Outputs y, rate, acceleration."""
        units = zip(("y", "rate", "acceleration"), _rates(self.unit), strict=True)
        return Ports((), tuple(Port(name, self.shape, unit) for name, unit in units))

    def compute(self, context: EvaluationContext) -> Values:
        """The sine and its derivatives."""
        amplitude, frequency, phase, mean = (context.parameters[key] for key in self.tunable)
        w = 2.0 * math.pi * frequency
        angle = w * context.t + phase
        s, c = amplitude * angle.apply("sin"), amplitude * angle.apply("cos")
        signals = {"y": mean + s, "rate": w * c, "acceleration": -(w * w * s)}
        return {name: self._whole(context, value) for name, value in signals.items()}


@dataclass(frozen=True, kw_only=True)
class Chirp(_Wave):
    """A sine whose frequency goes from one to another, and stays: y = amplitude sin(phi), phi' = 2 pi f(t).

    Attributes:
        amplitude: Amplitude.
        first: Frequency at the start [Hz].
        last: Frequency after the duration [Hz].
        duration: Time that it changes [s].
        sweep: "linear" f over time, or "exponential".
        unit: Unit of the signal.
    """

    amplitude: Any = 1.0
    first: float = 0.1
    last: float = 10.0
    duration: float = 10.0
    sweep: str = "linear"
    tunable: ClassVar[tuple[str, ...]] = ("amplitude",)

    def __post_init__(self) -> None:
        """Frequencies and a duration above zero."""
        super().__post_init__()
        for field in ("first", "last", "duration"):
            number(self.name, field, getattr(self, field), 0.0, exclusive=True)
        choice(self.name, "sweep", self.sweep, ("linear", "exponential"))

    def ports(self, environment: Environment) -> Ports:
        """Outputs y, and frequency [Hz]."""
        return Ports((), (Port("y", self.shape, self.unit), Port("frequency", (), "Hz")))

    def compute(self, context: EvaluationContext) -> Values:
        """The integral of the frequency, then its sine."""
        T, first, last = float(self.duration), float(self.first), float(self.last)
        t = context.t.clipped(0.0, T)
        after, before = (context.t - T).apply("max", 0.0), context.t.apply("min", 0.0)
        if self.sweep == "linear":
            k = (last - first) / T
            frequency, turns = first + k * t, t * (first + 0.5 * k * t)
        else:
            k = math.log(last / first) / T
            grown = (k * t).apply("exp")
            frequency = first * grown
            turns = (grown - 1.0) * (first / k) if k else first * t
        turns = turns + last * after + first * before
        y = context.parameters["amplitude"] * (2.0 * math.pi * turns).apply("sin")
        return {"y": self._whole(context, y), "frequency": frequency}
