"""Frames that a description names but does not have: what to say of them."""

from __future__ import annotations

from collections.abc import Iterable

from symofros.description.system import Body
from symofros.errors import did_you_mean

_SHOWN = 12


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
