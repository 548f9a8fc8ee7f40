"""Friction and contact as functions of models have them: smooth, and open, where runs choose modes."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import symofros as sf

_SMOOTH = "friction that sticks is compared as the smooth friction that functions have"
_OPEN = "rigid contacts are compared as open, as functions have them"


def without_modes(system: sf.System) -> sf.System:
    """The system with friction that is smooth where it sticks in runs, without rigid contacts, and notes on that."""
    rubbing = [body for body in system.bodies if body.joint is not None and any(map(_sticks, body.joint.elements))]
    if rubbing:
        system = replace(system.with_bodies(*map(_smooth, rubbing)), notes=(*system.notes, _SMOOTH))
    yielding = tuple(item for item in system.connections if not (isinstance(item, sf.Contact) and item.rigid))
    if len(yielding) < len(system.connections):
        system = replace(system, connections=yielding, notes=(*system.notes, _OPEN))
    return system


def _smooth(body: Any) -> Any:
    elements = tuple(replace(one, sticks=False) if _sticks(one) else one for one in body.joint.elements)
    return replace(body, joint=replace(body.joint, elements=elements))


def _sticks(element: object) -> bool:
    return isinstance(element, sf.Friction) and element.sticks
