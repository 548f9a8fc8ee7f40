"""Results at the states asked last: a check asks an engine for one quantity after the other at the same states."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, TypeVar

from ..mechanics.geometry import Array

T = TypeVar("T")

# A check alternates between its states and the same at rest; states with every term of beams are a third set.
KEPT = 3


class LatestResults(Generic[T]):
    """Results of one function of arrays at the arguments of its latest calls; they are not to be written to."""

    def __init__(self) -> None:
        self._results: dict[tuple[bytes, ...], T] = {}

    def get(self, arguments: tuple[Array, ...], compute: Callable[[], T]) -> T:
        """The result at some arguments, computed if it is not kept."""
        key = tuple(x.tobytes() for x in arguments)
        if key not in self._results:
            if len(self._results) == KEPT:
                del self._results[next(iter(self._results))]
            self._results[key] = compute()
        return self._results[key]
