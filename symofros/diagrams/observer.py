"""Looking at a run while it goes on: records as they are made, and stops by time."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Protocol

from symofros.base.arrays import Array


class Observer(Protocol):
    """Receiver of the records of a run, which may stop it by time."""

    @property
    def signals(self) -> Sequence[str]:
        """Outputs that are recorded for it, as "block.port"."""
        ...

    def stop(self) -> float:
        """Time [s]: `see` is called at the first instant that is not before it; infinity for none."""
        ...

    def see(self, t: float, times: Array, values: Mapping[str, Array]) -> None:
        """Receive the records since the last call; the run waits until it returns.

        Args:
            t: Time that the run has reached [s].
            times: Times of the records (n) [s].
            values: Signal -> its values (n, *shape).

        Raises:
            KeyboardInterrupt: The run shall end here, with what it has.
        """
        ...


class NoObserver:
    """Nobody looks."""

    signals: Sequence[str] = ()

    def stop(self) -> float:
        """Time of the next stop: infinity, for none."""
        return math.inf

    def see(self, t: float, times: Array, values: Mapping[str, Array]) -> None:
        """Ignore the records."""
