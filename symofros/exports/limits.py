"""Limits of joints in exports: which are stated, and what is said where a target has no place for them."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable

from symofros.description import Joint, Limits, System

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


def events_note(system: System) -> tuple[str, ...]:
    """Note on the events of a description, for targets without steps that look for them."""
    return (f"events of the model are left out, and what they do: {listed([*system.events])}",) if system.events else ()
