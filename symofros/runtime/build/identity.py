"""Which code this is: what one state of the package has generated, the same state need not generate again."""

from __future__ import annotations

import hashlib
from pathlib import Path

_SUFFIXES = {".py", ".in", ".h", ".c"}


def source_digest(package: Path) -> str:
    """Digest of all source files of a package, Python and C, and of their places in its folder."""
    digest = hashlib.sha256()
    for path in sorted(path for path in package.rglob("*") if path.suffix in _SUFFIXES):
        digest.update(f"{path.relative_to(package)}\0".encode())
        digest.update(hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()


# Taken at import (5 ms): later, a file might have been edited whose older text this process runs.
CODE_IDENTITY = source_digest(Path(__file__).parents[2])
