"""Generated C called as a C program calls it: one loop over many states, nothing allocated in between."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import symofros as sf

from ...mechanics.geometry import Array
from ..contestants.arrays import loops
from ..contestants.library import Library


class GeneratedLoop:
    """Functions of one model, each over the same states.

    Args:
        system: The description.
        functions: Names of functions of q, v, u and t.
        q: Coordinates (n, nq).
        v: Speeds (n, nv). Inputs and time are zero.
    """

    def __init__(self, system: sf.System, functions: Sequence[str], q: Array, v: Array) -> None:
        library = Library(*sf.compile_library(system, sf.Options(functions=tuple(functions), batch="loop")))
        self._states, self._library = len(q), library
        given = {"pre": library.pre, "q": q, "v": v}
        self._numbers = {name: k for k, name in enumerate(library.names)}
        self._arrays = {name: library.arrays(given, k) for name, k in self._numbers.items()}
        self._filled = {name: arrays.overwritten(len(q)) for name, arrays in self._arrays.items()}

    def run(self, functions: Iterable[str]) -> None:
        """Evaluate functions at every state, one after the other."""
        for name in functions:
            self._loop(name, self._filled[name])

    def results(self, name: str) -> Array:
        """All outputs of a function at every state (n, size)."""
        return self._arrays[name].results(lambda kept: self._loop(name, kept))

    def _loop(self, name: str, filled: object) -> None:
        function = self._library.model.functions + self._numbers[name]
        loops()[1].loop_batch(function, filled, 1, self._states)
