"""Plain calls for one state: arrays of the expected kind go straight to the function, without a look at batches."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from symofros.runtime.calls.extension import UNIT_ROUNDING, call_type
from symofros.runtime.calls.kernel import Array, Kernel
from symofros.runtime.calls.library import CompiledKernel

# Looked up once: each look-up costs a fiftieth of a call.
_ARRAY, _DOUBLE = np.ndarray, np.dtype(np.float64)


# The outputs as new arrays; None unless all inputs are float64 arrays of one state, the time a float, and
# quaternions of unit length. The argument has the inputs by name; None for the default inputs.
SingleCall = Callable[[Mapping[str, Any]], list[Array] | None]


def single_call(
    kernel: Kernel, par: Array, u: Array, quaternions: Mapping[str, tuple[int, ...]], better: Callable[[], None]
) -> SingleCall:
    """A function for one state, in memory of its own: for one thread.

    Args:
        kernel: The function.
        par: Run-time parameters (npar).
        u: Default inputs (nu).
        quaternions: First index of each quaternion, by the input that holds it.
        better: A method that is called, by any thread, when another call of this function would be a faster one.
    """
    by_extension = call_type(better) if isinstance(kernel, CompiledKernel) else None
    if by_extension is None or not isinstance(kernel, CompiledKernel):
        return _through_numpy(kernel, par, u, quaternions)
    inputs = tuple(
        (group, -1 if group == "t" else size, u if group == "u" else None, quaternions.get(group, ()))
        for group, size in kernel.signature.inputs
    )
    outputs = tuple(shape for _, shape in kernel.signature.outputs)
    call: SingleCall = by_extension(
        kernel.address, max(1, kernel.work), inputs, outputs, np.ascontiguousarray(kernel.prepare(par[None])), kernel
    )
    return call


def _through_numpy(kernel: Kernel, par: Array, u: Array, quaternions: Mapping[str, tuple[int, ...]]) -> SingleCall:
    """A closure: its variables are reached, and itself is called, in half the time of an object's."""
    signature = kernel.signature
    pre = kernel.prepare(par[None])
    read = [np.zeros(size) for _, size in signature.inputs]
    written = [np.zeros(shape) for _, shape in signature.outputs]
    evaluate = kernel.bind(pre, read, written)
    # A time is no array here: one would be a batch.
    inputs = [
        (group, memory, None if group == "t" else memory.shape, u if group == "u" else None)
        for (group, _), memory in zip(signature.inputs, read, strict=True)
    ]
    first, *others = [array.copy for array in written]
    turned = [
        memory[at : at + 4]
        for (group, _), memory in zip(signature.inputs, read, strict=True)
        for at in quaternions.get(group, ())
    ]

    def call(given: Mapping[str, Any], _kept: object = (kernel, pre)) -> list[Array] | None:
        """As SingleCall says; C has the addresses of what is kept, and of all arrays."""
        for group, memory, shape, default in inputs:
            value = given[group]
            if value is None:
                value = default
            if type(value) is _ARRAY and value.shape == shape and value.dtype is _DOUBLE:
                memory[...] = value
            elif shape is None and type(value) is float:
                memory[0] = value
            else:
                return None
        for quaternion in turned:
            x, y, z, w = quaternion.tolist()
            if abs(x * x + y * y + z * z + w * w - 1.0) > UNIT_ROUNDING:
                return None
        evaluate()
        results = [first()]
        for copy in others:  # A comprehension would be a call of its own.
            results.append(copy())
        return results

    return call


class SingleCalls(threading.local):
    """The calls that a thread has prepared, by function, or by (function, frame)."""

    def __init__(self) -> None:
        self.prepared: dict[str | tuple[str, str], SingleCall] = {}
