"""Conditions on the numbers of contacts and friction, on which its maximum rests (docs/theory/rigid.md, (56)-(58))."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from symofros.description.forces import Friction, Hysteresis, LuGre
from symofros.description.system import System
from symofros.description.values import Term, Value
from symofros.errors import Problem
from symofros.mechanics.topology.conditions import Condition, Sign
from symofros.mechanics.topology.numbers import Numbers

_SIGNS: dict[str, tuple[Sign, str, str]] = {
    "stiffness": ("positive", "a surface pushes back", "give a stiffness above zero"),
    "radius": ("not negative", "a ball has a radius, or is a point", "give its radius, or zero"),
    "rim": ("positive", "a rim is a circle", "give a radius above zero, or leave it out"),
    "segment": ("positive", "a segment has two ends", "give its length, or leave it out"),
    "surface_radius": ("positive", "a curved surface has a radius", "give a radius above zero"),
    "length": ("not negative", "a capsule is a ball that is drawn out", "give the distance of its ends"),
    "dissipation": ("not negative", "contact takes energy, and never gives any", "give zero or more"),
    "friction": ("not negative", "friction is against the slip", "give zero or more"),
    "restitution": ("not negative", "an impact takes energy, and never gives any", "give a number from 0 to 1"),
    "bristle_stiffness": ("positive", "bristles are springs", "give a stiffness above zero"),
    "bristle_damping": ("positive", "bristles that are bent too far relax by their damping", "give one above zero"),
    "minimum_velocity": ("positive", "friction is smoothed over a speed above zero", "give a small one, such as 0.001"),
}


def contact_conditions(system: System) -> Iterator[Condition]:
    """Measures, stiffness and coefficients have their signs, and a ball fits into what encloses it."""
    for contact in system.contacts:
        where = system.origin.get(("connection", contact.name), "")
        for label, (sign, rule, remedy) in _SIGNS.items():
            value = getattr(contact, label)
            if value is not None:
                yield Condition((value,), sign, partial(_wrong, contact.name, label, value, rule, remedy, where))
        for value in contact.size or ():
            rule, remedy = "edges of a box are above zero", "give its three edges"
            yield Condition((value,), "positive", partial(_wrong, contact.name, "size", value, rule, remedy, where))
        if contact.rigid and contact.surface == "box":
            value, rule = contact.radius, "a point has no normal of a box at its edges, from which that of a ball turns"
            remedy = "round it by a radius above zero, or state a plane for each face"
            yield Condition((value,), "positive", partial(_wrong, contact.name, "radius", value, rule, remedy, where))
        if contact.restitution is not None:
            left, rule = (Term(1.0) - Term(contact.restitution)).value, "an impact takes energy, and never gives any"
            wrong = partial(_wrong, contact.name, "1 less restitution", left, rule, "give a number from 0 to 1", where)
            yield Condition((left,), "not negative", wrong)
        if contact.inside:
            room = (Term(contact.surface_radius or 0.0) - Term(contact.radius)).value
            rule, remedy = "a ball fits into what encloses it", "give a smaller ball, or a wider surface"
            wrong = partial(_wrong, contact.name, "room around the ball", room, rule, remedy, where)
            yield Condition((room,), "positive", wrong)


def _wrong(name: str, label: str, value: Value, rule: str, remedy: str, where: str, numbers: Numbers) -> Problem:
    return Problem(f"contact '{name}': {label} {numbers.value(value):g}", f"'{value}'", rule, remedy, where)


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
