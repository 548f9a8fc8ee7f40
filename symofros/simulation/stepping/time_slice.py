"""How many steps C makes in one call, so that Ctrl-C and progress are seen to many times a second."""

from __future__ import annotations

import time
from collections.abc import Callable

# Seconds that one call should take at most.
_TARGET = 0.05
# From this share of the target on, a call is long enough.
_ENOUGH = 0.25
_FIRST, _MOST = 64, 1 << 20


class TimeSlice:
    """A number of steps per call that is adapted to about 0.05 s of computation.

    Attributes:
        steps: Steps of the next call.
    """

    def __init__(self) -> None:
        self.steps = _FIRST

    def measure(self, advance: Callable[[int], int], steps: int) -> int:
        """Call advance(steps), adapt `steps` of the next call to the time it took, and return the status."""
        before = time.perf_counter()
        status = advance(steps)
        seconds = time.perf_counter() - before
        if seconds > _TARGET:
            self.steps = max(1, self.steps // 2)
        elif seconds < _ENOUGH * _TARGET:
            self.steps = min(2 * self.steps, _MOST)
        return status
