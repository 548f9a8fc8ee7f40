"""Generated C called as a C program calls it: one loop over many states, nothing allocated in between."""

from __future__ import annotations

import ctypes
from collections.abc import Iterable, Sequence
from importlib.resources import files
from typing import Any

import cffi
import numpy as np

import symofros as sf

from ...mechanics.geometry import Array


class GeneratedLoop:
    """Functions of one model, each over the same states.

    Args:
        system: The description.
        functions: Names of functions of q, v, u and t.
        q: Coordinates (n, nq).
        v: Speeds (n, nv). Inputs and time are zero.

    Attributes:
        results: Function -> outputs at every state (n, rows, columns), as the last call left them.
    """

    def __init__(self, system: sf.System, functions: Sequence[str], q: Array, v: Array) -> None:
        path, symbol = sf.compile_library(system, sf.Options(functions=tuple(functions), batch="loop"))
        header = (files("symofros") / "native/model/symofros_model.h").read_text(encoding="utf-8")
        self._ffi: Any = cffi.FFI()
        self._ffi.cdef(header.partition("/* cdef begin: what bindings read */")[2].partition("/* cdef end */")[0])
        self._library = ctypes.CDLL(str(path))
        address: Any = ctypes.cast(self._library[symbol], ctypes.c_void_p).value
        model = self._ffi.cast("const sym_model *(*)(void)", address)()
        self._kept: list[Any] = []
        self.results: dict[str, list[Array]] = {}
        pre = self._buffer(np.empty(model.npre + 1))
        model.init(model.par_default, pre)
        given = {"pre": (pre, 0), "q": (self._buffer(q), q.shape[1]), "v": (self._buffer(v), v.shape[1])}
        nothing = self._buffer(np.zeros(model.nu + 1)), 0
        self._calls: dict[str, tuple[Any, tuple[Any, ...]]] = {}
        for function in model.functions[0 : model.n_functions]:
            inputs = getattr(function, "in")  # A keyword of Python.
            chosen = [given.get(self._name(entry), nothing) for entry in inputs[0 : function.n_in]]
            shapes = [(len(q), entry.rows, entry.cols) for entry in function.out[0 : function.n_out]]
            self.results[self._name(function)] = outputs = [np.empty(shape) for shape in shapes]
            arguments = (
                len(q),
                self._keep("double *[]", [buffer for buffer, _ in chosen]),
                self._keep("size_t[]", [stride for _, stride in chosen]),
                self._keep("double *[]", [self._buffer(output) for output in outputs]),
                self._buffer(np.empty(function.work + 1)),
            )
            self._calls[self._name(function)] = function.batch, arguments

    def run(self, functions: Iterable[str]) -> None:
        """Evaluate functions at every state, one after the other."""
        for function in functions:
            batch, arguments = self._calls[function]
            batch(*arguments)

    def _name(self, entry: Any) -> str:
        return str(self._ffi.string(entry.name).decode())

    def _buffer(self, array: Array) -> Any:
        self._kept.append(np.ascontiguousarray(array, dtype=np.float64))
        return self._ffi.from_buffer("double[]", self._kept[-1])

    def _keep(self, kind: str, values: list[Any]) -> Any:
        self._kept += [values, self._ffi.new(kind, values)]
        return self._kept[-1]
