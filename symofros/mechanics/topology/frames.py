"""Names of frames: what to say of those that a description lacks; and names made of stated ones, which must differ."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence

from symofros.description.system import Body, System
from symofros.errors import Problem, did_you_mean

_SHOWN = 12


def full_names(body: Body) -> list[tuple[str, str]]:
    """Own and full name, BODY.FRAME, of a body's frame and of the frames on it; a body's frame has the body's name."""
    return [(body.name, body.name), *((frame.name, f"{body.name}.{frame.name}") for frame in body.frames)]


def public_names(frames: Sequence[tuple[str, str]]) -> list[str]:
    """Names by which frames are asked for, each another: their own where nothing else is called so, or else the full.

    Args:
        frames: Own and full name of each; full names are unique.
    """
    count, full = Counter(own for own, _ in frames), {name for _, name in frames}
    return [own if own == name or (count[own] == 1 and own not in full) else name for own, name in frames]


def frames_of(body: Body) -> str:
    """The frames of a body, as a message lists them."""
    names = [frame.name for frame in body.frames]
    return f"frames of '{body.name}': {', '.join(names[:_SHOWN])}" if names else f"'{body.name}' has no frames"


def frame_remedy(bodies: Iterable[Body], body: Body, frame: str, entry: str) -> str:
    """Remedy for a frame that is not on a body.

    Args:
        bodies: All of them: one of the others may have the frame.
        body: The body that was named.
        frame: The frame that it does not have.
        entry: Key of the body's entry in the file, such as "parent: ".
    """
    owners = [other.name for other in bodies if frame in {item.name for item in other.frames}]
    if len(owners) == 1:
        return f"it is on body '{owners[0]}': write {entry}{owners[0]}"
    return did_you_mean(frame, [item.name for item in body.frames])


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
