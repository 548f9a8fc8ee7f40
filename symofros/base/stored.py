"""State that programs keep in files for themselves: what is damaged counts as absent, with a warning, and is made anew.

A cache, a journal, a record of what was measured: a process that is killed, a full disk or another program may leave
any bytes there, or a folder. Whoever reads such a file states what a sound one holds, by a function that makes a value
of it, and has a way to do without.
"""

from __future__ import annotations

import errno
import json
import os
import tempfile
import warnings
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, TypeVar

from symofros.errors import StoredStateWarning

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


T = TypeVar("T")
# What reading and making raise of bytes that nobody wrote on purpose.
_DAMAGE = (OSError, ValueError, TypeError, LookupError, AttributeError, ArithmeticError, RecursionError)


def stored_text(path: Path, make: Callable[[str], T], errors: str = "strict") -> T | None:
    """The value made from a text file; None if the file is missing or damaged.

    Args:
        path: The file.
        make: Makes the value of its text; raises where the text is not sound.
        errors: What becomes of bytes that are no UTF-8, as of `bytes.decode`.

    Returns:
        The value; None where there is no file, or where it is damaged, which a `StoredStateWarning` says.
    """
    try:
        return make(_content(path).decode("utf-8", errors))
    except FileNotFoundError:
        if not os.path.lexists(path):
            return None
        _warn(path, "a link that leads nowhere")
    except _DAMAGE as error:
        _warn(path, _single_line(error))
    return None


def stored_json(path: Path, make: Callable[[Any], T]) -> T | None:
    """The value made from the parsed contents of a JSON file; as `stored_text` otherwise."""
    return stored_text(path, lambda text: make(json.loads(text)))


def stored_lines(path: Path, make: Callable[[Any], T]) -> list[T]:
    """Values made from the valid lines of a file with one JSON value per line.

    Args:
        path: The file.
        make: Makes the value of a parsed line; raises where it is not sound.

    Returns:
        The values, of sound lines alone; a `StoredStateWarning` says how many were left out.
    """
    values: list[T] = []
    damaged: list[int] = []
    for number, line in enumerate(stored_text(path, lambda text: text.split("\n"), "replace") or (), 1):
        if not line.strip():
            continue
        try:
            values.append(make(json.loads(line)))
        except _DAMAGE:
            damaged.append(number)
    if damaged:
        shown = ", ".join(map(str, damaged[:6])) + (", ..." if len(damaged) > 6 else "")
        _warn(path, f"{len(damaged)} of its lines ({shown}) can't be read", "they are left out")
    return values


def append_line(path: Path, value: Any) -> None:
    """Add a line of JSON; after a line that a killed process left unfinished, on a new one.

    Args:
        path: The file; made where there is none.
        value: What the line holds.

    Raises:
        OSError: The file can't be written to.
    """
    with path.open("ab+", buffering=0) as stream:
        end = stream.seek(0, os.SEEK_END)
        stream.seek(max(end - 1, 0))
        begin = b"" if stream.read(1) in (b"", b"\n") else b"\n"
        stream.write(begin + json.dumps(value).encode() + b"\n")


def keep(path: Path, content: str) -> None:
    """Write a file that only spares work later: where it can't be written, a `StoredStateWarning` says so."""
    try:
        write_atomically(path, content)
    except OSError as error:
        _warn(path, _single_line(error), "it is not kept")


def _content(path: Path) -> bytes:
    if path.is_dir() or (path.exists() and not path.is_file()):  # A pipe would block.
        raise ValueError("a folder" if path.is_dir() else "no regular file")
    return path.read_bytes()


def _single_line(error: BaseException) -> str:
    return f"{type(error).__name__}: {' '.join(str(error).split()):.200}"


def _warn(path: Path, found: str, consequence: str = "it is taken for absent and made anew") -> None:
    warnings.warn(f"{path}: {found}; {consequence}", StoredStateWarning, stacklevel=4)
