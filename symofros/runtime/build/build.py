"""C text -> shared library, cached by content.

The key covers the C text, the header, flags, compiler and processor, or the processor's family where the library is for
any of it. A library is compiled in a private folder and renamed into place, so that concurrent processes and killed
compilations never leave a broken one behind; a damaged one is compiled anew. A second key spares the C text: what was
asked for, of which state of this package; its file names the library.
"""

from __future__ import annotations

import hashlib
import os
import platform
import re
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from symofros.base.stored import keep, stored_text
from symofros.runtime.build.cache import cache_folder, create_cache_folder, install, is_intact, unusable
from symofros.runtime.build.identity import CODE_IDENTITY
from symofros.runtime.build.toolchain import (
    SHARED_FLAGS,
    Toolchain,
    call_compiler,
    cpu_identity,
    kinds,
    stated_flags,
)

_SUFFIX = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
_FILE_NAME = re.compile(r"[0-9a-f]{32}\.\w+")
_REMEDY = "check Options(flags=…) and the compiler; backend='interpreter' needs none"
# Linked with these, a library of gcc's up to 12 makes the whole process flush denormal numbers to zero when it loads.
_LOOSE = {"-ffast-math", "-Ofast", "-funsafe-math-optimizations"}


def recall_library(
    recipe: str,
    source: Callable[[], str],
    header: str,
    toolchain: Toolchain,
    flags: Sequence[str] | None = None,
    dispatch: str = "",
    symbol: str = "",
) -> Path:
    """The library of what a recipe states; its C text is only asked for where no library is known.

    Args:
        recipe: All that the C text depends on, but for the code that writes it.
        source: Gives the text.
        header: Header, as of `build_library`, like the others.
        toolchain: The compiler.
        flags: Flags in place of the default ones.
        dispatch: C text that chooses among kinds of processors.
        symbol: The exported function.

    Raises:
        CompileError: As for `build_library`.
    """
    folder = cache_folder()
    known = folder / f"{cache_key(toolchain, flags, dispatch, recipe, CODE_IDENTITY, header)}.known"
    name = stored_text(known, file_name)
    if name is not None and is_intact(folder / name):
        return folder / name
    library = build_library(source(), header, toolchain, flags, dispatch, symbol)
    keep(known, library.name)
    return library


def file_name(text: str) -> str:
    """A text that is the name of a file of the folder, and nothing else.

    Raises:
        ValueError: It is none.
    """
    if not _FILE_NAME.fullmatch(text):
        raise ValueError(f"{text[:40]!r} is no name of a library")
    return text


def cache_key(toolchain: Toolchain, flags: Sequence[str] | None, dispatch: str, *parts: str) -> str:
    """Name, without its suffix, of what some texts lead to with a compiler, its flags and this processor.

    Args:
        toolchain: The compiler.
        flags: Flags in place of the default ones.
        dispatch: C text that chooses among kinds of processors; none: for this machine's alone.
        parts: The texts.
    """
    suited = platform.machine() if dispatch else cpu_identity()
    stated = [*parts, dispatch, *_chosen(toolchain, flags, dispatch), *SHARED_FLAGS, toolchain.identity, suited]
    return hashlib.sha256("\0".join(stated).encode()).hexdigest()[:32]


def _chosen(toolchain: Toolchain, flags: Sequence[str] | None, dispatch: str) -> tuple[str, ...]:
    """The flags of all kinds: where there are several, none is the machine's own."""
    if flags is not None:
        return tuple(flags)
    kept = tuple(flag for flag in toolchain.default_flags if not (dispatch and flag.startswith("-march")))
    return (*kept, *stated_flags())


def build_library(
    source: str,
    header: str,
    toolchain: Toolchain,
    flags: Sequence[str] | None = None,
    dispatch: str = "",
    symbol: str = "",
) -> Path:
    """The shared library of a C file, compiled unless it is in the cache.

    Args:
        source: Text of the C file.
        header: Text of symofros_model.h.
        toolchain: The compiler.
        flags: Flags in place of the default ones.
        dispatch: Text of the C file that chooses among the kinds of processors; none: for this machine's alone.
        symbol: The exported function, which each kind has under a name of its own.

    Raises:
        CompileError: The compiler failed, with its command and messages; or the cache folder can't be used.
    """
    key, chosen = cache_key(toolchain, flags, dispatch, source, header), _chosen(toolchain, flags, dispatch)
    folder = cache_folder()
    library = folder / f"{key}{_SUFFIX}"
    if is_intact(library):
        return library
    try:
        create_cache_folder(folder)
        with tempfile.TemporaryDirectory(prefix=f".{key[:8]}-", dir=folder) as private:
            _write(Path(private), {"symofros_model.h": header, "model.c": source, "dispatch.c": dispatch})
            if dispatch:
                _compile_for_any(Path(private), toolchain, chosen, symbol)
            else:
                _compile(Path(private), toolchain, chosen)
            os.replace(Path(private) / "model.c", folder / f"{key}.c")
            install(Path(private) / f"model{_SUFFIX}", library)
    except OSError as error:
        raise unusable(folder, error) from error
    return library


def _write(private: Path, files: Mapping[str, str]) -> None:
    for name, text in files.items():
        (private / name).write_text(text, encoding="utf-8")


def _compile(private: Path, toolchain: Toolchain, flags: tuple[str, ...]) -> None:
    if not _LOOSE & set(flags):
        command = [*toolchain.command, *flags, *SHARED_FLAGS, "model.c", "-lm"]
        call_compiler(command, f"model{_SUFFIX}", private, _REMEDY)
        return
    call_compiler([*toolchain.command, *flags, *SHARED_FLAGS, "-c", "model.c"], "model.o", private, _REMEDY)
    _link(private, toolchain, ["model.o"])


def _compile_for_any(private: Path, toolchain: Toolchain, flags: tuple[str, ...], symbol: str) -> None:
    """The model for each kind of processor, and what chooses."""
    objects = ["dispatch.o"]
    call_compiler([*toolchain.command, *SHARED_FLAGS, "-c", "dispatch.c"], objects[0], private, _REMEDY)
    for name, _, extra in kinds():
        stated = [*flags, *extra, f"-D{symbol}={symbol}_{name}", *SHARED_FLAGS]
        objects.append(f"{name}.o")
        call_compiler([*toolchain.command, *stated, "-c", "model.c"], objects[-1], private, _REMEDY)
    _link(private, toolchain, objects)


def _link(private: Path, toolchain: Toolchain, objects: list[str]) -> None:
    call_compiler([*toolchain.command, "-shared", *objects, "-lm"], f"model{_SUFFIX}", private, _REMEDY)
