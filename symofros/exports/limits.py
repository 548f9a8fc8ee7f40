"""Limits in exports: which joints and beams have, and what is said where a target has no place for them."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence

from symofros.description import Joint, Limits, System
from symofros.runtime.beams import ElasticBeam, ExactElasticBeam

# What limits bound, in the order of the description.
MEASURES = ("travel", "speed", "effort")


def measures(limits: Limits | None) -> tuple[str, ...]:
    """What the limits of a joint bound: of "travel", "speed", "effort". Zero is no limit of speed or effort."""
    if limits is None:
        return ()
    travel = limits.lower is not None or limits.upper is not None
    return tuple(
        measure
        for measure, stated in (("travel", travel), ("speed", limits.velocity), ("effort", limits.effort))
        if stated
    )


def joints_of(system: System) -> list[Joint]:
    """Joints of a system, in order."""
    return [body.joint for body in system.bodies if body.joint is not None]


def limits_note(joints: Iterable[Joint], kept: Callable[[Joint], Collection[str]] | None = None) -> tuple[str, ...]:
    """Notes on the limits that a target drops, one for each measure of them.

    Args:
        joints: Joints of the system.
        kept: What limits of a joint bound that the target has places for; nothing by default.
    """
    lost: dict[str, list[str]] = {measure: [] for measure in MEASURES}
    for joint in joints:
        written = kept(joint) if kept else ()
        for measure in measures(joint.limits):
            if measure not in written:
                lost[measure].append(joint.name)
    return tuple(f"limits of {measure} dropped: {listed(names)}" for measure, names in lost.items() if names)


def listed(names: list[str]) -> str:
    """Names of a note: the first ones, and how many more there are."""
    return ", ".join(names[:8]) + (f" and {len(names) - 8} more" if len(names) > 8 else "")


def beams_note(beams: Sequence[ElasticBeam]) -> tuple[str, ...]:
    """Notes on what programs do not judge of elastic beams: orders that leave stiffness out, sections of rods."""
    orders = {beam.name: f"'{beam.name}' ({beam.omitted.leaves_out})" for beam in beams if beam.omitted is not None}
    rods = [f"'{beam.name}'" for beam in beams if isinstance(beam, ExactElasticBeam)]
    rule = "programs do not judge how much that is in a motion: `simulate` of the same one says it"
    notes = [f"orders of beams leave out stiffness under loads: {listed([*orders.values()])}; {rule}"] if orders else []
    if rods:
        notes.append(
            f"programs do not judge how far rods bend between their sections: {listed(rods)}; `simulate` of the same"
            " motion says it"
        )
    return tuple(notes)


def events_note(system: System) -> tuple[str, ...]:
    """Note on the events of a description, for targets without steps that look for them."""
    return (f"events of the model are left out, and what they do: {listed([*system.events])}",) if system.events else ()
