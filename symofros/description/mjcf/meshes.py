"""Meshes of an MJCF model: those that give a body its inertia are read, all others are cut out.

A mesh's file is needed if its shape is on a body that moves, that states no <inertial>, and the shape has mass and is
of a group that counts. Of other shapes of meshes MuJoCo gets a sphere without mass, whose name says which file is drawn
in its place (`drawn_index`).
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import PurePosixPath

from symofros.description.mjcf.files import Folder
from symofros.description.remarks import Remarks
from symofros.description.urdf.values import finite_numbers
from symofros.description.visual import MAX_VISUALS
from symofros.description.xml_nodes import Element

_TREE = ("body", "frame", "replicate")
SEEN_GROUPS = range(3)  # Those that MuJoCo's own viewer shows at first.
_PLACEMENT = ("pos", "quat", "axisangle", "xyaxes", "zaxis", "euler", "class", "group", "rgba", "material")
_DRAWN_NAME = re.compile(r"symofros drawn mesh (\d{1,6}):")


@dataclass(frozen=True)
class DrawnMesh:
    """A file that is drawn: corner p of it is at diag(scale) R(refquat)^T (p - refpos) in the frame of its shape.

    Attributes:
        file: Its path.
        scale: Factors along the axes of the shape.
        refpos: As MuJoCo defines it (3) [m].
        refquat: As MuJoCo defines it (w, x, y, z), of any length but zero.
    """

    file: str
    scale: tuple[float, ...]
    refpos: tuple[float, ...]
    refquat: tuple[float, ...]


def drawn_index(name: str) -> int:
    """Index in `Meshes.drawn` of the mesh that a shape of that name stands for; -1 of any other."""
    found = _DRAWN_NAME.match(name)
    return int(found[1]) if found else -1


class Meshes:
    """Cuts shapes with files out of a document, and reads the files that are needed.

    Args:
        folder: Folder of the model.
        document: Document with everything in it that is kept.
        stated: The document as it was written, which says where meshes lie.
        remarks: Remarks on what is ignored.

    Attributes:
        assets: Content of the files that MuJoCo needs, by the names that the document now has for them.
        drawn: Meshes that shapes without mass stand for.
        by_name: Those that MuJoCo reads and that can be drawn, by their names.
    """

    def __init__(self, folder: Folder, document: Element, stated: Element, remarks: Remarks) -> None:
        self.folder = folder
        self.document = document
        self.remarks = remarks
        self.assets: dict[str, bytes] = {}
        self.drawn: list[DrawnMesh] = []
        self.by_name: dict[str, DrawnMesh] = {}
        self._needed: dict[str, str] = {}
        self._classes = defaults(document, "geom")
        self._mesh_classes = defaults(document, "mesh")
        self._stated = {asset_name(mesh): mesh for asset in document.all("asset") for mesh in asset.all("mesh")}
        self._settings = settings = compiler_settings(stated)
        self._from_shapes = settings.get("inertiafromgeom") == "true"
        # Scaling to a total mass counts bodies that never move.
        self._total = "settotalmass" in settings
        self._base = settings.get("meshdir", settings.get("assetdir", ""))
        self._groups = settings.get("inertiagrouprange", "")

    def cut(self) -> None:
        """Remove assets, and shapes from files, that give no body its inertia; load the meshes that stay."""
        for world in self.document.all("worldbody"):
            self._visit(world, "main", self._total, False)
        for asset in self.document.all("asset"):
            asset.children = [
                child for child in asset.children if child.tag != "mesh" or asset_name(child) in self._needed
            ]
            for mesh in asset.all("mesh"):
                drawn = self._drawn(asset_name(mesh))
                if drawn is not None:
                    self.by_name[asset_name(mesh)] = drawn
                self._load(mesh)

    def _visit(self, place: Element, inherited: str, moves: bool, has_inertia: bool) -> None:
        """One body or frame: which of its shapes stay."""
        childclass = place.attributes.get("childclass", inherited)
        if place.tag == "body":
            moves = moves or any(_joints(place))
            has_inertia = place.first("inertial") is not None and not self._from_shapes
        children: list[Element] = []
        for child in place.children:
            if child.tag in _TREE:
                self._visit(child, childclass, moves, has_inertia)
            elif child.tag == "geom":
                stated = self._classes.get(child.attributes.get("class", childclass), {}) | child.attributes
                if not self._stays(child, stated, moves and not has_inertia):
                    children += self._placeholder(child, stated)
                    continue
            children.append(child)
        place.children = children

    def _stays(self, geom: Element, stated: dict[str, str], gives_inertia: bool) -> bool:
        mesh = stated.get("mesh")
        if mesh is None and "hfield" not in stated and stated.get("type") != "hfield":
            return True
        massless = _is_zero(stated["mass"] if "mass" in stated else stated.get("density", ""))
        if mesh is None or massless or not gives_inertia or not self._counts(stated.get("group", "0")):
            self.remarks.add(
                "shapes from files give no inertia and touch nothing",
                "shape",
                geom.attributes.get("name") or mesh or f"line {geom.line}",
            )
            return False
        self._needed[mesh] = f"mesh '{mesh}', which a body has its inertia from"
        return True

    def _placeholder(self, geom: Element, stated: dict[str, str]) -> Iterator[Element]:
        """A massless sphere where a mesh is cut out, by which its picture is placed; none if it is not drawn."""
        named = geom.attributes.get("mesh", "")  # By a class of defaults, it would be asked for again.
        is_seen = stated.get("group", "0") in map(str, SEEN_GROUPS) and stated.get("type") == "mesh"
        drawn = self._drawn(named) if is_seen and len(self.drawn) < MAX_VISUALS else None
        if drawn is None:
            return
        attributes = {key: text for key, text in geom.attributes.items() if key in _PLACEMENT}
        attributes |= {"type": "sphere", "size": "1", "mass": "0", "contype": "0", "conaffinity": "0"}
        attributes["name"] = f"symofros drawn mesh {len(self.drawn)}:"
        self.drawn.append(drawn)
        yield replace(geom, attributes=attributes)

    def _drawn(self, name: str) -> DrawnMesh | None:
        """The file of a mesh, where it may be read and its numbers say how it is drawn."""
        mesh = self._stated.get(name)
        if mesh is None or "file" not in mesh.attributes:
            return None
        stated = self._mesh_classes.get(mesh.attributes.get("class", "main"), {}) | mesh.attributes
        path = self.folder.seen(self._path(mesh.attributes["file"]))
        scale = finite_numbers(stated.get("scale", "1 1 1"), 3)
        refpos = finite_numbers(stated.get("refpos", "0 0 0"), 3)
        refquat = finite_numbers(stated.get("refquat", "1 0 0 0"), 4)
        if not path or scale is None or refpos is None or refquat is None or not any(refquat):
            return None
        return DrawnMesh(path, scale, refpos, refquat)

    def _path(self, file: str) -> str:
        """The name of a mesh's file from the model's folder on."""
        return asset_path(file, self._base, self._settings)

    def _counts(self, group: str) -> bool:
        """Whether shapes of a group give inertia; they do where the text is not clear."""
        try:
            first, last = map(int, self._groups.split())
            return first <= int(group) <= last
        except ValueError:
            return True

    def _load(self, mesh: Element) -> None:
        """Read a mesh's file, and let the document call it by a name without a path."""
        name = asset_name(mesh)
        if "builtin" in mesh.attributes:
            self.folder.fault(
                mesh,
                f"mesh '{name}' is procedural",
                f"builtin '{mesh.attributes['builtin']:.60}'",
                "a mesh that gives a body its inertia is a file or a list of vertices",
                "give the body an <inertial>",
            )
        file = mesh.attributes.get("file")
        if file is None:
            return
        path = self._path(file)
        data = self.folder.mesh(path, mesh, self._needed[name])
        if data is not None:
            asset = f"mesh{len(self.assets)}{PurePosixPath(path).suffix}"
            self.assets[asset] = data
            mesh.attributes |= {"name": name, "file": asset}


def asset_name(asset: Element) -> str:
    """Name of a mesh or another asset; the stem of its file's name if it has none."""
    return asset.attributes.get("name") or PurePosixPath(asset.attributes.get("file", "").replace("\\", "/")).stem


def asset_path(file: str, base: str, settings: dict[str, str]) -> str:
    """The name of an asset's file from the model's folder on.

    Args:
        file: As the asset states it.
        base: Folder of files of its kind; "" for the model's own.
        settings: Attributes of <compiler>.
    """
    stated = file.replace("\\", "/")
    if settings.get("strippath") == "true":
        stated = PurePosixPath(stated).name
    return f"{base}/{stated}" if base else stated


def compiler_settings(stated: Element) -> dict[str, str]:
    """Attributes of <compiler>, of several the last."""
    settings: dict[str, str] = {}
    for compiler in stated.all("compiler"):
        settings |= compiler.attributes
    return settings


def _joints(place: Element) -> Iterator[Element]:
    """The joints of a body, also of the frames in it, but not of the bodies in it."""
    for child in place.children:
        if child.tag in ("joint", "freejoint"):
            yield child
        elif child.tag in ("frame", "replicate"):
            yield from _joints(child)


def defaults(document: Element, tag: str) -> dict[str, dict[str, str]]:
    """Class of defaults -> attributes of its elements of a tag, inherited ones included."""
    classes: dict[str, dict[str, str]] = {"main": {}}

    def visit(default: Element, name: str, inherited: dict[str, str]) -> None:
        own = dict(inherited)
        for element in default.all(tag):
            own |= element.attributes
        classes[name] = classes.get(name, {}) | own
        for inner in default.all("default"):
            visit(inner, inner.attributes.get("class", ""), own)

    for default in document.all("default"):
        visit(default, "main", classes["main"])
        classes[default.attributes.get("class", "main")] = classes["main"]
    return classes


def _is_zero(text: str) -> bool:
    try:
        return float(text) == 0.0
    except ValueError:
        return False
