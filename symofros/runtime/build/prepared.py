"""Description file -> its libraries, where nothing that they were made of has changed: found without reading it.

A level above `recall_library`, in files of the same kind. The key covers the path, what was asked for, the compiler,
the processor, the state of this package and the installed packages that read descriptions and help to form C. Its file
states all files that the description consists of, each with its content's digest, and names the libraries. All of that
is checked when it is asked for; what does not hold is as if it were not there.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterable
from importlib.util import find_spec
from pathlib import Path
from typing import Any, NamedTuple

from symofros.base.sources import Source
from symofros.base.stored import keep, stored_json
from symofros.runtime.build.build import cache_key, file_name
from symofros.runtime.build.cache import cache_folder, is_intact
from symofros.runtime.build.identity import CODE_IDENTITY
from symofros.runtime.build.toolchain import Toolchain

# Packages that read the native file, and that C is formed with; to import one for its version takes too long.
_PACKAGES = ("numpy", "pydantic", "ruamel.yaml")


class Prepared(NamedTuple):
    """Cached record of a compiled description.

    Attributes:
        name: Name of the system.
        sources: Files that it consists of.
        libraries: Names of the libraries in the cache's folder.
    """

    name: str
    sources: tuple[Source, ...]
    libraries: tuple[str, ...]


def recall_prepared(description: Path, request: str, toolchain: Toolchain) -> Prepared | None:
    """Cached record of a compiled description, if its files are unchanged and its libraries intact.

    Args:
        description: The file.
        request: All that was asked for: options of reading and of compilation.
        toolchain: The compiler; default flags.

    Returns:
        None where that is not known, or no longer true.

    Raises:
        CompileError: The cache folder can't be trusted.
    """
    folder = cache_folder()
    known = stored_json(folder / _file_name(description, request, toolchain), _prepared)
    if known is None:
        return None
    libraries = [folder / name for name in known.libraries]
    unchanged = bool(known.sources and libraries) and all(source.is_unchanged() for source in known.sources)
    return known if unchanged and all(map(is_intact, libraries)) else None


def _prepared(stated: Any) -> Prepared:
    """Record read from a cache file, each value converted to its type."""
    sources = tuple(Source(str(a), str(b), int(size), str(digest)) for a, b, size, digest in stated["sources"])
    return Prepared(str(stated["name"]), sources, tuple(map(file_name, stated["libraries"])))


def note_prepared(
    description: Path,
    request: str,
    toolchain: Toolchain,
    name: str,
    sources: Iterable[Source],
    libraries: Iterable[Path],
) -> None:
    """Store the record of a compiled description in the cache.

    Args:
        description: The file, as of `recall_prepared`, like the next two.
        request: All that was asked for.
        toolchain: The compiler.
        name: Name of the system.
        sources: All files that it consists of.
        libraries: All libraries of what was asked for, in the cache's folder.

    Raises:
        CompileError: The cache folder can't be trusted.
    """
    prepared = Prepared(name, tuple(sources), tuple(sorted(path.name for path in libraries)))
    file = cache_folder() / _file_name(description, request, toolchain)
    keep(file, json.dumps(prepared._asdict()))


def _file_name(description: Path, request: str, toolchain: Toolchain) -> str:
    # Files that are included lie in the folder by which the description is opened, or below.
    place = os.path.realpath(description.parent), description.name, os.path.realpath(description)
    recipe = repr(("description", place, request, sys.version, *map(_installation, _PACKAGES)))
    return f"{cache_key(toolchain, None, recipe, CODE_IDENTITY)}.known"


def _installation(package: str) -> str:
    """Which installation of a package this is: where its first file lies, and when it was put there."""
    try:
        spec = find_spec(package)
        file = str(spec and spec.origin)
        status = os.stat(file)
    except (ImportError, OSError):  # Whatever needs it says that it is not there; and packages are not always files.
        return package
    return f"{file} {status.st_size} {status.st_mtime_ns} {status.st_ctime_ns}"
