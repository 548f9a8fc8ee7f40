"""Which code this is: what one state of the package has generated, the same state need not generate again."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Collection
from pathlib import Path

_SUFFIXES = (".py", ".in", ".h", ".c")
_BUILT = ("__pycache__", "node_modules")


# What a wheel installs within the package and has no part in what it generates.
_INSTALLED_WITHIN = ("validation", "reference_models")


def source_digest(package: Path, apart: Collection[str] = ()) -> str:
    """Digest of all source files of a package, Python and C, and of their places in its folder.

    What is built beside them while a process runs, caches of bytecode and packages of Node, is none of them.

    Args:
        package: Folder of the package.
        apart: Names of folders in it that are left out.
    """
    digest = hashlib.sha256()
    for folder, folders, files in os.walk(package):
        left_out = (*_BUILT, *apart) if Path(folder) == package else _BUILT
        folders[:] = sorted(name for name in folders if name not in left_out)
        sources = sorted(name for name in files if name.endswith(_SUFFIXES))
        if sources:
            digest.update(f"{os.path.relpath(folder, package)}\0".encode())
        for name in sources:
            with open(os.path.join(folder, name), "rb") as stream:
                content = stream.read()
            digest.update(f"{name}\0{len(content)}\0".encode())
            digest.update(content)
    return digest.hexdigest()


# Taken at import (5 ms): later, a file might have been edited whose older text this process runs.
CODE_IDENTITY = source_digest(Path(__file__).parents[2], _INSTALLED_WITHIN)
