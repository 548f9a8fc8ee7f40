"""The files that something was made of, so that a later check shows whether they are unchanged."""

from __future__ import annotations

import hashlib
import os
import stat
from pathlib import Path
from typing import NamedTuple


class Source(NamedTuple):
    """A file that was read.

    Attributes:
        path: Absolute path by which it was opened.
        file: Path that this led to, links followed.
        size: Bytes.
        digest: SHA-256 of its content.
    """

    path: str
    file: str
    size: int
    digest: str

    @classmethod
    def of(cls, path: Path, content: bytes) -> Source:
        """A file as it was read: with the content that was used, whatever became of the file since."""
        # Joined, and not by `abspath`, which takes `link/..` for nothing.
        opened = os.path.join(os.getcwd(), path)
        return cls(opened, os.path.realpath(path), len(content), hashlib.sha256(content).hexdigest())

    def is_unchanged(self) -> bool:
        """Whether the path leads to the same file, and that has the same content."""
        try:
            status = os.stat(self.path)
            # The size spares reading what has become another file; a pipe would block.
            if not stat.S_ISREG(status.st_mode) or status.st_size != self.size:
                return False
            return self == Source.of(Path(self.path), Path(self.path).read_bytes())
        except (OSError, ValueError):  # ValueError: a NUL character in the path.
            return False
