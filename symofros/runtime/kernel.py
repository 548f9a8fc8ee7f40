"""A function that can be called on batches of states, whatever computes it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Signature:
    """What a function takes and returns.

    Attributes:
        name: Such as "mass_matrix".
        frame: The frame it is about, or "".
        inputs: (group, size) of each input but the parameters.
        outputs: (name, shape) of each output.
    """

    name: str
    frame: str
    inputs: tuple[tuple[str, int], ...]
    outputs: tuple[tuple[str, tuple[int, ...]], ...]


class Kernel(Protocol):
    """One function of a compiled or interpreted model."""

    @property
    def signature(self) -> Signature:
        """What it takes and returns."""
        ...

    def prepare(self, par: Array) -> Array:
        """The parameter-only part of the work.

        Args:
            par: Parameter sets (m, npar).

        Returns:
            (m, npre).
        """
        ...

    def run(self, n: int, pre: Array, inputs: list[Array], threads: int = 1) -> list[Array]:
        """Evaluate n states.

        Args:
            n: Number of states.
            pre: (n or 1, npre), from `prepare`.
            inputs: Each (n or 1, size), C-contiguous, in the signature's order.
            threads: How many may share the work.

        Returns:
            One array an output, (n, *shape).
        """
        ...

    def bind(self, pre: Array, inputs: list[Array], outputs: list[Array]) -> Callable[[], None]:
        """The function on fixed memory, for one state: a call reads the inputs and overwrites the outputs.

        C gets addresses: the caller keeps this kernel and all arrays for as long as the result is called.

        Args:
            pre: (1, npre), from `prepare`.
            inputs: Each (size), C-contiguous, in the signature's order.
            outputs: Each of its shape, C-contiguous.
        """
        ...


class Unit(Protocol):
    """A group of functions that were generated together."""

    @property
    def kernels(self) -> dict[tuple[str, str], Kernel]:
        """Functions by (name, frame)."""
        ...
