"""What the headers of native/ declare, as one cffi interface: structs, functions, constants.

Only the part of a header between its cdef marks is read. Nothing is compiled for it.
"""

from __future__ import annotations

import hashlib
import re
import tempfile
import threading
from contextlib import suppress
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

import _cffi_backend

from symofros.errors import CompileError
from symofros.native import HEADERS, native_number, native_text
from symofros.runtime.build.cache import cache_folder, create_cache_folder, install, is_intact

_CDEF = re.compile(r"/\* cdef begin.*?\*/(?P<declarations>.*?)/\* cdef end \*/", re.DOTALL)
# A second interface, of a thread that asks at the same time, would have types of its own.
_ONE = threading.Lock()


def interface() -> Any:
    """The cffi interface of all headers, shared by models and the integrator so that their types are the same.

    Headers are parsed once a machine: what cffi makes of them is kept in the folder of compiled models.
    """
    with _ONE:
        return _interface()


@cache
def _interface() -> Any:
    declared = []
    for name in HEADERS:
        match = _CDEF.search(native_text(name))
        if match is not None:
            declared.append(match["declarations"])
        elif name == HEADERS[0]:
            raise CompileError("symofros_model.h has lost its cdef marks")
    names: dict[str, Any] = {}
    exec(_parsed("\n".join(declared)), names)
    return names["ffi"]


def _parsed(declared: str) -> str:
    """Declarations as cffi has them parsed: a Python module that defines `ffi`, and takes no parser to load."""
    key = hashlib.sha256(f"{_cffi_backend.__version__}\0{declared}".encode()).hexdigest()[:32]
    folder = cache_folder()
    kept = folder / f"{key}.py"
    if is_intact(kept):
        return kept.read_text(encoding="utf-8")
    ffi = import_module("cffi").FFI()
    ffi.cdef(declared)
    ffi.set_source("symofros_interface", None, compiler_verbose=0)
    with tempfile.TemporaryDirectory() as private:
        made = Path(private) / kept.name
        ffi.emit_python_code(str(made))
        text = made.read_text(encoding="utf-8")
    with suppress(OSError):  # Whether the folder has to be writeable is not decided here.
        create_cache_folder(folder)
        with tempfile.TemporaryDirectory(prefix=f".{key[:8]}-", dir=folder) as private:
            (Path(private) / kept.name).write_text(text, encoding="utf-8")
            install(Path(private) / kept.name, kept)
    return text


@cache
def model_abi() -> int:
    """Version of the struct sym_model, SYM_ABI of symofros_model.h."""
    return int(native_number(HEADERS[0], "SYM_ABI"))
