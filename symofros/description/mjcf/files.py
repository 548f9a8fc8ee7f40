"""The files of an MJCF model: its own, those it includes, its meshes; none from other folders than those given."""

from __future__ import annotations

import os
from pathlib import Path, PurePosixPath, PureWindowsPath

from symofros.description.packages import MAX_SHOWN, Packages
from symofros.description.reading import read_bytes, resolved
from symofros.description.xml_nodes import MAX_DEPTH, Element, parse_xml
from symofros.errors import Argument, DescriptionError, Problem

MAX_BYTES = 16 << 20
MAX_MESH_BYTES = 256 << 20
# Ten thousand bodies with a joint and a shape each; MuJoCo's time grows with the square.
MAX_ELEMENTS = 30_000


class Folder:
    """The folder of a model's main file, with others that may be read, and what was read from them.

    Attributes:
        main: The model's main file.
        packages: What may be read.
        problems: Every fault met.
    """

    def __init__(self, main: Path, packages: Packages | None = None) -> None:
        self.main = main
        self.packages = packages or Packages(main)
        self.problems: list[Problem] = []
        self._read: set[Path] = set()
        self._bytes = {MAX_BYTES: 0, MAX_MESH_BYTES: 0}
        self._elements = 0

    def document(self) -> Element:
        """The main file with its includes in their places.

        Raises:
            DescriptionError: A file is no XML.
            DescriptionError: A file can't be read, or all together are too large.
        """
        root = self._parsed(resolved(self.main), str(self.main))
        self._expand(root, self.main.parent, 1)
        return root

    def mesh(self, file: str, user: Element, what: str) -> bytes | None:
        """The content of a mesh file; None after a fault."""
        path = self._place(file, user, self.main.parent)
        if path is None:
            return None
        try:
            return self._bounded(path, MAX_MESH_BYTES)
        except DescriptionError as error:
            reason = error.problems[0].found
            self.fault(
                user,
                f"{what}: its file can't be read",
                f"'{file:.{MAX_SHOWN}}': {reason}",
                "a mesh that gives a body its inertia lies in the model's folder",
                "put the file there, or give the body an <inertial>",
            )
            return None

    def seen(self, file: str) -> str:
        """The path of a file that is drawn, as the model states it; "" of one that is not there or may not be read."""
        name = _relative(file)
        path = None if name is None else self.packages.file(name, self.main.parent)
        return str(path) if path is not None and os.path.isfile(path) else ""

    def fault(
        self,
        element: Element,
        what: str,
        found: str,
        rule: str,
        remedy: str = "",
        argument: Argument | None = None,
    ) -> None:
        """Note a problem."""
        self.problems.append(Problem(what, found, rule, remedy, element.where, argument))

    def _parsed(self, path: Path, shown: str) -> Element:
        self._read.add(path)
        root = parse_xml(self._bounded(path, MAX_BYTES), shown)
        self._elements += size(root)
        if self._elements > MAX_ELEMENTS:
            problem = Problem(
                "the model is too large", f"{self._elements} elements", f"at most {MAX_ELEMENTS}", "split it", shown
            )
            raise DescriptionError(problem)
        return root

    def _bounded(self, path: Path, limit: int) -> bytes:
        """A file's content; the limit is on all files of its kind together."""
        data = read_bytes(path, limit - self._bytes[limit])
        self._bytes[limit] += len(data)
        return data

    def _expand(self, element: Element, folder: Path, depth: int) -> None:
        """Replace each <include> in an element, at any depth, by the included elements."""
        if depth > MAX_DEPTH:
            raise DescriptionError(
                f"nested deeper than {MAX_DEPTH}, includes counted",
                f"<{element.tag:.60}>",
                "a robot needs fewer",
                "check that it is the file you meant",
                element.where,
            )
        children: list[Element] = []
        for child in element.children:
            if child.tag == "include":
                children += self._included(child, folder, depth)
            else:
                self._expand(child, folder, depth + 1)
                children.append(child)
        element.children = children

    def _included(self, include: Element, folder: Path, depth: int) -> list[Element]:
        file = include.attributes.get("file")
        if file is None:
            given = ", ".join(include.attributes) or "no attributes"
            self.fault(
                include,
                "<include> lacks the attribute 'file'",
                given,
                "<include> names a file",
                'write <include file="…"/>',
            )
            return []
        # From the main file's folder, or else from that of the file that includes it.
        path = self._place(file, include, *dict.fromkeys((self.main.parent, folder)))
        if path is None:
            return []
        if path in self._read:
            self.fault(
                include,
                f"'{file:.{MAX_SHOWN}}' is included twice",
                f"'{path.name}' again",
                "a file is included once at most, and never by itself",
                "remove one <include>",
            )
            return []
        try:
            root = self._parsed(path, str(path))
        except DescriptionError as error:
            refusal = error.problems[0]
            self.fault(
                include,
                f"'{file:.{MAX_SHOWN}}' can't be included",
                refusal.found,
                refusal.rule or "the file exists",
                refusal.remedy,
            )
            return []
        self._expand(root, path.parent, depth)
        return root.children

    def _place(self, file: str, user: Element, *bases: Path) -> Path | None:
        """The path of a file that a model names, links followed; None, after a fault, where it may not be read.

        Args:
            file: File name as the model states it.
            user: The element that states it.
            bases: Folders that it may start from, in the order in which they are tried.
        """
        name = _relative(file)
        paths = [] if name is None else [self.packages.file(name, base) for base in bases]
        inside = [path for path in paths if path is not None]
        found = next((path for path in inside if os.path.isfile(path)), None)
        if found is not None or (inside and len(inside) == len(paths)):
            return found or inside[0]
        argument = None
        if name is not None:
            there = (base for base in bases if os.path.isfile(base / name))
            argument = self.packages.widening(resolved(next(there, bases[-1])) / PurePosixPath(name).parent)
        widened = f", or, of a file that you trust, name its folder: {argument.call}" if argument else ""
        self.fault(
            user,
            f"<{user.tag}> leaves the model's folder",
            f"'{file:.80}'",
            "files of a model lie in the folder of its main file or below, or in folders that you name as packages",
            f"copy the file into '{self.packages.folder}'{widened}",
            argument,
        )
        return None


def _relative(file: str) -> str | None:
    """A file name with slashes; None of one that is absolute, or none."""
    plain = PurePosixPath(file.replace("\\", "/"))
    return None if plain.is_absolute() or PureWindowsPath(file).drive or "\0" in file else str(plain)


def size(element: Element) -> int:
    """Number of XML elements in the subtree of an element, itself included."""
    return 1 + sum(map(size, element.children))
