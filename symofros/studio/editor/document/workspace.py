"""The folder that the editor works in: paths that stay inside it, files read and written whole."""

from __future__ import annotations

import hashlib
import json
import os
from pathlib import Path
from typing import Any

from symofros.base.stored import write_atomically
from symofros.description import MODEL_SUFFIXES, YAML_SUFFIXES, kind_of
from symofros.description.yaml import MAX_BYTES
from symofros.diagrams.files.kind import is_diagram
from symofros.errors import SymofrosError

MAX_LISTED = 1000
MAX_SCANNED = 20_000
# Bytes of a name; systems allow 255, and files that are kept beside one have longer names.
MAX_NAME = 200


class FileError(SymofrosError):
    """A file that can't be read or written."""


class Workspace:
    """A folder; nothing outside of it is read, listed or written.

    Attributes:
        root: The folder, links resolved.
    """

    def __init__(self, root: Path) -> None:
        self.root = root.resolve()

    def inside(self, text: str, suffixes: tuple[str, ...] = YAML_SUFFIXES) -> Path:
        """The file of a path that the page named.

        Args:
            text: Relative to the workspace.
            suffixes: Suffixes that its name may have; empty: a folder.

        Raises:
            FileError: It leaves the folder (links are followed), is hidden, or has another suffix.
        """
        rule = "files of the editor lie in its folder or below, links followed, and are not hidden"
        try:
            path = (self.root / text).resolve()
            hidden = any(part.startswith(".") for part in Path(text).parts)
            hidden |= path.is_relative_to(self.root) and any(
                p.startswith(".") for p in path.relative_to(self.root).parts
            )
            if not text or len(text) > 1000 or not text.isprintable() or hidden or not path.is_relative_to(self.root):
                raise FileError(
                    f"'{text[:100]}' is not in the workspace",
                    text[:100] or "nothing",
                    rule,
                    f"choose a place in '{self.root.name}'",
                )
        except (OSError, ValueError, RuntimeError) as error:  # A NUL character, or a loop of links.
            raise FileError(f"'{text[:100]!r}' is not a path", str(error)[:100], rule, "choose another") from None
        longest = max((len(os.fsencode(part)) for part in path.parts), default=0)
        if longest > MAX_NAME:
            raise FileError(
                f"'{text[:100]}' has too long a name",
                f"a part of {longest} bytes",
                f"names have at most {MAX_NAME} bytes, since files beside it have longer ones",
                "shorten it",
            )
        if suffixes and path.suffix.lower() not in suffixes:
            raise FileError(
                f"'{text[:100]}' has another suffix",
                path.suffix or "none",
                f"one of {', '.join(suffixes)}",
                "rename it",
            )
        return path

    def shown(self, path: Path) -> str:
        """A file's path relative to the workspace."""
        return path.relative_to(self.root).as_posix()

    def files(self) -> list[dict[str, Any]]:
        """Descriptions in the workspace, by path; hidden folders are left out."""
        files: list[dict[str, Any]] = []
        scanned = 0
        for folder, folders, names in os.walk(self.root):
            folders[:] = sorted(name for name in folders if not name.startswith((".", "__")))
            scanned += len(names) + len(folders)
            for name in sorted(names):
                path = Path(folder) / name
                if path.suffix.lower() in MODEL_SUFFIXES and not name.startswith(".") and self._is_ours(path):
                    kind = "diagram" if is_diagram(path) else "mechanism"
                    files.append({"path": self.shown(path), "bytes": path.stat().st_size, "kind": kind})
            if len(files) >= MAX_LISTED or scanned > MAX_SCANNED:
                break
        return files[:MAX_LISTED]

    def _is_ours(self, path: Path) -> bool:
        """Whether it is a file, and in here when links are followed."""
        try:
            return path.is_file() and path.resolve().is_relative_to(self.root)
        except (OSError, RuntimeError):  # A loop of links.
            return False


def read_text(path: Path) -> tuple[str, bytes]:
    """A file's text, and its bytes.

    Raises:
        FileError: Not there, not a file, unreadable, too large, or not UTF-8.
    """
    try:
        if not path.is_file():
            raise FileError(
                f"'{path.name}' can't be opened", kind_of(path), "a description is a regular file", "choose another"
            )
        with path.open("rb") as stream:
            data = stream.read(MAX_BYTES + 1)
        if len(data) > MAX_BYTES:
            raise FileError(
                f"'{path.name}' is too large",
                f"more than {MAX_BYTES} bytes",
                "a description is at most 4 MiB long",
                "check which file it is",
            )
        return data.decode("utf-8-sig"), data
    except OSError as error:
        raise FileError(
            f"'{path.name}' can't be read",
            error.strerror or "unreadable",
            "the file is readable",
            "check its permissions",
        ) from None
    except UnicodeDecodeError:
        raise FileError(
            f"'{path.name}' is not UTF-8", "other bytes", "files are in UTF-8", "save it as UTF-8"
        ) from None


def write(path: Path, content: str | bytes) -> None:
    """Write a file, whole or not at all.

    Raises:
        FileError: The folder can't be written to, or the disk is full.
    """
    try:
        write_atomically(path, content)
    except (OSError, UnicodeEncodeError) as error:
        reason = getattr(error, "strerror", None) or str(error)[:100]
        raise FileError(
            f"'{path.name}' can't be written",
            reason,
            "the folder is there and can be written to",
            "make space, or save it elsewhere",
        ) from None


def read_own(path: Path) -> str:
    """The text of a file that the editor keeps beside a document; links are not followed, for it makes none.

    Raises:
        FileError: Not there, a link, or as `read_text`.
    """
    if path.is_symlink():
        raise FileError(f"'{path.name}' is a link", "a link", "the editor's own files are files", "remove it")
    return read_text(path)[0]


def signature(path: Path) -> str:
    """Signature of a file that changes when the file is written; "" where there is none."""
    try:
        stat = path.stat()
    except OSError:
        return ""
    return f"{stat.st_mtime_ns} {stat.st_size} {stat.st_ino}"


def digest(data: bytes) -> str:
    """The identity of a file's content."""
    return hashlib.sha256(data).hexdigest()


def identifier(stem: str) -> str:
    """A name for a file or a system made of any text."""
    return "".join(sign if sign.isalnum() or sign == "_" else "_" for sign in stem)[:100] or "untitled"


def autosave_of(path: Path) -> Path:
    """Path of the file that stores unsaved work on a file."""
    return path.with_name(f".{path.stem}.autosave.yaml")


def base_of(path: Path) -> Path:
    """Path of the record that states which content of a file the unsaved work is based on."""
    return path.with_name(f".{path.stem}.autosave.json")


def layout_of(path: Path) -> Path:
    """Path of the side file with the positions of a file's blocks."""
    return path.with_name(f".{path.stem}.editor.json")


def read_layout(path: Path) -> dict[str, list[float]]:
    """Positions of a file's blocks; none where its side file is missing or unusable."""
    try:
        data = json.loads(read_own(layout_of(path)))["layout"]
    except (FileError, ValueError, KeyError, TypeError, RecursionError):
        return {}
    return positions(data)


def positions(data: Any) -> dict[str, list[float]]:
    """The valid positions in some data: name -> [x, y]."""
    valid: dict[str, list[float]] = {}
    for name, place in data.items() if isinstance(data, dict) else ():
        numbers = isinstance(place, list) and len(place) == 2 and all(type(x) in (int, float) for x in place)
        if numbers and all(abs(x) < 1e7 for x in place):  # False of nan, too.
            valid[str(name)] = [float(x) for x in place]
    return valid
