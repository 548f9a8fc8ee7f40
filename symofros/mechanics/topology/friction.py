"""Conditions on the numbers of friction, on which its maximum rests (docs/theory/rigid.md, (56) to (58))."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from symofros.description.forces import Friction
from symofros.description.system import System
from symofros.description.values import Value
from symofros.errors import Problem
from symofros.mechanics.topology.conditions import Condition
from symofros.mechanics.topology.numbers import Numbers


def friction_conditions(system: System) -> Iterator[Condition]:
    """Speeds that smooth friction are positive."""
    for body in system.bodies:
        if body.joint is None:
            continue
        where = system.origin.get(("joint", body.joint.name), "")
        for element in body.joint.elements:
            if isinstance(element, Friction):
                yield from _conditions_of(element, f"joint '{body.joint.name}': friction", where)


def _conditions_of(friction: Friction, what: str, where: str) -> Iterator[Condition]:
    for label in ("minimum_velocity", "stribeck_velocity"):
        value = getattr(friction, label)
        if value is not None:
            yield Condition((value,), "positive", partial(_not_positive, f"{what} {label}", value, where))


def _not_positive(what: str, value: Value, where: str, numbers: Numbers) -> Problem:
    return Problem(
        f"{what} {numbers.value(value):g}",
        f"'{value}'",
        "friction is smoothed, and falls, over a speed above zero",
        "give a speed that is small beside those of interest, such as 0.001",
        where,
    )
