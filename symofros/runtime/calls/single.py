"""Plain calls for one state: arrays of the expected kind go through fixed memory, without a look at batches."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from typing import Any

import numpy as np

from symofros.runtime.calls.bound import bind
from symofros.runtime.calls.kernel import Array, Kernel

_DOUBLE = np.dtype(np.float64)
_TIME = (1,)


class SingleCall:
    """A function for one state, in memory of its own: for one thread.

    Args:
        kernel: The function.
        par: Run-time parameters (npar).
        u: Default inputs (nu).
    """

    __slots__ = ("_bound", "_inputs", "_outputs")

    def __init__(self, kernel: Kernel, par: Array, u: Array) -> None:
        self._bound = bind(kernel, par, {}, {})
        self._inputs = [
            (group, array, _TIME if group == "t" else array.shape, u if group == "u" else None)
            for group, array in self._bound.inputs.items()
        ]
        self._outputs = list(self._bound.outputs.values())

    def __call__(self, given: Mapping[str, Any]) -> list[Array] | None:
        """The outputs as new arrays; None unless all inputs are float64 arrays of one state, and the time a float.

        Args:
            given: Inputs by name; None for the default inputs.
        """
        for group, memory, shape, default in self._inputs:
            value = given[group]
            if value is None:
                value = default
            if type(value) is np.ndarray:
                # A time is no array here: one would be a batch.
                if shape is _TIME or value.dtype is not _DOUBLE or value.shape != shape:
                    return None
                memory[...] = value
            elif shape is _TIME and type(value) is float:
                memory[0] = value
            else:
                return None
        self._bound()
        return [array.copy() for array in self._outputs]


class SingleCalls(threading.local):
    """The calls that a thread has prepared, by (function, frame)."""

    def __init__(self) -> None:
        self.prepared: dict[tuple[str, str], SingleCall] = {}
