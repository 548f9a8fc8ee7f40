"""Variants of a description that blocks ask for: rigid, and with friction as its only force."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from symofros.description import STRAINS, Beam, Body, Friction, System

# A model's name and this name its variant in which friction is the only force.
FRICTION = "(friction)"


def with_functions(system: System, count: int) -> System:
    """The same mechanism with so many shape functions in each direction that its beams have any in.

    With none it is the equivalent rigid robot of the paper's section 8: the control model.
    """
    return system.with_bodies(*(_counted(body, count) for body in system.bodies if isinstance(body, Beam)))


def _counted(beam: Beam, count: int) -> Beam:
    counts: dict[str, Any] = {name: count if getattr(beam, name) else 0 for name in STRAINS}
    return replace(beam, **counts)


def friction_only(system: System) -> System:
    """The same mechanism without any force but the friction of its joints; strain of beams remains."""
    stripped = system.with_bodies(*map(_with_friction_only, system.bodies))
    return replace(stripped, connections=(), virtual_power=(), potentials=())


def _with_friction_only(body: Body) -> Body:
    changes: dict[str, object] = {"loads": ()} if getattr(body, "loads", ()) else {}
    if body.joint is not None:
        kept = tuple(element for element in body.joint.elements if isinstance(element, Friction))
        changes["joint"] = replace(body.joint, elements=kept, effort=())
    return replace(body, **changes)  # type: ignore[arg-type]
