"""Inputs and outputs of generated functions as the loops in C take them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any

import cffi
import numpy as np

from validation.geometry import Array
from validation.timing.programs import BuildError, Compiler, build, compilers, declared, source

_FLAGS = ("-O3", "-march=native", "-std=gnu99", "-Wall", "-Wextra")
_PROTOTYPES = """
void loop_eval(const sym_function *, const loop_arrays *, size_t);
void loop_batch(const sym_function *, const loop_arrays *, size_t, size_t);
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
    found = compilers(language)
    if not found:
        raise BuildError(f"no compiler of {language.upper()} was found: install gcc or clang")
    return found[0]


# Bytes of a line of the cache, and of a page.
LINE, PAGE = 64, 4096
# Where in a page results and scratch lie decides by up to two fifths how long a large function takes. A race goes
# through this many places in turn, so that its median is over them.
PLACES = 16


def room(size: int, line: int = 0) -> Array:
    """Zeros that begin at a line of a page (size,)."""
    raw = np.zeros(size + 2 * PAGE // 8)
    start = (-raw.ctypes.data % PAGE + line * LINE) // 8
    return raw[start : start + size]


class Turns:
    """What runs a function, each time with its arrays in another place.

    Args:
        call: Of arrays and rounds.
        places: The arrays.
    """

    def __init__(self, call: Callable[[Any, int], object], places: Sequence[Any]) -> None:
        self._call, self._places, self._next = call, places, 0

    def __call__(self, rounds: int) -> None:
        """So many rounds at the next place."""
        self._call(self._places[self._next % len(self._places)], rounds)
        self._next += 1


class Arrays:
    """Inputs and outputs of one function at all states.

    Args:
        inputs: Each (n, size), or (size,) where all states share it.
        sizes: Of the outputs.
        scratch: Doubles and integers that the function works with.
    """

    def __init__(self, inputs: Sequence[Array], sizes: Sequence[int], scratch: tuple[int, int]) -> None:
        self._ffi, self._kept = loops()[0], []  # type: tuple[Any, list[Any]]
        self._inputs, self.sizes, self._scratch = inputs, tuple(sizes), scratch
        self.count = max(len(array) for array in inputs if array.ndim == 2)

    @property
    def memory(self) -> int:
        """Bytes that one call reads and writes."""
        read = sum(int(array.shape[-1]) for array in self._inputs)
        return 8 * (sum(self.sizes) + read)

    def overwritten(self, states: int = 1) -> list[Any]:
        """Arrays of a race at each place: the results of so many states lie over those before."""
        rng = np.random.default_rng(0)
        found = []
        for _ in range(PLACES):
            lines = rng.integers(0, PAGE // LINE, len(self.sizes) + 1).tolist()
            outputs = [room(states * size, line) for size, line in zip(self.sizes, lines, strict=False)]
            found.append(self._filled(outputs, False, lines[-1]))
        return found

    def results(self, run: Callable[[Any], None], shared: int | None = None) -> Array:
        """The first outputs of every state (n, size), of a run that gets arrays in which they are kept."""
        outputs = [room(self.count * size).reshape(self.count, size) for size in self.sizes]
        run(self._filled(outputs, True))
        return np.concatenate(outputs[:shared], axis=1)

    def _filled(self, outputs: Sequence[Array], keep: bool, line: int = 0) -> Any:
        ffi, filled = self._ffi, self._ffi.new("loop_arrays *")
        filled.n, filled.n_in, filled.n_out, filled.keep = self.count, len(self._inputs), len(outputs), int(keep)
        strides = [array.shape[1] if array.ndim == 2 else 0 for array in self._inputs]
        pointers = self._keep(ffi.new("double *[]", [self._pointer(x) for x in self._inputs]))
        setattr(filled, "in", pointers)  # A keyword of Python.
        filled.stride = self._keep(ffi.new("size_t[]", strides))
        filled.out = self._keep(ffi.new("double *[]", [self._pointer(x) for x in outputs]))
        filled.size = self._keep(ffi.new("size_t[]", list(self.sizes)))
        doubles, integers = self._scratch
        filled.work = self._pointer(room(doubles, line))
        filled.iwork = self._keep(ffi.new("long long[]", integers + 1))
        return self._keep(filled)

    def _pointer(self, array: Array) -> Any:
        kept = array
        if array.ctypes.data % LINE or not array.flags.c_contiguous:
            kept = room(array.size)
            kept[:] = array.ravel()
        self._keep(kept)
        return self._keep(self._ffi.from_buffer("double[]", kept))

    def _keep(self, value: Any) -> Any:
        self._kept.append(value)
        return value
