"""Plain calls: arrays of the expected kind go straight to the function, by C where the extension is there."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable, Mapping
from typing import Any, Protocol

import numpy as np

from symofros.runtime.calls.extension import UNIT_ROUNDING, call_type
from symofros.runtime.calls.kernel import Array, Kernel
from symofros.runtime.calls.library import CompiledKernel
from symofros.runtime.calls.sharing import LEAST

# Looked up once: each look-up costs a fiftieth of a call.
_ARRAY, _DOUBLE = np.ndarray, np.dtype(np.float64)


class PlainCall(Protocol):
    """A function from inputs by name, to which None stands for the default inputs, to outputs.

    The outputs are new arrays, or those of `out` by name. There are none, but None, unless all inputs are float64
    arrays of one state, or of batches of one length where the extension makes the call, the time a float, quaternions
    of unit length, and arrays of `out` fit and do not overlap.
    """

    def __call__(self, given: Mapping[str, Any], out: Mapping[str, Any] | None = None, /) -> list[Array] | None:
        """The outputs."""
        ...


def plain_call(
    kernel: Kernel,
    par: Array,
    u: Array,
    quaternions: Mapping[str, tuple[int, ...]],
    better: Callable[[], None],
    threads: int = 1,
) -> PlainCall:
    """A plain call, in memory of its own: for one thread.

    Args:
        kernel: The function.
        par: Run-time parameters (npar).
        u: Default inputs (nu).
        quaternions: First index of each quaternion, by the input that holds it.
        better: A method that is called, by any thread, when another call of this function would be a faster one.
        threads: Number of threads that share a large batch; a batch that they share is not evaluated here.
    """
    by_extension = call_type(better) if isinstance(kernel, CompiledKernel) else None
    if by_extension is None or not isinstance(kernel, CompiledKernel):
        return _through_numpy(kernel, par, u, quaternions)
    inputs = tuple(
        (group, -1 if group == "t" else size, u if group == "u" else None, quaternions.get(group, ()))
        for group, size in kernel.signature.inputs
    )
    most = sys.maxsize if threads == 1 else 2 * LEAST - 1
    functions = (kernel.address, kernel.batch_address, max(1, kernel.work), kernel.for_many, most)
    pre = np.ascontiguousarray(kernel.prepare(par[None]))
    call: PlainCall = by_extension(functions, inputs, kernel.signature.outputs, pre, kernel)
    return call


def _through_numpy(kernel: Kernel, par: Array, u: Array, quaternions: Mapping[str, tuple[int, ...]]) -> PlainCall:
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

    def call(
        given: Mapping[str, Any], out: Mapping[str, Any] | None = None, /, _kept: object = (kernel, pre)
    ) -> list[Array] | None:
        """Call the function (see PlainCall) at the addresses of all arrays, kept ones included."""
        if out is not None:
            return None
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


class PlainCalls(threading.local):
    """The calls that a thread has prepared, by function, or by (function, frame)."""

    def __init__(self) -> None:
        self.prepared: dict[str | tuple[str, str], PlainCall] = {}
