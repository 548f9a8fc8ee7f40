"""C text -> shared library, cached by content.

The key covers the C text, the header, flags, compiler and processor. A library is compiled in a private folder and
renamed into place, so that concurrent processes and killed compilations never leave a broken one behind.
"""

from __future__ import annotations

import hashlib
import os
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from symofros.errors import CompileError
from symofros.runtime.toolchain import DEFAULT_FLAGS, SHARED_FLAGS, Toolchain, call_compiler, cpu_identity

_SUFFIX = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
_REMEDY = "check Options(flags=…) and the compiler; backend='interpreter' needs none"
# Linked with these, a library of gcc's up to 12 makes the whole process flush denormal numbers to zero when it loads.
_LOOSE = {"-ffast-math", "-Ofast", "-funsafe-math-optimizations"}


def cache_folder() -> Path:
    """Where compiled models live: $SYMOFROS_CACHE, or symofros in the user's cache folder."""
    stated = os.environ.get("SYMOFROS_CACHE")
    if stated:
        return Path(stated)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "symofros"


def build_library(source: str, header: str, toolchain: Toolchain, flags: Sequence[str] | None = None) -> Path:
    """The shared library of a C file, compiled unless it is in the cache.

    Args:
        source: Text of the C file.
        header: Text of symofros_model.h.
        toolchain: The compiler.
        flags: In place of the default ones.

    Raises:
        CompileError: The compiler refused, with its command and words; or the cache folder can't be written.
    """
    chosen = tuple(DEFAULT_FLAGS if flags is None else flags)
    parts = [source, header, *chosen, *SHARED_FLAGS, toolchain.identity, cpu_identity()]
    key = hashlib.sha256("\0".join(parts).encode()).hexdigest()[:32]
    folder = cache_folder()
    library = folder / f"{key}{_SUFFIX}"
    if library.exists():
        return library
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=f".{key[:8]}-", dir=folder) as private:
            _compile(Path(private), source, header, toolchain, chosen)
            _flush(Path(private) / f"model{_SUFFIX}")
            os.replace(Path(private) / "model.c", folder / f"{key}.c")
            os.replace(Path(private) / f"model{_SUFFIX}", library)
    except OSError as error:
        raise CompileError(
            f"the cache folder can't be used: {error}\n  found:  {folder}\n"
            "  rule:   compiled models are kept in a folder that can be written\n"
            "  remedy: set SYMOFROS_CACHE to such a folder"
        ) from error
    return library


def _flush(path: Path) -> None:
    """Bring a file to the disk: a crash after the renaming must not leave a truncated library under its name."""
    with open(path, "rb+") as stream:
        os.fsync(stream.fileno())


def _compile(private: Path, source: str, header: str, toolchain: Toolchain, flags: tuple[str, ...]) -> None:
    (private / "symofros_model.h").write_text(header, encoding="utf-8")
    (private / "model.c").write_text(source, encoding="utf-8")
    output = f"model{_SUFFIX}"
    if not _LOOSE & set(flags):
        call_compiler([*toolchain.command, *flags, *SHARED_FLAGS, "-o", output, "model.c", "-lm"], private, _REMEDY)
        return
    call_compiler([*toolchain.command, *flags, *SHARED_FLAGS, "-c", "-o", "model.o", "model.c"], private, _REMEDY)
    call_compiler([*toolchain.command, "-shared", "-o", output, "model.o", "-lm"], private, _REMEDY)
