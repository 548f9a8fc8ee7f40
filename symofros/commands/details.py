"""What `symofros info` shows of a model beside its tree: masses, coordinates, limits, parameters, events, frames."""

from __future__ import annotations

import math
from typing import Any

from rich.table import Table

from symofros.description import Beam, event_text
from symofros.mechanics.topology import Numbers, SpanningTree, beam_mass

# Frames of a model that are named; the rest are counted.
_FRAMES = 20
# Limits of a coordinate: of where it is, and sizes, of its speed and effort.
_BOUNDS, _SIZES = ("lower", "upper"), ("velocity", "effort")


def details(tree: SpanningTree) -> dict[str, Any]:
    """The same as plain data, for JSON: numbers at the parameters' defaults; None where there is none."""
    system, numbers = tree.system, Numbers(tree.system)
    bodies = []
    for body in system.bodies:
        stated: dict[str, Any] = {
            "name": body.name,
            "kind": "beam" if isinstance(body, Beam) else "rigid",
            "mass": None,
        }
        inertia = body.inertia
        if isinstance(body, Beam):
            stated["mass"] = _finite(beam_mass(body, numbers))
        elif inertia is not None:
            stated["mass"] = _finite(numbers.value(inertia.mass))
            stated["center_of_mass"] = [_finite(x) for x in numbers.values(inertia.center_of_mass)]
        bodies.append(stated)
    limits = {body.joint.name: body.joint.limits for body in system.bodies if body.joint is not None}
    coordinates = []
    for name in tree.coordinates.q:
        bound = limits.get(name)
        # Zero is no limit of speed or effort, as in files that leave it open.
        sizes = {label: getattr(bound, label, None) or None for label in _SIZES}
        coordinates.append({"name": name, **{label: getattr(bound, label, None) for label in _BOUNDS}, **sizes})
    parameters = [
        {"name": item.name, "value": item.value, "unit": item.unit, "constant": item.constant}
        for item in system.parameters
    ]
    frames = [frame.name for frame in tree.frames]
    events = [{"name": name, "states": event_text(event)} for name, event in system.events.items()]
    return {"bodies": bodies, "coordinates": coordinates, "parameters": parameters, "events": events, "frames": frames}


def tables(facts: dict[str, Any]) -> list[Table]:
    """Tables for a terminal, without those that would be empty."""
    masses = Table("body", "mass [kg]", "center of mass [m]", title="Bodies")
    for body in facts["bodies"]:
        if body["mass"] is not None:
            center = ", ".join(map(_number, body.get("center_of_mass", ())))
            masses.add_row(body["name"], _number(body["mass"]), center or "(beam)")
    stated = [label for label in (*_BOUNDS, *_SIZES) if any(item[label] is not None for item in facts["coordinates"])]
    bounds = Table("coordinate", *stated, title="Limits [rad, m; N m, N]" if "effort" in stated else "Limits [rad, m]")
    for item in facts["coordinates"]:
        if any(item[label] is not None for label in stated):
            bounds.add_row(item["name"], *(_number(item[label]) for label in stated))
    parameters = Table("parameter", "value", "unit", "", title="Parameters")
    for item in facts["parameters"]:
        parameters.add_row(item["name"], _number(item["value"]), item["unit"], "constant" if item["constant"] else "")
    events = Table("event", "zero of ...; what happens", title="Events")
    for item in facts["events"]:
        events.add_row(item["name"], item["states"])
    return [table for table in (masses, bounds, parameters, events) if table.row_count]


def frames_line(facts: dict[str, Any]) -> str:
    """The first frames by name, and how many there are."""
    names = facts["frames"]
    rest = f", … ({len(names)} in all; --json lists them)" if len(names) > _FRAMES else ""
    return f"frames: {', '.join(names[:_FRAMES])}{rest}"


def _finite(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def _number(value: float | None) -> str:
    return "" if value is None else f"{value + 0.0:.6g}"
