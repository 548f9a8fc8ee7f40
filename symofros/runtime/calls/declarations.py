"""What the headers of native/ declare, as one cffi interface: structs, functions, and constants by name.

Only the part of a header between its cdef marks is read. Nothing is compiled for it.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cache
from typing import Any

import cffi

from symofros.errors import CompileError
from symofros.native import HEADERS, native_number, native_text

_CDEF = re.compile(r"/\* cdef begin.*?\*/(?P<declarations>.*?)/\* cdef end \*/", re.DOTALL)
_ENUMS = ("sym_status", "sym_method", "sym_segment_kind")


@cache
def interface() -> Any:
    """The cffi interface of all headers, shared by models and the integrator so that their types are the same."""
    ffi = cffi.FFI()
    for name in HEADERS:
        match = _CDEF.search(native_text(name))
        if match is not None:
            ffi.cdef(match["declarations"])
        elif name == HEADERS[0]:
            raise CompileError("symofros_model.h has lost its cdef marks")
    return ffi


@cache
def model_abi() -> int:
    """Version of the struct sym_model, SYM_ABI of symofros_model.h."""
    return int(native_number(HEADERS[0], "SYM_ABI"))


@cache
def constants() -> Mapping[str, int]:
    """Name, such as "SYM_FINISHED" -> value of the constants in the enumerations of symofros_stepper.h."""
    ffi = interface()
    return {name: value for enum in _ENUMS for name, value in ffi.typeof(enum).relements.items()}
