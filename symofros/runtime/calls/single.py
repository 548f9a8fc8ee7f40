"""Plain calls for one state: arrays of the expected kind go straight to the function, without a look at batches.

The extension makes them. Where it is not there, not yet or at all, and for functions that NumPy interprets, a plain
call is a batch of one state: the same bits, in some ten times as long (`Model.bind` is as fast without the extension).
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from symofros.runtime.calls.extension import call_type
from symofros.runtime.calls.kernel import Array, Kernel
from symofros.runtime.calls.library import CompiledKernel

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
        return _left_to_batches
    inputs = tuple(
        (group, -1 if group == "t" else size, u if group == "u" else None, quaternions.get(group, ()))
        for group, size in kernel.signature.inputs
    )
    outputs = tuple(shape for _, shape in kernel.signature.outputs)
    call: SingleCall = by_extension(
        kernel.address, max(1, kernel.work), inputs, outputs, np.ascontiguousarray(kernel.prepare(par[None])), kernel
    )
    return call


def _left_to_batches(given: Mapping[str, Any]) -> None:
    """No call by the extension: there is none, or the function is interpreted."""


class SingleCalls(threading.local):
    """The calls that a thread has prepared, by function, or by (function, frame)."""

    def __init__(self) -> None:
        self.prepared: dict[str | tuple[str, str], SingleCall] = {}
