"""Folders that the files of a description may be read from: its own, neighbours that say what they are, those named.

A description is untrusted: what it names is looked for in these folders alone, links followed, wherever it points.
A neighbour is a folder beside that of the description's own package or model, which a file in it declares to be one; a
link to another place is none.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from functools import cached_property
from pathlib import Path

from symofros.description.reading import read_bytes, resolved
from symofros.description.xml_nodes import Element, XmlFault, parse_xml
from symofros.errors import Argument, DescriptionError, Problem

Folders = Mapping[str, str | os.PathLike[str]]

_MANIFEST = "package.xml"
_DECLARE_A_MODEL = ("model.config", "model.sdf")
_MOST_NEIGHBOURS = 1000
_MOST_BYTES = 1 << 20


class Packages:
    """What may be read for one description.

    Args:
        file: The description's file.
        stated: Name -> folder of packages that the user names.

    Raises:
        DescriptionError: One of these is no folder.
    """

    def __init__(self, file: Path, stated: Folders | None = None) -> None:
        self.folder = resolved(file).parent
        self.stated = {name: resolved(Path(folder)) for name, folder in (stated or {}).items()}
        for name, folder in self.stated.items():
            if not folder.is_dir():
                raise DescriptionError(
                    Problem(f"package '{name}' is not there", f"'{folder}'", "a package is a folder", "check the path")
                )

    @cached_property
    def own(self) -> Path:
        """Folder of the package that the file is in: the nearest with a package.xml; its own folder without one."""
        above = (self.folder, *self.folder.parents)
        return next((folder for folder in above if (folder / _MANIFEST).is_file()), self.folder)

    @cached_property
    def named(self) -> Mapping[str, Path]:
        """Packages by name: those stated, the file's own, and its neighbours in a workspace."""
        names = {name: self.own for name in (self.own.name, _name_of(self.own)) if name}
        if not (self.own / _MANIFEST).is_file():
            return names | self.stated
        beside = {name: folder for folder in _beside(self.own) if (name := _name_of(folder))}
        return {**beside, **names, **self.stated}

    def model(self, name: str) -> Path | None:
        """Folder of a model that is named by `model://`; None where there is none to be read."""
        if name in self.stated:
            return self.stated[name]
        if not name or name in (".", "..") or {"/", "\\", "\0"} & set(name):
            return None
        folders = (place / name for place in (self.folder, *self.stated.values(), self.folder.parent))
        return next((inner for inner in map(resolved, folders) if os.path.isdir(inner) and self.allows(inner)), None)

    def allows(self, path: Path) -> bool:
        """Whether a path without links lies in the description's folder, in a stated one, or in a neighbour's."""
        if any(path.is_relative_to(folder) for folder in (self.folder, *self.stated.values())):
            return True
        around = self.folder.parent
        if not path.is_relative_to(around) or path == around or not _declares_a_model(self.folder):
            return False
        return _declares_a_model(around / path.relative_to(around).parts[0])

    def file(self, name: str, base: Path) -> Path | None:
        """The file that a description names, links followed; None where it may not be read.

        Args:
            name: Path as the description states it.
            base: Folder that the path starts from.
        """
        path = resolved(base / name)
        return path if self.allows(path) else None


def widening(path: Path) -> Argument:
    """The argument that lets a folder be read."""
    folder = Path(os.path.normpath(path))
    return Argument("packages", str(folder), folder.name or "root")


def _beside(folder: Path) -> Iterator[Path]:
    """Folders beside one, which are no links."""
    try:
        with os.scandir(folder.parent) as entries:
            for count, entry in enumerate(entries):
                if count >= _MOST_NEIGHBOURS:
                    return
                if entry.is_dir(follow_symlinks=False):
                    yield Path(entry.path)
    except OSError:
        return


def _declares_a_model(folder: Path) -> bool:
    return any(os.path.isfile(folder / name) for name in _DECLARE_A_MODEL)


def _name_of(folder: Path) -> str:
    """Name that a package's manifest states; "" where there is none, or it can't be read."""
    manifest = folder / _MANIFEST
    if not os.path.isfile(manifest) or resolved(manifest).parent != folder:
        return ""
    try:
        root: Element = parse_xml(read_bytes(manifest, _MOST_BYTES), str(manifest))
    except (DescriptionError, XmlFault):
        return ""
    name = root.first("name")
    return "" if name is None else name.text
