"""Names of frames: those by which they are asked for, and what to say of those that a description does not have."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

from symofros.description.system import Body
from symofros.errors import did_you_mean

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
