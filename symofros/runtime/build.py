"""C text -> shared library, cached by content.

The key covers the C text, the header, flags, compiler and processor, or the processor's family where the library is for
any of it. A library is compiled in a private folder and renamed into place, so that concurrent processes and killed
compilations never leave a broken one behind.
"""

from __future__ import annotations

import hashlib
import os
import platform
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from symofros.errors import CompileError
from symofros.runtime.toolchain import DEFAULT_FLAGS, SHARED_FLAGS, Toolchain, cpu_identity, kinds

_SUFFIX = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
_SHOWN_LINES = 12
# Linked with these, a library of gcc's up to 12 makes the whole process flush denormal numbers to zero when it loads.
_LOOSE = {"-ffast-math", "-Ofast", "-funsafe-math-optimizations"}


def cache_folder() -> Path:
    """Where compiled models live: $SYMOFROS_CACHE, or symofros in the user's cache folder."""
    stated = os.environ.get("SYMOFROS_CACHE")
    if stated:
        return Path(stated)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "symofros"


def build_library(
    source: str, header: str, toolchain: Toolchain, flags: Sequence[str] | None = None, dispatch: str = "",
    symbol: str = "",
) -> Path:  # fmt: skip
    """The shared library of a C file, compiled unless it is in the cache.

    Args:
        source: Text of the C file.
        header: Text of symofros_model.h.
        toolchain: The compiler.
        flags: In place of the default ones.
        dispatch: Text of the C file that chooses among the kinds of processors; none: for this machine's alone.
        symbol: The exported function, which each kind has under a name of its own.

    Raises:
        CompileError: The compiler refused, with its command and words; or the cache folder can't be written.
    """
    chosen = tuple(DEFAULT_FLAGS if flags is None else flags)
    if dispatch and flags is None:
        chosen = tuple(flag for flag in DEFAULT_FLAGS if not flag.startswith("-march"))
    suited = platform.machine() if dispatch else cpu_identity()
    parts = [source, header, dispatch, *chosen, *SHARED_FLAGS, toolchain.identity, suited]
    key = hashlib.sha256("\0".join(parts).encode()).hexdigest()[:32]
    folder = cache_folder()
    library = folder / f"{key}{_SUFFIX}"
    if library.exists():
        return library
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=f".{key[:8]}-", dir=folder) as private:
            _write(Path(private), {"symofros_model.h": header, "model.c": source, "dispatch.c": dispatch})
            if dispatch:
                _compile_for_any(Path(private), toolchain, chosen, symbol)
            else:
                _compile(Path(private), toolchain, chosen)
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


def _write(private: Path, files: Mapping[str, str]) -> None:
    for name, text in files.items():
        (private / name).write_text(text, encoding="utf-8")


def _compile(private: Path, toolchain: Toolchain, flags: tuple[str, ...]) -> None:
    if not _LOOSE & set(flags):
        output = f"model{_SUFFIX}"
        _run([*toolchain.command, *flags, *SHARED_FLAGS, "-o", output, "model.c", "-lm"], private)
        return
    _run([*toolchain.command, *flags, *SHARED_FLAGS, "-c", "-o", "model.o", "model.c"], private)
    _link(private, toolchain, ["model.o"])


def _compile_for_any(private: Path, toolchain: Toolchain, flags: tuple[str, ...], symbol: str) -> None:
    """The model for each kind of processor, and what chooses."""
    objects = ["dispatch.o"]
    _run([*toolchain.command, *SHARED_FLAGS, "-c", "-o", "dispatch.o", "dispatch.c"], private)
    for name, _, extra in kinds():
        renamed = f"-D{symbol}={symbol}_{name}"
        objects.append(f"{name}.o")
        _run([*toolchain.command, *flags, *extra, renamed, *SHARED_FLAGS, "-c", "-o", objects[-1], "model.c"], private)
    _link(private, toolchain, objects)


def _link(private: Path, toolchain: Toolchain, objects: list[str]) -> None:
    _run([*toolchain.command, "-shared", "-o", f"model{_SUFFIX}", *objects, "-lm"], private)


def _run(command: list[str], folder: Path) -> None:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        words = "\n".join(f"    {line}" for line in done.stderr.splitlines()[:_SHOWN_LINES])
        raise CompileError(
            f"the C compiler failed with status {done.returncode}\n  command: {' '.join(command)}\n{words}\n"
            "  remedy: check Options(flags=…) and the compiler; backend='interpreter' needs none"
        )
