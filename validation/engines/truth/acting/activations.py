"""States of actuators in many digits: their rates, and what they are after a step."""

from __future__ import annotations

from decimal import Decimal

from ...interface import STEP, Activation, Actuator
from ..arithmetic import Exact, exact

_H = Decimal(STEP)


def clipped(value: Exact, limits: tuple[float, ...]) -> Exact:
    """A number within limits; without any, as it is."""
    low, high = exact(limits) if limits else (value, value)
    return min(max(value, low), high)


def rate(actuator: Actuator, activation: Activation) -> Exact:
    """The rate of an actuator's state."""
    control, state = clipped(exact(actuator.control)[()], actuator.control_limits), exact(activation.state)[()]
    if activation.kind == "integrator":
        return control
    if activation.kind != "muscle":
        return (control - state) / exact(activation.times[0])[()]
    control = clipped(control, (0.0, 1.0))
    grows, falls = exact(activation.times)
    slower = exact(0.5)[()] + exact(1.5)[()] * state
    return (control - state) / (grows * slower if control > state else falls / slower)


def after_step(actuator: Actuator, activation: Activation) -> Exact:
    """An actuator's state after a step."""
    state, moved = exact(activation.state)[()], _H * rate(actuator, activation)
    if activation.kind == "exact filter":
        time = exact(activation.times[0])[()]
        moved = rate(actuator, activation) * time * (1 - (-_H / time).exp())
    return clipped(state + moved, activation.limits)


def driving(actuator: Actuator) -> Exact:
    """What drives an actuator's force: its state, or where it has none, its control."""
    one = actuator.activation
    if one is None:
        return clipped(exact(actuator.control)[()], actuator.control_limits)
    return after_step(actuator, one) if one.is_early else exact(one.state)[()]
