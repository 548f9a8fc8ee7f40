"""What a kernel takes of a processor, what the bandwidth bounds it by, and what it reaches where there is one."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from symofros.errors import SymofrosError
from symofros.runtime.calls.kernel import Precision
from symofros.runtime.cuda.arrays import DeviceArray
from symofros.runtime.cuda.cuda_model import CudaModel
from symofros.runtime.cuda.driver import Driver, driver
from symofros.runtime.cuda.nvrtc import KernelUsage

# A timed batch: its states at most, their arrays at most [bytes], and different states.
_STATES, _MEMORY, _DIFFERENT = 1 << 21, 2e9, 1 << 10
# Batches started one behind the other, and repetitions of which the fastest counts.
_STARTED, _REPEATS = 10, 5


@dataclass(frozen=True)
class KernelFigures:
    """One kernel.

    Attributes:
        function: Name of the function, and its frame.
        precision: Precision of its numbers.
        usage: What it takes of each thread.
        bytes_of_state: Bytes that a state reads and writes.
        bound: States a second at which the memory is busy all the time.
        measured: States a second on this machine's processor; None without one.
    """

    function: str
    precision: Precision
    usage: KernelUsage
    bytes_of_state: int
    bound: float
    measured: float | None


def figures_of(model: CudaModel, name: str, frame: str, architecture: str, bandwidth: float) -> KernelFigures:
    """The figures of a function's kernel.

    Args:
        model: Model whose kernel it is.
        name: Name of the function.
        frame: Frame of a function of frames.
        architecture: Such as "sm_90".
        bandwidth: Bandwidth of the memory [B/s].

    Raises:
        SymofrosError: The function has no kernel, or there is no compiler.
    """
    kernel = model.code(name, frame).kernels[0]
    moved = kernel.bytes_of_state(model.precision)
    usage = model.usage(name, frame, architecture)[kernel.symbol]
    device = present()
    measured = None
    if device is not None and device.architecture == architecture:
        measured = states_per_second(model, name, frame, device)
    return KernelFigures(f"{name} {frame}".rstrip(), model.precision, usage, moved, bandwidth / moved, measured)


def present() -> Driver | None:
    """The processor of this machine; None without one."""
    try:
        return driver()
    except SymofrosError:
        return None


def states_per_second(model: CudaModel, name: str, frame: str, device: Driver) -> float:
    """The fastest of some repetitions on arrays that lie on the device, states side by side.

    Args:
        model: Model whose kernel it is.
        name: Name of the function.
        frame: Frame of a function of frames.
        device: This machine's processor.

    Raises:
        SymofrosError: The function has no kernel, there is no compiler, or the device's memory is full.
    """
    kernel, dtype = model.code(name, frame).kernels[0], np.dtype(np.float32 if model.precision == "single" else float)
    copies = max(1, int(min(_STATES, _MEMORY / kernel.bytes_of_state(model.precision))) // _DIFFERENT)
    states = copies * _DIFFERENT
    inputs: dict[str, Any] = {}
    rng = np.random.default_rng(0)
    for group, size in kernel.signature.inputs:
        if group != "t":
            inputs[group] = DeviceArray(device, (states, size), dtype)
            inputs[group].write(np.tile(rng.standard_normal((_DIFFERENT, size)), (copies, 1)))
    out = {label: DeviceArray(device, (states, *shape), dtype) for label, shape in kernel.signature.outputs}
    model.evaluate(name, frame, out=out, **inputs)
    best = np.inf
    for _ in range(_REPEATS):
        begun = time.perf_counter()
        for _ in range(_STARTED):
            model.evaluate(name, frame, out=out, wait=False, **inputs)
        device.wait()
        best = min(best, (time.perf_counter() - begun) / _STARTED)
    return states / best
