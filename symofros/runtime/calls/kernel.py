"""A function that can be called on batches of states, whatever computes it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import prod
from typing import Literal, Protocol, runtime_checkable

import numpy as np

from symofros.base.arrays import Array as Array
from symofros.runtime.calls.layout import Numbers as Numbers
from symofros.runtime.calls.layout import columns

Precision = Literal["double", "single"]


@dataclass(frozen=True)
class Signature:
    """Inputs and outputs of a function.

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


@dataclass(frozen=True)
class LaneOptions:
    """Options of code by vectors that hold one state in each lane.

    Attributes:
        own_parameters: Whether each state may have parameters of its own.
        precision: Floating-point type of the lanes: "double" or "single".
        in_rows: Whether lanes read and write the rows of two states where they lie: for vectors of two doubles, and
            callers that have no other layout. In doubles, of shared parameters.
        are_all: Whether one state alone is evaluated by them, too, where the compiler has vectors: beside code for one
            state that nobody calls, a library takes nearly twice as long to compile.
    """

    own_parameters: bool = False
    precision: Precision = "double"
    in_rows: bool = False
    are_all: bool = False

    @property
    def single(self) -> bool:
        """Whether lanes hold floats."""
        return self.precision == "single"


SHARED_PARAMETERS = LaneOptions()


@dataclass(frozen=True)
class BatchOptions:
    """Options of one evaluation of a batch.

    Attributes:
        threads: Most threads that share the batch.
        columns: Whether the batch is the fast axis of the results.
        precision: Floating-point type of inputs and results, and of the computation where there is code for it.
    """

    threads: int = 1
    columns: bool = False
    precision: Precision = "double"

    @property
    def dtype(self) -> type[np.float32] | type[np.float64]:
        """Type of inputs and results."""
        return np.float32 if self.precision == "single" else np.float64

    def empty(self, n: int, size: int) -> Numbers:
        """Uninitialised results (n, size) in the layout of these options."""
        return columns(n, size, self.dtype) if self.columns else np.empty((n, size), self.dtype)

    def of(self, results: Array) -> Numbers:
        """Results (n, *shape), given row by row in double precision, in the layout and precision of these options."""
        if not self.columns and self.precision == "double":
            return results
        wanted = self.empty(len(results), prod(results.shape[1:]))
        # Beyond the range of floats lies infinity, as in the code by vectors.
        with np.errstate(over="ignore", invalid="ignore"):
            wanted[...] = results.reshape(wanted.shape)
        return wanted.reshape(results.shape)


DEFAULT_OPTIONS = BatchOptions()


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

    def run(
        self,
        n: int,
        pre: Array,
        inputs: list[Numbers],
        options: BatchOptions = DEFAULT_OPTIONS,
        places: Sequence[Numbers | None] = (),
    ) -> list[Numbers]:
        """Evaluate n states.

        Args:
            n: Number of states.
            pre: (n or 1, npre), from `prepare`.
            inputs: Each (n or 1, size), with any strides, in the signature's order.
            options: Threads, layout and precision.
            places: C-contiguous arrays (n, *shape) in which outputs may be computed, in the signature's order; they
                overlap no input.

        Returns:
            One array an output, (n, *shape): its place, where it was computed there.
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


@runtime_checkable
class BatchKernel(Kernel, Protocol):
    """A function that C evaluates on batches in fixed memory."""

    def bind_batch(
        self, n: int, pre: Array, inputs: list[Array], outputs: list[Array], threads: int = 1
    ) -> Callable[[], None]:
        """Bind arrays of n states, as `bind` does, to the very code that `run` takes for so many.

        Args:
            n: Number of states.
            pre: (n or 1, npre), from `prepare`.
            inputs: Each (n or 1, size), in steps of whole numbers, in the signature's order.
            outputs: Each (n, size), in steps of whole numbers, in the signature's order.
            threads: Number of threads that share a large batch.
        """
        ...


class Unit(Protocol):
    """A group of functions that were generated together."""

    @property
    def kernels(self) -> dict[tuple[str, str], Kernel]:
        """Functions by (name, frame)."""
        ...
