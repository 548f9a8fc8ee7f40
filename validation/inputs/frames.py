"""Which frames of a model the frame quantities are compared at."""

from __future__ import annotations

from ..mechanics.assembly import BASE, Assembly

# Each frame is five generated functions; a handful at the tips of all branches exercises every joint.
MAX_FRAMES = 8


def chosen_frames(assembly: Assembly) -> tuple[str, ...]:
    """Frames that move, at most MAX_FRAMES, by a fixed rule: tips of branches first, then bodies that carry others.

    On each body it is the last described frame, which is the farthest out: extremity frames and what is fixed to a
    body come after the body. Where there are too many tips, they are taken at even distances.
    """
    last = {site.mover: name for name, site in assembly.frames.items() if site.mover != BASE}
    leaves = assembly.leaves()
    chosen = _spread(leaves, MAX_FRAMES)
    # The first parts of a joint of several coordinates bear no frames; bodies without mass only stand between joints.
    inner = [i for i in last if i not in leaves and assembly.movers[i].masses]
    chosen += _spread(inner, MAX_FRAMES - len(chosen))
    return tuple(last[i] for i in chosen)


def _spread(items: list[int], most: int) -> list[int]:
    """Evenly spaced items, at most `most`, from the last backwards."""
    if len(items) <= most:
        return items[::-1]
    return [items[-1 - (k * len(items)) // most] for k in range(most)]
