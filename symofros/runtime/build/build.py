"""C text -> shared library, cached by content.

The key covers the C text, the header, flags, compiler and processor. A library is compiled in a private folder and
renamed into place, so that concurrent processes and killed compilations never leave a broken one behind; a damaged one
is compiled anew. A second key spares the C text: what was asked for, of which state of this package; its file names the
library.

A long function is written as chunks that are never inlined (`generator/codegen/function.py`), so that each may be
compiled in another file: what precedes the chunks is in all files, each chunk in one, declared in the first. Chunks are
compiled one by one either way, so the bits are the same.
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
from symofros.runtime.build.toolchain import SHARED_FLAGS, Toolchain, call_compiler, cpu_identity, stated_flags

# A chunk, from its head to its closing brace; and a file's fewest, for which another compiler pays.
_CHUNK = re.compile(r"^static (SYM_NOINLINE void \w+_\d+\([^)]*\)) \{\n.*?^\}\n", re.MULTILINE | re.DOTALL)
_FEWEST = 4
_CONDITION = re.compile(r"^#", re.MULTILINE)


def pieces(source: str, processors: int) -> list[str]:
    """The C files that a C file is compiled as: several where it has many chunks, itself alone otherwise.

    Args:
        source: Text of the file.
        processors: Compilers that may run beside each other.
    """
    chunks = list(_CHUNK.finditer(source))
    count = min(processors, len(chunks) // _FEWEST)
    if count < 2 or _CONDITION.search(source, chunks[0].start(), chunks[-1].end()):
        return [source]
    head = source[: chunks[0].start()]
    ends = [len(chunks) * i // count for i in range(count + 1)]
    groups = [chunks[a:b] for a, b in zip(ends, ends[1:], strict=False)]
    kept, at = [], 0
    for chunk in chunks:
        is_here = chunk.start() < groups[0][-1].end()
        kept += [source[at : chunk.start()], chunk[0] if is_here else f"{chunk[1]};\n"]
        at = chunk.end()
    first = "".join([*kept, source[at:]])
    return [first, *(head + "".join(chunk[0].removeprefix("static ") for chunk in group) for group in groups[1:])]


def usable_processors() -> int:
    """Processors that this process may run on."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


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
