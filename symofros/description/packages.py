"""Folders that the files of a description may be read from: its own, neighbours that say what they are, those named.

A description is untrusted: what it names is looked for in these folders alone, links followed, wherever it points.
A neighbour is a folder beside that of the description's own package or model, which a file in it declares to be one; a
link to another place is none.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property
from itertools import islice
from pathlib import Path
from xml.parsers import expat

from symofros.description.reading import resolved
from symofros.errors import Argument, DescriptionError

Folders = Mapping[str, str | os.PathLike[str]]

_MANIFEST = "package.xml"
_DECLARE_A_MODEL = ("model.config", "model.sdf")
# Names beside a package that are looked at; bytes of one manifest, and of all together, that are read for their names.
_MAX_NEIGHBOURS = 1000
_MAX_OF_ONE, _MAX_BYTES = 64 << 10, 4 << 20
# Parts of the path of a folder that a remedy may open: / and /etc are everybody's.
_MIN_PARTS = 3
# Characters of a name that a message shows.
MAX_SHOWN = 200
NEIGHBOURS = (
    f"those beside it, {_MAX_NEIGHBOURS} at most, by the <name> in the first {_MAX_OF_ONE >> 10} kB of their "
    f"package.xml, {_MAX_BYTES >> 20} MB of all together"
)


class Packages:
    """Files that may be read for one description.

    Args:
        file: The description's file.
        stated: Name -> folder of packages that the user names.

    Raises:
        DescriptionError: One of these is no folder.
    """

    def __init__(self, file: Path, stated: Folders | None = None) -> None:
        self.folder = resolved(file).parent
        self._names: dict[Path, str] = {}
        self._bytes = 0
        for name, folder in (stated or {}).items():
            if "\0" in os.fspath(folder):
                shown, rule = f"{os.fspath(folder)!r:.{MAX_SHOWN}}", "the path of a folder holds no NUL character"
                raise DescriptionError(f"package '{name:.{MAX_SHOWN}}' is not there", shown, rule, "check the path")
        self.stated = {name: resolved(Path(folder)) for name, folder in (stated or {}).items()}
        for name, folder in self.stated.items():
            if not os.path.isdir(folder):
                raise DescriptionError(
                    f"package '{name:.{MAX_SHOWN}}' is not there",
                    f"'{str(folder):.{MAX_SHOWN}}'",
                    "a package is a folder",
                    "check the path",
                )

    @cached_property
    def own(self) -> Path:
        """Folder of the package that the file is in: the nearest with a package.xml; its own folder without one."""
        above = (self.folder, *self.folder.parents)
        return next((folder for folder in above if (folder / _MANIFEST).is_file()), self.folder)

    @cached_property
    def at_once(self) -> Mapping[str, Path]:
        """Name -> folder of the packages that need no search of neighbours: the file's own, and those stated."""
        names = {name: self.own for name in (self.own.name, self._name_of(self.own)) if name}
        return names | self.stated

    @cached_property
    def neighbours(self) -> Mapping[str, tuple[Path, ...]]:
        """Folders beside the file's package by the names that their manifests state; bounded, as `NEIGHBOURS` says."""
        found: dict[str, tuple[Path, ...]] = {}
        for folder in _beside(self.own) if (self.own / _MANIFEST).is_file() else ():
            if folder != self.own and (name := self._name_of(folder)):
                found[name] = (*found.get(name, ()), folder)
        return found

    @property
    def named(self) -> Mapping[str, Path]:
        """Name -> folder of the packages whose names are unambiguous."""
        names = dict.fromkeys([*self.at_once, *self.neighbours])
        return {name: folders[0] for name in names if len(folders := self.of(name)) == 1}

    def of(self, name: str) -> tuple[Path, ...]:
        """The folders that a package's name may mean: one, none, or several between which nothing decides.

        The file's own and those stated come first, then a neighbour whose folder has that very name, then any other.
        """
        if name in self.at_once:
            return (self.at_once[name],)
        if not _is_plain(name):
            return ()
        beside = self.own.parent / name
        if (self.own / _MANIFEST).is_file() and _is_folder(beside) and self._name_of(beside) == name:
            return (beside,)
        return self.neighbours.get(name, ())

    def _name_of(self, folder: Path) -> str:
        """Name that a package's manifest states; "" where there is none, or it can't be read within the bounds."""
        if folder not in self._names:
            text = _beginning(folder / _MANIFEST, min(_MAX_OF_ONE, _MAX_BYTES - self._bytes))
            self._bytes += len(text)
            self._names[folder] = _name_in(text)
        return self._names[folder]

    def model(self, name: str) -> Path | None:
        """Folder of a model that is named by `model://`; None where there is none to be read."""
        if name in self.stated:
            return self.stated[name]
        if not _is_plain(name):
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
        """The file that a description names, links followed; None where it may not be read."""
        path = resolved(base / name)
        return path if self.allows(path) else None

    def widening(self, path: Path) -> Argument | None:
        """The argument that lets a folder be read; None where none is to be proposed.

        It opens no more than the folder of a file, and no folder that others use: none above the folder two levels up.
        """
        folder = Path(os.path.normpath(path if os.path.isdir(path) else path.parent))
        shared = len(folder.parts) < _MIN_PARTS or not folder.is_relative_to(self.folder.parent.parent)
        if shared or not os.path.isdir(folder) or self.allows(resolved(folder)):
            return None
        return Argument("packages", str(folder), folder.name)


def quoted_folders(folders: Iterable[Path]) -> str:
    """Folders as messages name them."""
    return " and ".join(f"'{str(folder):.{MAX_SHOWN}}'" for folder in islice(folders, 2))


def _is_plain(name: str) -> bool:
    """Whether a name is that of one folder in another."""
    return bool(name) and name not in (".", "..") and not {"/", "\\", "\0"} & set(name)


def _is_folder(path: Path) -> bool:
    """Whether a path is a folder, and no link to one."""
    return os.path.isdir(path) and not os.path.islink(path)


def _beside(folder: Path) -> Iterator[Path]:
    """Folders beside one, which are no links, in the order of their names."""
    try:
        with os.scandir(folder.parent) as entries:
            yield from sorted(Path(e.path) for e in islice(entries, _MAX_NEIGHBOURS) if e.is_dir(follow_symlinks=False))
    except OSError:
        return


def _declares_a_model(folder: Path) -> bool:
    return any(os.path.isfile(folder / name) for name in _DECLARE_A_MODEL)


def _beginning(manifest: Path, most: int) -> bytes:
    """The first bytes of a package's manifest; none where it is no regular file of its folder."""
    if most <= 0 or not os.path.isfile(manifest) or resolved(manifest).parent != manifest.parent:
        return b""
    try:
        with manifest.open("rb") as stream:
            return stream.read(most)
    except OSError:
        return b""


class _Named(Exception):
    """Ends the reading of a manifest at the end of its <name>."""


def _name_in(text: bytes) -> str:
    """The text of <name> below the root element in the beginning of a document; "" where there is none."""
    parser, open_tags, name = expat.ParserCreate(), list[str](), list[str]()

    def end(_: str) -> None:
        if open_tags.pop() == "name" and len(open_tags) == 1:
            raise _Named

    def characters(piece: str) -> None:
        if len(open_tags) == 2 and open_tags[1] == "name":
            name.append(piece)

    def doctype(*_: object) -> None:
        raise ValueError("document types define entities")

    parser.StartElementHandler = lambda tag, _: open_tags.append(tag)
    parser.EndElementHandler, parser.CharacterDataHandler = end, characters
    parser.StartDoctypeDeclHandler = doctype
    try:
        parser.Parse(text, False)
    except _Named:
        return "".join(name).strip()
    except (expat.ExpatError, LookupError, ValueError):
        return ""
    return ""
