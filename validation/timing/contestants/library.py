"""Functions of a compiled library with arrays for the loops in C around them."""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ...mechanics.geometry import Array
from .arrays import Arrays, loops


class Library:
    """The library of one model, its parameters at their defaults.

    Args:
        path: File of the library.
        symbol: Name of what it exports.

    Attributes:
        model: Its `sym_model`.
        pre: What its functions take of the parameters (npre,).
    """

    def __init__(self, path: Path, symbol: str) -> None:
        ffi, _ = loops()
        self._library = ctypes.CDLL(str(path))  # Stays loaded as long as this.
        address = ctypes.cast(self._library[symbol], ctypes.c_void_p).value
        self.model: Any = ffi.cast("const sym_model *(*)(void)", address)()
        pre = np.zeros(self.model.npre + 1)
        self.model.init(self.model.par_default, ffi.from_buffer("double[]", pre))
        self.pre = pre[: self.model.npre]

    @property
    def names(self) -> list[str]:
        """Names of its functions, in their order."""
        functions = self.model.functions[0 : self.model.n_functions]
        return [loops()[0].string(entry.name).decode() for entry in functions]

    def arrays(self, given: Mapping[str, Array], number: int = 0) -> Arrays:
        """Inputs and outputs of a function: inputs that are not given are zero."""
        entry = self.model.functions[number]
        inputs = [
            given.get(loops()[0].string(item.name).decode(), np.zeros(item.rows * item.cols))
            for item in getattr(entry, "in")[0 : entry.n_in]  # A keyword of Python.
        ]
        sizes = [item.rows * item.cols for item in entry.out[0 : entry.n_out]]
        return Arrays(inputs, sizes, (int(entry.work), 0))
