"""Conditions on the numbers of contacts and of elements of joints: signs, on which what they do rests.

The maximum of friction rests on them (docs/theory/rigid.md, (56)-(58)). A force that may well have another sign, as
a spring's, is not judged here: `remarks.py`.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from symofros.description.forces import Friction, Hysteresis, LuGre, Stop
from symofros.description.system import System
from symofros.description.values import Term, Value
from symofros.errors import Problem
from symofros.mechanics.topology.conditions import Condition, Sign
from symofros.mechanics.topology.numbers import Numbers

# Of entries: the sign, the rule, the remedy.
_Signs = dict[str, tuple[Sign, str, str]]
_CONTACT: _Signs = {
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
        where, what = system.origin.get(("connection", contact.name), ""), f"contact '{contact.name}':"
        for label, (sign, rule, remedy) in _CONTACT.items():
            value = getattr(contact, label)
            if value is not None:
                yield Condition((value,), sign, partial(_wrong, f"{what} {label}", value, rule, remedy, where))
        for value in contact.size or ():
            rule, remedy = "edges of a box are above zero", "give its three edges"
            yield Condition((value,), "positive", partial(_wrong, f"{what} size", value, rule, remedy, where))
        if contact.rigid and contact.surface == "box":
            value, rule = contact.radius, "a point has no normal of a box at its edges, from which that of a ball turns"
            remedy = "round it by a radius above zero, or state a plane for each face"
            yield Condition((value,), "positive", partial(_wrong, f"{what} radius", value, rule, remedy, where))
        if contact.restitution is not None:
            left, rule = (Term(1.0) - Term(contact.restitution)).value, "an impact takes energy, and never gives any"
            wrong = partial(_wrong, f"{what} 1 less restitution", left, rule, "give a number from 0 to 1", where)
            yield Condition((left,), "not negative", wrong)
        if contact.inside:
            room = (Term(contact.surface_radius or 0.0) - Term(contact.radius)).value
            rule, remedy = "a ball fits into what encloses it", "give a smaller ball, or a wider surface"
            wrong = partial(_wrong, f"{what} room around the ball", room, rule, remedy, where)
            yield Condition((room,), "positive", wrong)


_SMALL: tuple[Sign, str, str] = (
    "positive",
    "friction is smoothed, and falls, over a speed above zero",
    "give a speed that is small beside those of interest, such as 0.001",
)
_RATE = "the state's rate would have no bound, or no sign"
_LEVEL: tuple[Sign, str, str] = "positive", f"it is above zero: {_RATE}", "give a number that is above zero"
_LOSS: tuple[Sign, str, str] = "not negative", f"it is zero or more: {_RATE}", "give a number that is zero or more"
_AGAINST: tuple[Sign, str, str] = "not negative", "friction is against the motion", "give zero or more"
_PUSHES: tuple[Sign, str, str] = "not negative", "a stop pushes back, and takes energy", "give zero or more"
_ELEMENTS: dict[type, _Signs] = {
    Friction: {"dynamic": _AGAINST, "static": _AGAINST, "minimum_velocity": _SMALL, "stribeck_velocity": _SMALL},
    Stop: {"stiffness": _PUSHES, "damping": _PUSHES},
    LuGre: dict.fromkeys(("dynamic", "static", "stiffness", "stribeck_velocity"), _LEVEL)
    | dict.fromkeys(("damping", "viscous"), _LOSS),
    Hysteresis: dict.fromkeys(("stiffness", "force"), _LEVEL),
}


def element_conditions(system: System) -> Iterator[Condition]:
    """Friction is against the motion, over speeds above zero; stops push back; states of forces return (states.md)."""
    for body in system.bodies:
        if body.joint is None:
            continue
        where = system.origin.get(("joint", body.joint.name), "")
        for element in body.joint.elements:
            what = f"joint '{body.joint.name}': {type(element).__name__.lower()}"
            for label, (sign, rule, remedy) in _ELEMENTS.get(type(element), {}).items():
                value = getattr(element, label)
                if value is not None:
                    yield Condition((value,), sign, partial(_wrong, f"{what} {label}", value, rule, remedy, where))
            if isinstance(element, Hysteresis):
                value, rule = element.sharpness, f"it is 1 or more: {_RATE}"
                wrong = partial(_wrong, f"{what} sharpness", value, rule, "give a number that is 1 or more", where)
                yield Condition(((Term(value) - Term(1.0)).value,), "not negative", wrong)
            if isinstance(element, Stop) and element.lower is not None and element.upper is not None:
                span, rule = (Term(element.upper) - Term(element.lower)).value, "lower <= upper"
                wrong = partial(_wrong, f"{what} upper minus lower limit", span, rule, "swap them", where)
                yield Condition((span,), "not negative", wrong)


def _wrong(what: str, value: Value, rule: str, remedy: str, where: str, numbers: Numbers) -> Problem:
    return Problem(f"{what} {numbers.value(value):g}", f"'{value}'", rule, remedy, where)
