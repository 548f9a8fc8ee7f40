"""C text -> shared library, cached by content.

The key covers the C text, the header, flags, compiler and processor. A library is compiled in a private folder and
renamed into place, so that concurrent processes and killed compilations never leave a broken one behind. A second key
spares the C text: what was asked for, of which state of this package; its file names the library.
"""

from __future__ import annotations

import hashlib
import os
import sys
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from symofros.atomic import write_atomically
from symofros.errors import CompileError
from symofros.runtime.identity import CODE_IDENTITY
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


def recall_library(
    recipe: str, source: Callable[[], str], header: str, toolchain: Toolchain, flags: Sequence[str] | None = None
) -> Path:
    """The library of what a recipe states; its C text is only asked for where no library is known.

    Args:
        recipe: All that the C text depends on, but for the code that writes it.
        source: Gives the text.
        header: As for `build_library`, and so the others.
        toolchain: The compiler.
        flags: In place of the default ones.

    Raises:
        CompileError: As for `build_library`.
    """
    folder = cache_folder()
    known = folder / f"{_key(recipe, CODE_IDENTITY, np.__version__, header, toolchain=toolchain, flags=flags)}.known"
    try:
        library = folder / Path(known.read_text(encoding="utf-8")).name
        if library.is_file():
            return library
    except OSError:
        pass
    library = build_library(source(), header, toolchain, flags)
    write_atomically(known, library.name)
    return library


def _key(*parts: str, toolchain: Toolchain, flags: Sequence[str] | None) -> str:
    chosen = DEFAULT_FLAGS if flags is None else flags
    stated = [*parts, *chosen, *SHARED_FLAGS, toolchain.identity, cpu_identity()]
    return hashlib.sha256("\0".join(stated).encode()).hexdigest()[:32]


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
    key = _key(source, header, toolchain=toolchain, flags=flags)
    folder = cache_folder()
    library = folder / f"{key}{_SUFFIX}"
    if library.exists():
        return library
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=f".{key[:8]}-", dir=folder) as private:
            _compile(Path(private), source, header, toolchain, tuple(DEFAULT_FLAGS if flags is None else flags))
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
