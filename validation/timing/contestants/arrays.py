"""Inputs and outputs of generated functions as the loops in C take them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import cffi
import numpy as np

from ...mechanics.geometry import Array
from .programs import BuildError, Compiler, build, compilers, declared, source

_FLAGS = ("-O3", "-march=native", "-std=gnu99", "-Wall", "-Wextra")
_PROTOTYPES = """
void loop_eval(const sym_function *, const loop_arrays *, size_t);
void loop_batch(const sym_function *, const loop_arrays *, size_t, size_t);
void loop_lanes(const sym_lanes *, const loop_blocks *, size_t);
void loop_casadi(int (*)(const double **, double **, long long *, double *, int), const loop_arrays *, size_t);
"""


@cache
def loops() -> tuple[Any, Any]:
    """The cffi interface, and the library of loops around generated functions."""
    ffi, header = cffi.FFI(), source("symofros_model.h")
    ffi.cdef(header.partition("/* cdef begin: what bindings read */")[2].partition("/* cdef end */")[0])
    ffi.cdef(declared("loop_generated.c") + _PROTOTYPES)
    sources = {"loop_generated.c": source("loop_generated.c"), "symofros_model.h": header}
    return ffi, ffi.dlopen(str(build(first_compiler(), sources, _FLAGS).path))


def first_compiler(language: str = "c") -> Compiler:
    """gcc, or else clang.

    Raises:
        BuildError: There is neither.
    """
    installed = compilers(language)
    if not installed:
        raise BuildError(f"no compiler of {language.upper()} was found: install gcc or clang")
    return installed[0]


# Bytes of a line of the cache.
LINE = 64


def aligned_zeros(size: int) -> Array:
    """Zeros that begin at a line of the cache (size,)."""
    raw = np.zeros(size + LINE // 8)
    start = (-raw.ctypes.data % LINE) // 8
    return raw[start : start + size]


class Turns:
    """Runs copies of one function in turn, so that a median is over where the system happened to put their code.

    Args:
        copies: Each runs so many rounds.
    """

    def __init__(self, copies: Sequence[Callable[[int], object]]) -> None:
        self._copies, self._next = copies, 0

    def __call__(self, rounds: int) -> None:
        """Run so many rounds of the next copy."""
        self._copies[self._next % len(self._copies)](rounds)
        self._next += 1


class Arrays:
    """Inputs and outputs of one function at all states.

    Args:
        inputs: Each (n, size), or (size,) where all states share it.
        sizes: Sizes of the outputs.
        scratch: Doubles and integers that the function works with.

    Attributes:
        inputs, sizes, scratch: The same.
        count: Number of states.
    """

    def __init__(self, inputs: Sequence[Array], sizes: Sequence[int], scratch: tuple[int, int]) -> None:
        self._ffi, self._kept = loops()[0], []  # type: tuple[Any, list[Any]]
        self.inputs, self.sizes, self.scratch = inputs, tuple(sizes), scratch
        self.count = max(len(array) for array in inputs if array.ndim == 2)

    @property
    def memory(self) -> int:
        """Bytes that one call reads and writes."""
        read = sum(int(array.shape[-1]) for array in self.inputs)
        return 8 * (sum(self.sizes) + read)

    def overwritten(self, states: int = 1) -> Any:
        """Arrays of a race: the results of so many states lie over those before."""
        return self._filled([aligned_zeros(states * size) for size in self.sizes], False)

    def results(self, run: Callable[[Any], None], shared: int | None = None) -> Array:
        """The first outputs of every state (n, size), of a run that gets arrays in which they are kept."""
        outputs = [aligned_zeros(self.count * size).reshape(self.count, size) for size in self.sizes]
        run(self._filled(outputs, True))
        return np.concatenate(outputs[:shared], axis=1)

    def _filled(self, outputs: Sequence[Array], keep: bool) -> Any:
        ffi, filled = self._ffi, self._ffi.new("loop_arrays *")
        filled.n, filled.n_in, filled.n_out, filled.keep = self.count, len(self.inputs), len(outputs), int(keep)
        strides = [array.shape[1] if array.ndim == 2 else 0 for array in self.inputs]
        pointers = self._keep(ffi.new("double *[]", [self._pointer(x) for x in self.inputs]))
        setattr(filled, "in", pointers)  # A keyword of Python.
        filled.stride = self._keep(ffi.new("size_t[]", strides))
        filled.out = self._keep(ffi.new("double *[]", [self._pointer(x) for x in outputs]))
        filled.size = self._keep(ffi.new("size_t[]", list(self.sizes)))
        doubles, integers = self.scratch
        filled.work = self._pointer(aligned_zeros(doubles))
        filled.iwork = self._keep(ffi.new("long long[]", integers + 1))
        return self._keep(filled)

    def _pointer(self, array: Array) -> Any:
        kept = array
        if array.ctypes.data % LINE or not array.flags.c_contiguous:
            kept = aligned_zeros(array.size)
            kept[:] = array.ravel()
        self._keep(kept)
        return self._keep(self._ffi.from_buffer("double[]", kept))

    def _keep(self, value: Any) -> Any:
        self._kept.append(value)
        return value
