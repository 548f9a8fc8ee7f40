"""Names that are made of stated ones: two of a kind that are the same would be taken for each other."""

from __future__ import annotations

from collections.abc import Iterator

from symofros.description.system import System
from symofros.errors import Problem
from symofros.mechanics.topology.frames import full_names

# What is named -> what states it, and the rule.
_RULES = {
    "frames": ("body", "bodies, and frames as BODY.FRAME, have different names"),
    "joints": ("joint", "joints, and sections of beams as BEAM.FRAME, have different names"),
    "conditions": ("constraint", "constraints, and their conditions as CONSTRAINT.x, have different names"),
    "balls": ("contact", "contacts, and their balls as CONTACT.0, have different names"),
}


def derived_name_problems(system: System) -> Iterator[Problem]:
    """Frames, sections of beams, conditions of constraints and balls of contacts with the name of another one."""
    for (what, (kind, rule)), names in zip(_RULES.items(), _names(system), strict=True):
        owners: dict[str, str] = {}
        for name, owner in names:
            # Two that are stated under one name are another problem.
            if owners.setdefault(name, owner) != owner:
                found = f"of '{owners[name]}' and '{owner}'"
                where = system.origin.get((kind, owner), "")
                yield Problem(f"two {what} called '{name}'", found, rule, "rename one of them", where)


def _names(system: System) -> Iterator[list[tuple[str, str]]]:
    """Names of each kind, with the name of what is stated."""
    yield [(name, body.name) for body in system.bodies for _, name in full_names(body)]
    joints = [(body.joint.name, body.joint.name) for body in system.bodies if body.joint is not None]
    for beam in system.beams:
        inner = [frame.name for frame in beam.frames if frame.station not in (0.0, 1.0)]
        joints += [(f"{beam.name}.{frame}", beam.name) for frame in ("tip", *inner) if beam.modes]
    yield joints
    yield [(name, item.name) for item in system.constraints for name in item.conditions]
    yield [(name, contact.name) for contact in system.contacts for name in contact.ball_names]
