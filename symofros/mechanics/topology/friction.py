"""Conditions on the numbers of friction, on which its maximum rests (docs/theory/rigid.md, (56) to (58))."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from symofros.description.forces import Friction, Hysteresis, LuGre
from symofros.description.system import System
from symofros.description.values import Term, Value
from symofros.errors import Problem
from symofros.mechanics.topology.conditions import Condition
from symofros.mechanics.topology.numbers import Numbers

_POSITIVE = ("dynamic", "static", "stiffness", "stribeck_velocity")


def friction_conditions(system: System) -> Iterator[Condition]:
    """Speeds that smooth friction are positive."""
    for body in system.bodies:
        if body.joint is None:
            continue
        where = system.origin.get(("joint", body.joint.name), "")
        for element in body.joint.elements:
            what = f"joint '{body.joint.name}': {type(element).__name__.lower()}"
            if isinstance(element, Friction):
                yield from _conditions_of(element, what, where)
            elif isinstance(element, LuGre | Hysteresis):
                yield from _conditions_of_state(element, what, where)


def _conditions_of(friction: Friction, what: str, where: str) -> Iterator[Condition]:
    for label in ("minimum_velocity", "stribeck_velocity"):
        value = getattr(friction, label)
        if value is not None:
            yield Condition((value,), "positive", partial(_not_positive, f"{what} {label}", value, where))


def _conditions_of_state(element: LuGre | Hysteresis, what: str, where: str) -> Iterator[Condition]:
    """Levels and stiffnesses that the rate of a state divides by, or that make it return; states.md, (6), (10)."""
    labels = ("stiffness", "force") if isinstance(element, Hysteresis) else _POSITIVE
    for label in labels:
        value = getattr(element, label)
        if value is not None:
            yield Condition((value,), "positive", partial(_no_level, f"{what} {label}", value, "above zero", where))
    if isinstance(element, LuGre):
        for label in ("damping", "viscous"):
            value = getattr(element, label)
            problem = partial(_no_level, f"{what} {label}", value, "zero or more", where)
            yield Condition((value,), "not negative", problem)
        return
    sharpness = element.sharpness
    problem = partial(_no_level, f"{what} sharpness", sharpness, "1 or more", where)
    yield Condition(((Term(sharpness) - Term(1.0)).value,), "not negative", problem)


def _no_level(what: str, value: Value, allowed: str, where: str, numbers: Numbers) -> Problem:
    rule = f"it is {allowed}: the state's rate would have no bound, or no sign"
    return Problem(f"{what} {numbers.value(value):g}", f"'{value}'", rule, f"give a number that is {allowed}", where)


def _not_positive(what: str, value: Value, where: str, numbers: Numbers) -> Problem:
    return Problem(
        f"{what} {numbers.value(value):g}",
        f"'{value}'",
        "friction is smoothed, and falls, over a speed above zero",
        "give a speed that is small beside those of interest, such as 0.001",
        where,
    )
