"""Plain calls by a C extension of Python, built once a machine behind the first call that wants it.

A call of one state by it costs a third of one through NumPy's functions, one of a few states a twentieth. It needs the
headers of Python beside a C compiler; where there are none, calls go on as they are, with the same bits.
"""

from __future__ import annotations

import itertools
import logging
import sys
import sysconfig
import threading
import weakref
from collections.abc import Callable
from functools import cache
from importlib.machinery import ExtensionFileLoader
from importlib.util import module_from_spec, spec_from_loader
from pathlib import Path
from typing import Any

import numpy as np

from symofros.base.threads import try_to_start
from symofros.errors import CompileError
from symofros.native import amalgamated, native_number
from symofros.runtime.build.build import build_library
from symofros.runtime.build.toolchain import DEFAULT_FLAGS, find_toolchain
from symofros.runtime.calls.declarations import interface
from symofros.runtime.calls.library import MANY

LOGGER = logging.getLogger("symofros")
_NAME = "symofros_call"
# Deviation of the squared length of a quaternion from one that is rounding.
UNIT_ROUNDING = native_number("stepping/state/system.c", "SYM_QUATERNION_ROUNDING")

_begun = itertools.count()
_waiting: list[weakref.WeakMethod[Callable[[], None]]] = []
_over = threading.Event()


def call_type(when_there: Callable[[], None]) -> Any:
    """The type `Call` of symofros_call.c, or None where it is not there, or not yet.

    Args:
        when_there: A method that is called, by another thread, once the type is there if it is not there yet; its
            object is not kept alive.
    """
    if _over.is_set():
        return load()
    _waiting.append(weakref.WeakMethod(when_there))
    begin()
    if _over.is_set():
        _tell()
    return None


def available_type() -> Any:
    """The type `Call`, or None where it is not there, or not yet."""
    return load() if _over.is_set() else None


def begin() -> None:
    """Start loading the type `Call` and the C declarations in other threads, unless that has been started."""
    if next(_begun) == 0:
        try_to_start(threading.Thread(target=interface))
        # The process waits for it at its end: a script that is over sooner would never have it.
        try_to_start(threading.Thread(target=_load_behind, name=_NAME))


def _load_behind() -> None:
    try:
        there = load() is not None
    finally:
        _over.set()
    if there:
        _tell()


def _tell() -> None:
    while _waiting:
        method = _waiting.pop()()
        if method is not None:
            method()


def load() -> Any:
    """The type `Call`, built unless the cache folder has it; None where it can't be built."""
    there = module()
    return None if there is None else there.Call


def step_type() -> Any:
    """The type `Step` of symofros_step.c, built unless the cache folder has it; None where it can't be built."""
    there = module()
    return None if there is None else there.Step


@cache
def module() -> Any:
    """The extension module, built unless the cache folder has it; None where it can't be built or loaded."""
    toolchain = find_toolchain(None)
    headers = [Path(sysconfig.get_paths()["include"]), Path(np.get_include())]
    if toolchain is None or sys.platform == "win32" or not (headers[0] / "Python.h").is_file():
        return None
    # What the headers are is part of the text, which names the library in the cache folder.
    of = f"/* {sysconfig.get_config_var('SOABI')}, NumPy {np.__version__}, {sys.version!r} */\n"
    of += f"#define SYM_UNIT_ROUNDING {UNIT_ROUNDING!r}\n#define SYM_MANY {MANY}\n"
    flags = (*DEFAULT_FLAGS, *(f"-I{folder}" for folder in headers))
    if sys.platform == "darwin":  # Symbols of Python are found as it is loaded.
        flags = (*flags, "-Wl,-undefined,dynamic_lookup")
    try:
        library = build_library(of + amalgamated(f"interop/{_NAME}.c"), "", toolchain, flags)
        loader = ExtensionFileLoader(_NAME, str(library))
        spec = spec_from_loader(_NAME, loader)
        assert spec is not None
        made = module_from_spec(spec)
        loader.exec_module(made)
    except (CompileError, ImportError) as error:
        LOGGER.info("plain calls go through NumPy, since the extension for them is not there: %s", error)
        return None
    return made
