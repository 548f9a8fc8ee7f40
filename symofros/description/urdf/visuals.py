"""The <visual> elements of a URDF. What can't be drawn is no fault of a mechanism: it is left out, and that is said.

A file is untrusted: a mesh lies in the folder of its file or below, or in the package that it names, where that is one
of the folders above or one that may be read (`Packages`). Meshes are not opened here.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping
from itertools import chain
from pathlib import Path, PurePosixPath

from symofros.description.packages import Packages, quoted_folders
from symofros.description.reading import resolved
from symofros.description.remarks import Remarks
from symofros.description.urdf.values import finite_numbers
from symofros.description.values import Rotation
from symofros.description.visual import MAX_VISUALS, Visual, VisualKind, color_of
from symofros.description.xml_nodes import Element

Color = tuple[int, int, int]

_PACKAGE = re.compile(r"(?:package|model)://([^/]+)/(.+)\Z")
_KINDS: dict[str, VisualKind] = {
    "box": "box",
    "sphere": "sphere",
    "cylinder": "cylinder",
    "capsule": "capsule",
    "mesh": "mesh",
}
# Attributes that state a size, and what they are where they are not there.
_ROUND = (("radius", ""), ("length", ""))
_SIZES = {
    "box": (("size", ""),),
    "sphere": _ROUND[:1],
    "cylinder": _ROUND,
    "capsule": _ROUND,
    "mesh": (("scale", "1 1 1"),),
}


class Visuals:
    """Reads what links look like.

    Args:
        packages: Folders that may be read.
        robot: Root element, for materials that links share.
        remarks: Remarks on what is left out.
    """

    def __init__(self, packages: Packages, robot: Element, remarks: Remarks) -> None:
        self.packages, self.folder = packages, packages.folder
        self.remarks = remarks
        self.count = 0
        named = ((element.attributes.get("name", ""), _color(element)) for element in robot.all("material"))
        self.materials: Mapping[str, Color] = {name: color for name, color in named if color is not None}

    def of(self, link: Element, name: str, folder: Path | None = None) -> tuple[Visual, ...]:
        """The shapes of a link.

        Args:
            link: The element.
            name: Name of the link.
            folder: Folder of its file, where that is another than the main file's.
        """
        return tuple(self._shapes(link, name, self.folder if folder is None else resolved(folder)))

    def _shapes(self, link: Element, name: str, folder: Path) -> Iterator[Visual]:
        for element in link.all("visual"):
            shape = self._shape(element, folder) if self.count < MAX_VISUALS else None
            if shape is None:
                self.remarks.add("visual shapes that can't be drawn ignored", "link", name)
            else:
                self.count += 1
                yield shape

    def _shape(self, element: Element, folder: Path) -> Visual | None:
        geometry, origin = element.first("geometry"), element.first("origin")
        stated = geometry.children[0] if geometry is not None and geometry.children else None
        kind = _KINDS.get(stated.tag) if stated is not None else None
        placed = {} if origin is None else origin.attributes
        position, angles = (finite_numbers(placed.get(name, "0 0 0"), 3) for name in ("xyz", "rpy"))
        if stated is None or kind is None or position is None or angles is None:
            return None
        numbers = " ".join(stated.attributes.get(name, default) for name, default in _SIZES[kind])
        size = finite_numbers(numbers, 3 if kind in ("box", "mesh") else len(_SIZES[kind]))
        file = self._file(stated.attributes.get("filename", ""), folder) if kind == "mesh" else ""
        if size is None or (not file if kind == "mesh" else min(size) <= 0.0):
            return None
        x, y, z = position
        return Visual(kind, size, (x, y, z), Rotation.rpy(*angles), self._look(element), file)

    def _look(self, element: Element) -> Color | None:
        material = element.first("material")
        if material is None:
            return None
        return _color(material) or self.materials.get(material.attributes.get("name", ""))

    def _file(self, stated: str, folder: Path) -> str:
        """Path of the file of a mesh; "" if it is not found or must not be read."""
        package = _PACKAGE.match(stated)
        name, inner = (package[1], PurePosixPath(package[2])) if package else ("", PurePosixPath(stated))
        if "://" in str(inner) or inner.is_absolute() or ".." in (name, *inner.parts) or "\0" in stated:
            return ""
        above = [root for root in (folder, *folder.parents) if package and root.name == name]
        places = [*((root, root) for root in above), (folder, folder), (folder, folder / name)]
        for root, place in chain(places, self._elsewhere(name) if package else ()):
            # Unlike pathlib's, these are content with names that can't be: too long, links in a circle.
            path = os.path.realpath(place / inner)
            if Path(path).is_relative_to(root) and os.path.isfile(path):
                return path
        return ""

    def _elsewhere(self, name: str) -> Iterator[tuple[Path, Path]]:
        """(root, place) of a package or model outside the folders around the file; searched only when needed."""
        folders = self.packages.of(name)
        if len(folders) > 1:
            self.remarks.add(
                "packages of one name, of which none is taken", "package", f"{name} in {quoted_folders(folders)}"
            )
        known = next(iter(folders), None) if len(folders) == 1 else self.packages.model(name)
        if known is not None:
            yield known, known


def _color(material: Element) -> Color | None:
    color = material.first("color")
    shares = finite_numbers(color.attributes.get("rgba", ""), 4) if color is not None else None
    return None if shares is None else color_of(shares)
