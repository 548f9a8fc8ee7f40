"""Plain calls for one state: arrays of the expected kind go through fixed memory, without a look at batches."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from typing import Any

import numpy as np

from symofros.runtime.calls.kernel import Array, Kernel

# Looked up once: each look-up costs a fiftieth of a call.
_ARRAY, _DOUBLE = np.ndarray, np.dtype(np.float64)


class SingleCall:
    """A function for one state, in memory of its own: for one thread.

    Args:
        kernel: The function.
        par: Run-time parameters (npar).
        u: Default inputs (nu).
    """

    __slots__ = ("_copies", "_evaluate", "_inputs", "_kept")

    def __init__(self, kernel: Kernel, par: Array, u: Array) -> None:
        signature = kernel.signature
        pre = kernel.prepare(par[None])
        read = [np.zeros(size) for _, size in signature.inputs]
        written = [np.zeros(shape) for _, shape in signature.outputs]
        self._evaluate = kernel.bind(pre, read, written)
        self._kept = kernel, pre  # C has the addresses of these and of all arrays.
        # A time is no array here: one would be a batch.
        self._inputs = [
            (group, memory, None if group == "t" else memory.shape, u if group == "u" else None)
            for (group, _), memory in zip(signature.inputs, read, strict=True)
        ]
        self._copies = [array.copy for array in written]

    def __call__(self, given: Mapping[str, Any]) -> list[Array] | None:
        """The outputs as new arrays; None unless all inputs are float64 arrays of one state, and the time a float.

        Args:
            given: Inputs by name; None for the default inputs.
        """
        for group, memory, shape, default in self._inputs:
            value = given[group]
            if value is None:
                value = default
            if type(value) is _ARRAY and value.shape == shape and value.dtype is _DOUBLE:
                memory[...] = value
            elif shape is None and type(value) is float:
                memory[0] = value
            else:
                return None
        self._evaluate()
        results = []
        for copy in self._copies:  # A comprehension would be a call of its own, and most functions have one output.
            results.append(copy())
        return results


class SingleCalls(threading.local):
    """The calls that a thread has prepared, by (function, frame)."""

    def __init__(self) -> None:
        self.prepared: dict[tuple[str, str], SingleCall] = {}
