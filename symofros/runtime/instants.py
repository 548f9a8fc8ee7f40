"""Instants at which formulas of time bend, jump or change fast, by native/stepping/events/formula_instants.c."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np

from symofros.runtime.calls.binding import NativeMemory, constants, native_library
from symofros.runtime.calls.kernel import Array

# Values of an operand, by its number, at times (n) [s].
Operands = Callable[[int, Array], Array]


class Motion(NamedTuple):
    """A motion that is known.

    Attributes:
        states: Gives the states "q", "v" and "u", a row for each of the times (n) [s].
        steps: Times at which its steps end (n) [s].
    """

    states: Callable[[Array], Mapping[str, Array]]
    steps: Array


class Instants(Protocol):
    """Instants at which formulas of time bend, jump or change fast, the model's own and those of laws."""

    def __call__(
        self,
        formulas: Sequence[Any],
        par: Array,
        t0: float,
        t_end: float,
        motion: Motion | None = None,
        *,
        kinks: bool = False,
    ) -> Array:
        """Instants of a run.

        Args:
            formulas: Laws, as `Functions.formulas` takes them.
            par: Run-time parameters (npar).
            t0: Start of the run [s].
            t_end: End of it [s].
            motion: States of the run by time, along which formulas of these count, too.
            kinks: Whether bends and jumps alone count.

        Returns:
            Instants in order, after the start and up to the end (n) [s].
        """
        ...

    def bend(self, formulas: Sequence[Any], par: Array, states: Mapping[str, Array]) -> bool:
        """Whether forces bend or jump along a motion: of joints' elements, by formula, and by laws.

        Args:
            formulas: Laws, as `Functions.formulas` takes them.
            par: Run-time parameters (npar).
            states: States of the motion: "t" (n, 1), "q" (n, nq), "v" (n, nv), "u" (n, nu).
        """
        ...

    def parameters(self, formulas: Sequence[Any]) -> tuple[int, ...] | None:
        """Indices of the parameters that instants depend on; None where there are none in any run."""
        ...


class _NoInstants:
    """A model without formulas."""

    def __call__(
        self,
        formulas: Sequence[Any],
        par: Array,
        t0: float,
        t_end: float,
        motion: Motion | None = None,
        *,
        kinks: bool = False,
    ) -> Array:
        return np.zeros(0)

    def bend(self, formulas: Sequence[Any], par: Array, states: Mapping[str, Array]) -> bool:
        return False

    def parameters(self, formulas: Sequence[Any]) -> None:
        return None


NO_INSTANTS = _NoInstants()


_EVALUATE = "void(void *, int32_t, int32_t, const double *, double *)"


def find_instants(kinds: Sequence[int], values: Operands, t0: float, t_end: float) -> Array:
    """Instants within a span at which a step has to end, as formulas of time bend, jump or are narrow there.

    Args:
        kinds: What formulas do where each operand is small, sym_instant_kind; inner operands first.
        values: Values of the operands.
        t0: Start of the span [s].
        t_end: End of the span [s].

    Returns:
        Instants in order, between t0 and t_end (n) [s].

    Raises:
        CompileError: There is no C compiler.
    """
    capacity = constants()["SYM_INSTANT_CAPACITY"]
    while (instants := _found(kinds, values, t0, t_end, capacity)) is None:
        capacity *= 2
    return instants


def _found(kinds: Sequence[int], values: Operands, t0: float, t_end: float, capacity: int) -> Array | None:
    """The instants; None where that memory does not hold them."""
    memory, failures = NativeMemory(), list[BaseException]()

    def evaluate(_: Any, operand: int, n: int, t: Any, value: Any) -> None:
        try:
            buffer = memory.ffi.buffer
            np.frombuffer(buffer(value, 8 * n))[:] = values(operand, np.frombuffer(buffer(t, 8 * n)))
        except BaseException as error:  # It may not pass through C.
            failures.append(error)

    search, instants = memory.own("sym_instant_search[]", 1), np.zeros(capacity)
    search[0].n, search[0].kind = len(kinds), memory.doubles(kinds)
    search[0].evaluate = memory.callback(_EVALUATE, evaluate)
    search[0].capacity = capacity
    search[0].memory = memory.zeros(constants()["SYM_INSTANT_ROWS"] * capacity)
    n = int(native_library().sym_find_instants(search, t0, t_end, memory.shared(instants)))
    if failures:
        raise failures[0]
    return instants[:n].copy() if n >= 0 else None
