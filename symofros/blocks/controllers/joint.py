"""Control of joints, each by itself: PD, and PID with limits."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from symofros.base.units import parse
from symofros.blocks.checks import number, numbers, refuse
from symofros.diagrams.block import Block, Environment, EvaluationContext, Port, Ports, Shape, Values
from symofros.diagrams.tensor import Tensor
from symofros.errors import DescriptionError


@dataclass(frozen=True, kw_only=True)
class JointPD(Block):
    """Efforts kp (q_d - q) + kd (v_d - v), entry by entry.

    Attributes:
        kp: Proportional gain of each joint, or one for all [N m/rad, N/m].
        kd: Derivative gain of each joint, or one for all [N m s/rad, N s/m].
    """

    kp: Any
    kd: Any
    tunable: ClassVar[tuple[str, ...]] = ("kp", "kd")

    def __post_init__(self) -> None:
        """Gains are numbers."""
        _gains(self)

    def ports(self, environment: Environment) -> Ports:
        """Desired motion, actual motion and effort, all of one size."""
        return _joint_ports(self, environment)

    def compute(self, context: EvaluationContext) -> Values:
        """Proportional and derivative terms."""
        error, rate = _errors(context)
        return {"effort": context.parameters["kp"] * error + context.parameters["kd"] * rate}


@dataclass(frozen=True, kw_only=True)
class JointPID(Block):
    """Efforts kp e + i + kd e' within limits, i' = ki e + (effort - unlimited) / tracking: back calculation.

    While a limit holds, the integral follows it, so that it does not wind up. Sampled, i[k + 1] = i[k] + T i'.

    Attributes:
        kp: Proportional gain of each joint, or one for all [N m/rad].
        ki: Integral gain of each joint, or one for all [N m/(rad s)].
        kd: Derivative gain of each joint, or one for all [N m s/rad].
        low: Least effort [N m].
        high: Greatest effort [N m].
        tracking: Time constant with which the integral follows a limit, at least the period [s].
    """

    kp: Any
    ki: Any
    kd: Any
    low: Any = -1e300
    high: Any = 1e300
    tracking: float = 0.1
    tunable: ClassVar[tuple[str, ...]] = ("kp", "ki", "kd", "low", "high")

    def __post_init__(self) -> None:
        """Gains are numbers, limits are in order."""
        _gains(self)
        number(self.name, "tracking", self.tracking, self.period or 0.0, math.inf, exclusive=self.period is None)
        if np.any(np.asarray(self.low) > np.asarray(self.high)):
            raise refuse(
                self.name, "low is above high", f"{self.low} and {self.high}", "limits in order", "exchange them"
            )

    def ports(self, environment: Environment) -> Ports:
        """Desired motion, actual motion and effort, all of one size."""
        return _joint_ports(self, environment)

    def _first(self, environment: Environment) -> dict[str, Any]:
        return {"i": np.zeros(environment.inputs["q"])}

    def states(self, environment: Environment) -> dict[str, Any]:
        """Continuous: the integral."""
        return self._first(environment) if self.period is None else {}

    def memory(self, environment: Environment) -> dict[str, Any]:
        """Sampled: the integral."""
        return {} if self.period is None else self._first(environment)

    def _terms(self, context: EvaluationContext) -> tuple[Tensor, Tensor]:
        """The effort, and the rate of the integral."""
        par, (error, rate) = context.parameters, _errors(context)
        i = context.states["i"] if self.period is None else context.memory["i"]
        wanted = par["kp"] * error + i + par["kd"] * rate
        effort = wanted.clipped(par["low"], par["high"])
        return effort, par["ki"] * error + (effort - wanted) / self.tracking

    def compute(self, context: EvaluationContext) -> Values:
        """Efforts of the controller, clipped to their limits."""
        return {"effort": self._terms(context)[0]}

    def rates(self, context: EvaluationContext) -> Values:
        """Continuous: of the integral."""
        return {"i": self._terms(context)[1]} if self.period is None else {}

    def update(self, context: EvaluationContext) -> Values:
        """Sampled: the integral, one period further."""
        return {} if self.period is None else {"i": context.memory["i"] + self.period * self._terms(context)[1]}


def _gains(block: Block) -> None:
    for field in block.tunable:
        if numbers(block.name, field, getattr(block, field)).ndim > 1:
            raise refuse(
                block.name,
                f"{field} has the wrong shape",
                np.shape(getattr(block, field)),
                "one number, or one a joint",
                "leave out what couples joints",
            )


def _joint_ports(block: Block, environment: Environment) -> Ports:
    size: Shape | None = environment.inputs.get("q", environment.inputs.get("q_desired"))
    for field in block.tunable:
        own = np.shape(getattr(block, field))
        if own == (1,) and size == ():
            size = own
        if own and size is not None and own != size:
            raise refuse(
                block.name, f"{field} does not fit the joints", own, f"one number, or shape {size}", "give one a joint"
            )
    position, effort = _units(environment)
    speed = position and f"{position}/s"
    inputs = (
        Port("q_desired", size, position),
        Port("v_desired", size, speed, 0.0),
        Port("q", size, position),
        Port("v", size, speed),
    )
    return Ports(inputs, (Port("effort", size, effort),))


def _units(environment: Environment) -> tuple[str, str]:
    """Units of the coordinates and of the efforts, by what is connected: joints turn or slide, all of a block alike.

    Units of different joints in one vector are left open. Where something is connected that is neither a motion of
    joints that turn nor of those that slide, they turn, and it is refused.
    """
    connected = {name: units for name, units in environment.units.items() if len(units) == 1}
    of_turn, of_slide, per_second = parse("rad"), parse("m"), parse("1/s")
    for quantity, effort in ((of_turn, "N m"), (of_slide, "N")):
        for name in ("q", "q_desired", "v", "v_desired"):
            for (unit,) in [connected[name]] if name in connected else []:
                powers = _powers(unit)
                if powers == quantity.powers and name.startswith("q"):
                    return unit, effort
                if powers in (quantity.powers, (quantity * per_second).powers):
                    return ("rad" if quantity is of_turn else "m"), effort
    if connected and len(connected) == len(environment.units):
        return "rad", "N m"
    return "", ""


def _powers(unit: str) -> tuple[int, ...]:
    try:
        return parse(unit).powers
    except DescriptionError:  # It is said where the unit is stated.
        return ()


def _errors(context: EvaluationContext) -> tuple[Tensor, Tensor]:
    inputs = context.inputs
    return inputs["q_desired"] - inputs["q"], inputs["v_desired"] - inputs["v"]
