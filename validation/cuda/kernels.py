"""Our kernels: what they take, how far their numbers are from C's, and how fast they and rollouts are."""

from __future__ import annotations

import ctypes
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from symofros.tools import (
    CudaModel,
    DeviceArray,
    Driver,
    KernelUsage,
    Precision,
    compile_cuda,
    states_per_second,
)

from ..mechanics.geometry import Array
from ..timing.race import error
from ..timing.task import flat
from .record import KernelRow, RolloutRow
from .states import STEP, STEPS, Subject

# Motions of a timed rollout, and repetitions of which the fastest counts.
MOTIONS, _REPEATS = 1 << 18, 3
PRECISIONS: tuple[Precision, ...] = ("double", "single")
METHODS = ("semi_implicit_euler", "rk4")
# Numbers that are copied to learn the memory's bandwidth, more than caches hold.
_COPIED, _COPIES = 1 << 27, 10
_COPY = """extern "C" __global__ void copy(long long n, const double *from, double *to) {
    long long k = (long long)blockIdx.x * blockDim.x + threadIdx.x;
    if (k < n) to[k] = from[k];
}"""


@dataclass(frozen=True)
class Kernel:
    """One function of one model, in one precision.

    Attributes:
        subject: Model and states.
        function: Name of the function.
        gpu: The model on the device.
    """

    subject: Subject
    function: str
    gpu: CudaModel

    @property
    def symbol(self) -> str:
        """Name of the kernel."""
        return self.gpu.code(self.function).kernels[0].symbol

    @property
    def title(self) -> str:
        """Human-readable title of the kernel, for progress messages."""
        fused = ", fused" if self.gpu.contract else ""
        return f"{self.subject.label}: {self.function}, {self.gpu.precision}{fused}"


def kernels_of(subject: Subject, functions: Sequence[str]) -> list[Kernel]:
    """All kernels of a model: each function in both precisions, with products and sums apart and fused."""
    models = [subject.model.cuda(precision, contract=fused) for fused in (False, True) for precision in PRECISIONS]
    return [Kernel(subject, function, gpu) for function in functions for gpu in models]


def usages(kernels: Sequence[Kernel], architecture: str, threads: int) -> Iterator[KernelUsage]:
    """Resource usage of each kernel, in order; kernels are compiled in parallel."""
    for kernel in kernels:  # The generator is not for threads; NVRTC is.
        kernel.gpu.code(kernel.function)

    def usage(kernel: Kernel) -> KernelUsage:
        return kernel.gpu.usage(kernel.function, architecture=architecture)[kernel.symbol]

    with ThreadPoolExecutor(threads) as pool:
        yield from pool.map(usage, kernels)


def row(kernel: Kernel, usage: KernelUsage, device: Driver | None) -> KernelRow:
    """A kernel beside C, timed where there is a graphics processor.

    Raises:
        SymofrosError: The device refuses it.
    """
    subject, function, gpu = kernel.subject, kernel.function, kernel.gpu
    rate = off = float("nan")
    if device is not None:
        results = gpu.evaluate(function, **subject.inputs(function))
        off = error(_flat(results, len(subject.q)), subject.expected(function))
        rate = states_per_second(gpu, function, "", device)
    moved = gpu.code(function).kernels[0].bytes_of_state(gpu.precision)
    return KernelRow(
        subject.label,
        function,
        gpu.precision,
        gpu.contract,
        usage.registers,
        usage.stack,
        usage.spill_stores + usage.spill_loads,
        moved,
        rate,
        off,
    )


def rollout_rows(subject: Subject, device: Driver) -> Iterator[RolloutRow]:
    """Motions of a model by both methods, in both precisions."""
    times = -(-MOTIONS // len(subject.q))
    for precision in PRECISIONS:
        gpu, dtype = subject.model.cuda(precision), np.dtype(np.float32 if precision == "single" else float)
        arrays = []
        for values in (subject.q, subject.v, subject.u):
            array = DeviceArray(device, (MOTIONS, values.shape[1]), dtype)
            array.write(np.tile(values, (times, 1))[:MOTIONS])
            arrays.append(array)
        for method in METHODS:
            q, v = gpu.rollout(subject.q, subject.v, subject.u, dt=STEP, steps=STEPS, method=method)
            off = error(q.numpy()[0].astype(float), subject.moved[method])
            best = np.inf
            for _ in range(_REPEATS):
                begun = time.perf_counter()
                gpu.rollout(*arrays, dt=STEP, steps=STEPS, method=method)
                best = min(best, time.perf_counter() - begun)
            yield RolloutRow(subject.label, "step", method, precision, MOTIONS * STEPS / best, off)


def copied(device: Driver) -> float:
    """Bandwidth of the memory, read and written, by a kernel that copies [B/s]."""
    arrays = [DeviceArray(device, (_COPIED,), np.float64) for _ in range(2)]
    arrays[0].write(np.ones(_COPIED))
    copy = device.function(device.load(compile_cuda(_COPY, device.architecture)), "copy")
    given = [ctypes.c_longlong(_COPIED), *(ctypes.c_void_p(array.address) for array in arrays)]
    best = np.inf
    for _ in range(_COPIES):
        begun = time.perf_counter()
        device.launch(copy, _COPIED, 256, given)
        device.wait()
        best = min(best, time.perf_counter() - begun)
    return 16.0 * _COPIED / float(best)


def _flat(results: dict[str, DeviceArray], states: int) -> Array:
    return flat(*(array.numpy().astype(float).reshape(states, -1) for array in results.values()))
