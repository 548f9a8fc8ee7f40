"""The folder of compiled models: nobody else can write to it, and what is loaded from it is whole.

Loading a library runs its code, so that a library of another user, or a damaged one, must be refused beforehand. Each
library has a file beside it that states its size and digest.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import stat
import time
from contextlib import suppress
from functools import cache
from pathlib import Path

from symofros.base.stored import NO_ROOM, write_atomically
from symofros.errors import CompileError
from symofros.runtime.build.cache_size import keep_within_limit, note_use

# What compilations and writings that were killed leave behind; nothing else in the folder is ever removed.
_LEFTOVER = re.compile(r"\.[0-9a-f]{8}-\w{8}|\.[0-9a-f]{32}\.(digest|known|fastest)-\w{8}")
_LEFTOVER_AGE = 86400.0  # [s], more than the compilers' time limit for all parts of a library.
_REMEDY = "set SYMOFROS_CACHE to a folder of your own that can be written"


def cache_folder() -> Path:
    """Where compiled models live: $SYMOFROS_CACHE, or symofros in the user's cache folder. It need not exist.

    Raises:
        CompileError: Another user owns it, or a symbolic link to it; or others can write to it, for good.
    """
    stated = os.environ.get("SYMOFROS_CACHE")
    if stated:
        folder = Path(stated)
    else:
        folder = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "symofros"
    try:
        link, status = folder.lstat(), folder.stat()
    except OSError:
        return folder
    foreign = next((of for of in (link, status) if not _is_trusted(of)), None)
    if foreign is not None:
        raise _refused(folder, f"user {foreign.st_uid} owns it, this process runs as user {os.geteuid()}")
    if _others_write(status):
        try:
            folder.chmod(stat.S_IMODE(status.st_mode) & ~(stat.S_IWGRP | stat.S_IWOTH))
        except OSError as error:
            raise _refused(folder, f"mode {stat.S_IMODE(status.st_mode):o}: others can write to it") from error
    return folder


def _is_trusted(status: os.stat_result) -> bool:
    """Whether this user owns a file, or the administrator, who could change this process itself."""
    return os.name != "posix" or status.st_uid in (0, os.geteuid())


def _others_write(status: os.stat_result) -> bool:
    return os.name == "posix" and bool(status.st_mode & (stat.S_IWGRP | stat.S_IWOTH))


def _refused(folder: Path, state: str) -> CompileError:
    return CompileError(
        f"the cache folder '{folder}' can't be trusted",
        state,
        "compiled models are loaded from a folder that no other user owns or can write to",
        _REMEDY,
    )


def create_cache_folder(folder: Path) -> None:
    """Create the folder and its missing parents for this user only, and remove stale entries.

    Those are leftovers, and the least recently used models where the folder is over its limit.

    Raises:
        OSError: It can't be created.
    """
    for level in reversed([folder, *folder.parents]):
        if not level.is_dir():
            level.mkdir(mode=0o700, exist_ok=True)  # Of concurrent processes, one is the first.
    _remove_leftovers(folder)
    keep_within_limit(folder)


def unusable(folder: Path, error: OSError) -> CompileError:
    """The error of a folder that can't be written."""
    rule, remedy = "compiled models are kept in a folder that can be written", _REMEDY
    if error.errno in NO_ROOM:
        rule, remedy = "there is room for compiled models", f"make room (symofros cache --clear), or {_REMEDY}"
    return CompileError(f"the cache folder can't be used: {error}", str(folder), rule, remedy)


@cache
def _remove_leftovers(folder: Path) -> None:
    """Once a process: temporary files and folders of compilations that were killed long ago."""
    oldest = time.time() - _LEFTOVER_AGE
    with os.scandir(folder) as entries:
        leftovers = [entry for entry in entries if entry.name[0] == "." and _LEFTOVER.fullmatch(entry.name)]
    for entry in leftovers:
        with suppress(OSError):
            if entry.stat(follow_symlinks=False).st_mtime > oldest:
                continue
            if entry.is_dir(follow_symlinks=False):
                shutil.rmtree(entry.path)
            else:
                os.unlink(entry.path)


def is_intact(library: Path) -> bool:
    """Whether a library of the folder is there, this user's, and has the size and digest that were stated of it."""
    try:
        status = library.lstat()
        if not stat.S_ISREG(status.st_mode) or not _is_trusted(status) or _others_write(status):
            return False
        stated = _digest_path(library).read_text(encoding="utf-8")
        # The size shows a truncated file before it is read.
        intact = stated.startswith(f"{status.st_size} ") and stated == _statement(library.read_bytes())
        if intact:
            note_use(_digest_path(library))
        return intact
    except (OSError, UnicodeDecodeError):
        return False


def install(built: Path, library: Path) -> None:
    """Move a new library into the folder, its size and digest beside it.

    The statement comes first: whoever finds the old library beside it, or none, builds the library anew.
    """
    _flush(built)
    built.chmod(0o755)
    write_atomically(_digest_path(library), _statement(built.read_bytes()))
    os.replace(built, library)


def _flush(path: Path) -> None:
    """Bring a file to the disk: a crash after the renaming must not leave a truncated library under its name."""
    with open(path, "rb+") as stream:
        os.fsync(stream.fileno())


def _digest_path(library: Path) -> Path:
    return library.with_suffix(".digest")


def _statement(content: bytes) -> str:
    return f"{len(content)} {hashlib.sha256(content).hexdigest()}"
