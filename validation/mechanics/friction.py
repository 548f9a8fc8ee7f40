"""Friction as functions of models have it: smooth, also where runs hold joints by it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import symofros as sf

_NOTE = "friction that sticks is compared as the smooth friction that functions have"


def with_smooth_friction(system: sf.System) -> sf.System:
    """The system with friction that is smooth where it sticks in runs, and a note on that."""
    rubbing = [body for body in system.bodies if body.joint is not None and any(map(_sticks, body.joint.elements))]
    if not rubbing:
        return system
    return replace(system.with_bodies(*map(_smooth, rubbing)), notes=(*system.notes, _NOTE))


def _smooth(body: Any) -> Any:
    elements = tuple(replace(one, sticks=False) if _sticks(one) else one for one in body.joint.elements)
    return replace(body, joint=replace(body.joint, elements=elements))


def _sticks(element: object) -> bool:
    return isinstance(element, sf.Friction) and element.sticks
