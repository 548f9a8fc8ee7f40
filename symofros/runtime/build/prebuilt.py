"""Hand-written C as a library: compiled on this machine, or as a wheel brings it where there is no compiler.

A wheel's libraries are compiled for any processor of their kind (.ci/prebuild.py); those of this machine are faster,
and taken wherever they can be made.
"""

from __future__ import annotations

import hashlib
import platform
import sys
from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path

from symofros.errors import CompileError
from symofros.native import HEADERS, native_text
from symofros.runtime.build.build import build_library
from symofros.runtime.build.toolchain import NO_COMPILER, find_toolchain

# Below native/; .ci/prebuild.py fills it.
FOLDER = "prebuilt"


def prebuilt_name(source: str) -> str:
    """File name of the library of a C text on this kind of machine."""
    key = hashlib.sha256(f"{native_text(HEADERS[0])}\0{source}".encode()).hexdigest()[:32]
    return f"{sys.platform}-{platform.machine()}-{key}.so"


def prebuilt_library(source: str) -> Path | None:
    """The library of a C text that came with the package; None where none did."""
    path = Path(str(files("symofros.native") / FOLDER / prebuilt_name(source)))
    return path if path.is_file() else None


def machine_library(source: str, flags: Sequence[str]) -> Path:
    """The library of a hand-written C text: compiled at its first use on a machine, or the one of the wheel.

    Raises:
        CompileError: There is neither a compiler nor a library that came with the package.
    """
    toolchain = find_toolchain(None)
    if toolchain is not None:
        return build_library(source, native_text(HEADERS[0]), toolchain, flags)
    path = prebuilt_library(source)
    if path is None:
        raise CompileError(NO_COMPILER)
    return path
