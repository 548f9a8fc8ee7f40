"""Files that are either whole or absent."""

from __future__ import annotations

import errno
import os
import tempfile
from contextlib import suppress
from pathlib import Path

# A disk, a quota or a limit of size that is exhausted; Windows has no quota of that name.
NO_ROOM = (errno.ENOSPC, errno.EFBIG, getattr(errno, "EDQUOT", errno.ENOSPC))


def check_writable(path: Path) -> None:
    """Refuse a path that `write_atomically` can't write, before the work whose result it takes.

    Raises:
        OSError: As of `write_atomically`; or the path is a folder.
    """
    if path.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    descriptor, temporary = _created_beside(path)
    os.close(descriptor)
    os.unlink(temporary)


def write_atomically(path: Path, content: str | bytes) -> None:
    """Write a file so that a reader, or a crash, sees the old file or the new one, never a part.

    Args:
        path: Path of the file, in a folder that exists.
        content: The whole of it; text is written as UTF-8.

    Raises:
        OSError: The folder is not there, or can't be written to; with the name of the file.
    """
    descriptor, temporary = _created_beside(path)
    try:
        with os.fdopen(descriptor, "wb") as stream:
            stream.write(content.encode("utf-8") if isinstance(content, str) else content)
        os.chmod(temporary, 0o644)
        os.replace(temporary, path)
    except BaseException as error:
        with suppress(OSError):
            os.unlink(temporary)
        if isinstance(error, OSError):  # A full disk names no file.
            raise type(error)(error.errno, error.strerror, str(path)) from None
        raise


def _created_beside(path: Path) -> tuple[int, str]:
    """Descriptor and path of a new file in the same folder."""
    try:
        return tempfile.mkstemp(prefix=f".{path.name}-", dir=path.parent)
    except OSError as error:
        raise type(error)(error.errno, error.strerror, str(path)) from None
