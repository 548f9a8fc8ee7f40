"""The richer model: what a description's own truncation is judged by."""

from __future__ import annotations

from dataclasses import replace

from symofros.description import DIRECTIONS, Beam, System


def refined(system: System) -> System:
    """One function more in every direction that bends or twists, and rotary inertia wherever it is stated."""
    return system.with_bodies(*(_refined(body) for body in system.bodies if isinstance(body, Beam) and body.modes))


def _refined(beam: Beam) -> Beam:
    more = {"hermite": 2, "user": 0}.get(beam.family, 1)
    counts = {d: getattr(beam, d) + more for d in DIRECTIONS if getattr(beam, d)}
    stated = beam.rhoI_y != 0.0 or beam.rhoI_z != 0.0
    return replace(beam, rotary_inertia=beam.rotary_inertia or stated, **counts)
