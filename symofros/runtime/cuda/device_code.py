"""Kernels as text: what the generator hands to the run time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import prod

from symofros.runtime.calls.kernel import Array, Precision, Signature

# Threads of a block at most: kernels of many registers fill a processor by small blocks.
BLOCK = 128


@dataclass(frozen=True)
class DeviceKernel:
    """One function of a model as a kernel.

    Attributes:
        symbol: Name of the kernel.
        signature: Inputs and outputs, in the order of the kernel's arguments after n and `pre`.
    """

    symbol: str
    signature: Signature

    def bytes_of_state(self, precision: Precision) -> int:
        """Bytes read and written per state if no input is shared between states: the load on memory bandwidth."""
        numbers = sum(size for _, size in self.signature.inputs)
        numbers += sum(prod(shape) for _, shape in self.signature.outputs)
        return numbers * (4 if precision == "single" else 8)


@dataclass(frozen=True)
class DeviceCode:
    """The kernels of some functions of a model, in one text.

    Attributes:
        text: CUDA C++ that needs no header.
        precision: Precision of its numbers.
        kernels: Kernels of functions.
        rollouts: Stepping method -> name of its kernel.
        prepare: Sets of parameters (m, npar) -> what kernels read of them (m, npre).
    """

    text: str
    precision: Precision
    kernels: tuple[DeviceKernel, ...]
    rollouts: dict[str, str]
    prepare: Callable[[Array], Array]
