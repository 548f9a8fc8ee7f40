"""C text -> shared library, cached by content.

The key covers the C text, the header, flags, compiler and processor. A library is compiled in a private folder and
renamed into place, so that concurrent processes and killed compilations never leave a broken one behind; a damaged one
is compiled anew. A second key spares the C text: what was asked for, of which state of this package; its file names the
library.
"""

from __future__ import annotations

import hashlib
import os
import re
import sys
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from symofros.base.stored import keep, stored_text
from symofros.base.threads import beside_each_other
from symofros.runtime.build.cache import cache_folder, create_cache_folder, install, is_intact, unusable
from symofros.runtime.build.identity import CODE_IDENTITY
from symofros.runtime.build.pieces import pieces, usable_processors
from symofros.runtime.build.toolchain import SHARED_FLAGS, Toolchain, call_compiler, cpu_identity, stated_flags

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
) -> Path:
    """Path of the library of a recipe; its C text is formed only if the library is not cached.

    Args:
        recipe: All that the C text depends on, but for the code that writes it.
        source: Gives the text.
        header: Header, as of `build_library`, like the others.
        toolchain: The compiler.
        flags: Flags in place of the default ones.

    Raises:
        CompileError: As for `build_library`.
    """
    path = known_library(recipe, header, toolchain, flags)
    if path is not None:
        return path
    library = build_library(source(), header, toolchain, flags)
    keep(_note(recipe, header, toolchain, flags), library.name)
    return library


def known_library(recipe: str, header: str, toolchain: Toolchain, flags: Sequence[str] | None = None) -> Path | None:
    """Path of the library of a recipe that is in the cache; None where it is not. Arguments as of `recall_library`."""
    known = _note(recipe, header, toolchain, flags)
    name = stored_text(known, file_name)
    return known.parent / name if name is not None and is_intact(known.parent / name) else None


def _note(recipe: str, header: str, toolchain: Toolchain, flags: Sequence[str] | None) -> Path:
    """The file that names the library of a recipe."""
    return cache_folder() / f"{cache_key(toolchain, flags, recipe, CODE_IDENTITY, header)}.known"


def file_name(text: str) -> str:
    """A text that is the name of a file of the folder, and nothing else.

    Raises:
        ValueError: It is none.
    """
    if not _FILE_NAME.fullmatch(text):
        raise ValueError(f"{text[:40]!r} is no name of a library")
    return text


def cache_key(toolchain: Toolchain, flags: Sequence[str] | None, *parts: str) -> str:
    """Name, without its suffix, of what some texts lead to with a compiler, its flags and this processor.

    Args:
        toolchain: The compiler.
        flags: Flags in place of the default ones.
        parts: The texts.
    """
    stated = [*parts, "", *_chosen(toolchain, flags), *SHARED_FLAGS, toolchain.identity, cpu_identity()]
    return hashlib.sha256("\0".join(stated).encode()).hexdigest()[:32]


def _chosen(toolchain: Toolchain, flags: Sequence[str] | None) -> tuple[str, ...]:
    return tuple(flags) if flags is not None else (*toolchain.default_flags, *stated_flags())


def build_library(
    source: str,
    header: str,
    toolchain: Toolchain,
    flags: Sequence[str] | None = None,
) -> Path:
    """The shared library of a C file, compiled unless it is in the cache.

    Args:
        source: Text of the C file.
        header: Text of symofros_model.h.
        toolchain: The compiler.
        flags: Flags in place of the default ones.

    Raises:
        CompileError: The compiler failed, with its command and messages; or the cache folder can't be used.
    """
    key = cache_key(toolchain, flags, source, header)
    folder = cache_folder()
    library = folder / f"{key}{_SUFFIX}"
    if is_intact(library):
        return library
    try:
        create_cache_folder(folder)
        with tempfile.TemporaryDirectory(prefix=f".{key[:8]}-", dir=folder) as private:
            _write(Path(private), {"symofros_model.h": header, "model.c": source})
            _compile(Path(private), source, toolchain, _chosen(toolchain, flags))
            os.replace(Path(private) / "model.c", folder / f"{key}.c")
            install(Path(private) / f"model{_SUFFIX}", library)
    except OSError as error:
        raise unusable(folder, error) from error
    return library


def _write(private: Path, files: Mapping[str, str]) -> None:
    for name, text in files.items():
        (private / name).write_text(text, encoding="utf-8")


def _compile(private: Path, source: str, toolchain: Toolchain, flags: tuple[str, ...]) -> None:
    """The library of a folder's model.c, which is compiled in pieces beside each other where it is long."""
    loose, parts = bool(_LOOSE & set(flags)), pieces(source, usable_processors())
    if len(parts) == 1 and not loose:
        command = [*toolchain.command, *flags, *SHARED_FLAGS, "model.c", "-lm"]
        call_compiler(command, f"model{_SUFFIX}", private, _REMEDY)
        return
    files = [f"piece{i}.c" for i in range(len(parts))]
    _write(private, dict(zip(files, parts, strict=True)))

    def to_object(file: str) -> None:
        call_compiler([*toolchain.command, *flags, *SHARED_FLAGS, "-c", file], f"{file}.o", private, _REMEDY)

    beside_each_other(to_object, files)
    command = [*toolchain.command, *(() if loose else flags), "-shared", *(f"{file}.o" for file in files), "-lm"]
    call_compiler(command, f"model{_SUFFIX}", private, _REMEDY)
