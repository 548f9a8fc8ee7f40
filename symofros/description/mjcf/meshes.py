"""Meshes of an MJCF model: those that give a body its inertia are read, all others are cut out.

A mesh's file is needed if its shape is on a body that moves, that states no <inertial>, and the shape has mass and is
of a group that counts.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import PurePosixPath

from symofros.description.mjcf.files import Folder
from symofros.description.remarks import Remarks
from symofros.description.xml_nodes import Element

_TREE = ("body", "frame", "replicate")


class Meshes:
    """Cuts shapes with files out of a document, and reads the files that are needed.

    Args:
        folder: Folder of the model.
        document: Document with everything in it that is kept.
        stated: The document as it was written, which says where meshes lie.
        remarks: Remarks on what is ignored.

    Attributes:
        assets: Content of the files that MuJoCo needs, by the names that the document now has for them.
    """

    def __init__(self, folder: Folder, document: Element, stated: Element, remarks: Remarks) -> None:
        self.folder = folder
        self.document = document
        self.remarks = remarks
        self.assets: dict[str, bytes] = {}
        self._needed: dict[str, str] = {}
        self._classes = _geom_defaults(document)
        settings: dict[str, str] = {}
        for compiler in stated.all("compiler"):
            settings |= compiler.attributes
        self._from_shapes = settings.get("inertiafromgeom") == "true"
        # Scaling to a total mass counts bodies that never move.
        self._total = "settotalmass" in settings
        self._base = settings.get("meshdir", settings.get("assetdir", ""))
        self._groups = settings.get("inertiagrouprange", "")
        self._bare_names = settings.get("strippath") == "true"

    def cut(self) -> None:
        """Remove assets, and shapes from files, that give no body its inertia; load the meshes that stay."""
        for world in self.document.all("worldbody"):
            self._visit(world, "main", self._total, False)
        for asset in self.document.all("asset"):
            asset.children = [mesh for mesh in asset.children if _mesh_name(mesh) in self._needed]
            for mesh in asset.children:
                self._load(mesh)

    def _visit(self, place: Element, inherited: str, moves: bool, has_inertia: bool) -> None:
        """One body or frame: which of its shapes stay."""
        childclass = place.attributes.get("childclass", inherited)
        if place.tag == "body":
            moves = moves or any(_joints(place))
            has_inertia = place.first("inertial") is not None and not self._from_shapes
        children = []
        for child in place.children:
            if child.tag in _TREE:
                self._visit(child, childclass, moves, has_inertia)
            elif child.tag == "geom" and not self._stays(child, childclass, moves and not has_inertia):
                continue
            children.append(child)
        place.children = children

    def _stays(self, geom: Element, childclass: str, gives_inertia: bool) -> bool:
        stated = self._classes.get(geom.attributes.get("class", childclass), {}) | geom.attributes
        mesh = stated.get("mesh")
        if mesh is None and "hfield" not in stated and stated.get("type") != "hfield":
            return True
        massless = _is_zero(stated["mass"] if "mass" in stated else stated.get("density", ""))
        if mesh is None or massless or not gives_inertia or not self._counts(stated.get("group", "0")):
            self.remarks.add(
                "shapes from files ignored, they give no inertia",
                "shape",
                geom.attributes.get("name") or mesh or f"line {geom.line}",
            )
            return False
        self._needed[mesh] = f"mesh '{mesh}', which a body has its inertia from"
        return True

    def _counts(self, group: str) -> bool:
        """Whether shapes of a group give inertia; they do where the text is not clear."""
        try:
            first, last = map(int, self._groups.split())
            return first <= int(group) <= last
        except ValueError:
            return True

    def _load(self, mesh: Element) -> None:
        """Read a mesh's file, and let the document call it by a name without a path."""
        name = _mesh_name(mesh)
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
        stated = file.replace("\\", "/")
        if self._bare_names:
            stated = PurePosixPath(stated).name
        data = self.folder.mesh(f"{self._base}/{stated}" if self._base else stated, mesh, self._needed[name])
        if data is not None:
            asset = f"mesh{len(self.assets)}{PurePosixPath(stated).suffix}"
            self.assets[asset] = data
            mesh.attributes |= {"name": name, "file": asset}


def _mesh_name(mesh: Element) -> str:
    """Name of a mesh; the stem of its file's name if it has none."""
    return mesh.attributes.get("name") or PurePosixPath(mesh.attributes.get("file", "").replace("\\", "/")).stem


def _joints(place: Element) -> Iterator[Element]:
    """The joints of a body, also of the frames in it, but not of the bodies in it."""
    for child in place.children:
        if child.tag in ("joint", "freejoint"):
            yield child
        elif child.tag in ("frame", "replicate"):
            yield from _joints(child)


def _geom_defaults(document: Element) -> dict[str, dict[str, str]]:
    """Class of defaults -> attributes of its geoms, inherited ones included."""
    classes: dict[str, dict[str, str]] = {"main": {}}

    def visit(default: Element, name: str, inherited: dict[str, str]) -> None:
        own = dict(inherited)
        for geom in default.all("geom"):
            own |= geom.attributes
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
