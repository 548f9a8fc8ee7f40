"""Triangles of a COLLADA file (.dae), read by pycollada.

Robots come with meshes from anywhere, and pycollada trusts its file: it unpacks archives, opens what is referred to,
follows instances of nodes without limit and ignores strides. So it is handed a copy of the part that is drawn, checked
beforehand: geometries and the nodes that place them; no images, lights, skins and animations. Of materials the colour
of diffuse light is read here: a texture's place is in a picture, which is not opened.
"""

from __future__ import annotations

import io
import math
import re
from collections.abc import Iterator, Mapping
from contextlib import suppress
from importlib import import_module
from typing import Any
from xml.etree import ElementTree

import numpy as np

from symofros.base.arrays import Array
from symofros.description import color_of
from symofros.studio.viewer.drawing.drawing import Color
from symofros.studio.viewer.drawing.meshes import Faces, Mesh, merged

# Rotations from the axes of a file to ours, z upwards.
_UPWARDS = {
    "Y_UP": np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]),
    "X_UP": np.array([[0.0, -1, 0], [0, 0, -1], [1, 0, 0]]),
}
# It writes Y_UP whatever the axes of the mesh are that it saves.
_AXES_NOT_MEANT = "MeshLab"
_MAX_NODES, _DEEPEST = 10_000, 50

# What is kept of each element; elements that are not named keep all.
_KEPT = {
    "COLLADA": {"asset", "library_geometries", "library_nodes", "library_visual_scenes", "scene"},
    "scene": {"instance_visual_scene"},
    "visual_scene": {"node"},
    "node": {"node", "instance_node", "instance_geometry", "matrix", "translate", "rotate", "scale", "skew", "lookat"},
    "instance_geometry": set[str](),
    "instance_node": set[str](),
    "geometry": {"mesh"},
    "mesh": {"source", "vertices", "triangles", "tristrips", "trifans", "polylist", "polygons"},
}
_NOT_NUMBERS = re.compile(r"[^\s\d.eE+-]\S*")
Element = ElementTree.Element


def read_collada(data: bytes, most_faces: int) -> Mesh:
    """All triangles of a file as one mesh [m], in single precision, z upwards.

    Raises:
        ValueError: It is no such file, has more triangles than that, or pycollada is not installed.
    """
    try:
        collada = import_module("collada")
    except ImportError:
        raise ValueError("pycollada is not installed; pip install 'symofros[view]'") from None
    try:
        root = ElementTree.fromstring(data, ElementTree.XMLParser(target=_Builder()))
        colors = _colors(root)
        document = collada.Collada(io.BytesIO(_drawn_part(root)))
        return _to_metres(merged(list(_placed(document, most_faces, colors))), document.assetInfo)
    except ValueError:
        raise
    except Exception as error:  # noqa: BLE001 - pycollada raises whatever a bad file makes it stumble over.
        raise ValueError(f"{type(error).__name__}: {getattr(error, 'msg', error)}") from None


class _Builder(ElementTree.TreeBuilder):
    """Elements without their namespace."""

    def start(self, tag: Any, attrs: Any) -> Element:
        return super().start(tag.rpartition("}")[2], attrs)

    def end(self, tag: Any) -> Element:
        return super().end(tag.rpartition("}")[2])

    def doctype(self, *_: object) -> None:
        raise ValueError("document types are refused")


def _colors(root: Element) -> dict[str, Color]:
    """Diffuse colour by the names that primitives have for materials; of two scenes' bindings of a name the first."""
    of_effect: dict[str, Color] = {}
    for effect in root.iter("effect"):
        text = next((found for diffuse in effect.iter("diffuse") if (found := diffuse.findtext("color"))), "")
        with suppress(ValueError):  # The shape is drawn without a colour that is none.
            shares = [float(share) for share in text.split()[:3]]
            if len(shares) == 3 and all(map(math.isfinite, shares)):
                of_effect[effect.get("id", "")] = color_of(shares)
    of_material: dict[str, Color] = {}
    for material in root.iter("material"):
        instance = material.find("instance_effect")
        effect_id = "" if instance is None else instance.get("url", "").removeprefix("#")
        if effect_id in of_effect:
            of_material[material.get("id", "")] = of_effect[effect_id]
    bound: dict[str, Color] = {}
    for use in root.iter("instance_material"):
        target = use.get("target", "").removeprefix("#")
        if target in of_material:
            bound.setdefault(use.get("symbol", ""), of_material[target])
    return of_material | bound


def _drawn_part(root: Element) -> bytes:
    """The XML text of a document's geometries and nodes alone; the others are taken out of it.

    Raises:
        ValueError: Reading it would take without bound, or give another mesh than the file describes.
    """
    if root.tag != "COLLADA":
        raise ValueError(f"the root element is <{root.tag[:40]}>, not <COLLADA>")
    for element in list(root.iter()):
        if element.tag in _KEPT:
            element[:] = [child for child in element if child.tag in _KEPT[element.tag]]
    for element in root.iter():
        _check_element(element)
    by_id = {node.get("id", ""): node for node in root.iter("node")}
    total = 0
    for scene in root.iter("visual_scene"):
        for _ in _nodes_below(scene, by_id, 0):
            total += 1
            if total > _MAX_NODES:
                raise ValueError(f"more than {_MAX_NODES} nodes")
    root.set("xmlns", "http://www.collada.org/2005/11/COLLADASchema")
    return ElementTree.tostring(root)


def _check_element(element: Element) -> None:
    """Refuse elements that pycollada would skip or allocate too much memory for.

    Raises:
        ValueError: As it says.
    """
    text = element.text or ""
    if element.tag in ("float_array", "p", "vcount", "matrix", "translate", "rotate", "scale", "lookat"):
        word = _NOT_NUMBERS.search(text)
        if word is not None:
            raise ValueError(f"'{word[0][:40]}' in <{element.tag}> is not a number")
    elif element.tag == "up_axis":
        element.text = text.strip()
    elif element.tag == "skew":
        raise ValueError("<skew> is not supported")
    elif element.tag == "accessor":
        parameters = len(element.findall("param"))
        if int(element.get("stride", "1")) != parameters or int(element.get("offset", "0")) != 0:
            raise ValueError("an accessor's stride is not the number of its parameters, or it has an offset")
    elif element.tag == "polylist":
        corners = [int(count) for count in element.findtext("vcount", "").split()]
        if sum(corners) > len(element.findtext("p", "").split()):
            raise ValueError("polygons with more corners than are there")
        if min(corners, default=3) < 3:
            raise ValueError("a polygon with fewer than three corners")
    elif element.tag == "polygons" and any(not (p.text or "").strip() for p in element.iterfind("p")):
        raise ValueError("a polygon without corners")


def _nodes_below(element: Element, by_id: dict[str, Element], depth: int) -> Iterator[Element]:
    """All nodes under an element, each as often as instances place it, and instances of geometries among them.

    Raises:
        ValueError: They are too deep in each other, as where one contains itself, or a node is missing.
    """
    if depth > _DEEPEST:
        raise ValueError(f"more than {_DEEPEST} nodes in each other")
    for child in element:
        if child.tag == "instance_node":
            name = child.get("url", "").removeprefix("#")
            if name not in by_id:
                raise ValueError(f"node '{name[:40]}' is not there")
            child = by_id[name]
        if child.tag in ("node", "instance_geometry"):
            yield child
            yield from _nodes_below(child, by_id, depth + 1)


def _placed(document: Any, most_faces: int, colors: Mapping[str, Color]) -> Iterator[Mesh]:
    """The meshes of a document where its scene places them; each once at the origin where it has no scene.

    Raises:
        ValueError: There are no triangles, or too many.
    """
    if document.scene is not None:
        instances = [(one.original, np.array(one.matrix, np.float64)) for one in document.scene.objects("geometry")]
    else:
        instances = [(geometry, np.eye(4)) for geometry in document.geometries]
    meshes: dict[int, list[Mesh]] = {}
    faces = 0
    for geometry, T in instances:
        if id(geometry) not in meshes:
            meshes[id(geometry)] = [mesh for primitive in geometry.primitives for mesh in _triangles(primitive, colors)]
        for mesh in meshes[id(geometry)]:
            faces += len(mesh.faces)
            if faces > most_faces:
                raise ValueError("too many triangles")
            seen_from_outside = mesh.faces if np.linalg.det(T[:3, :3]) >= 0.0 else mesh.faces[:, ::-1]
            yield Mesh(mesh.vertices @ T[:3, :3].T + T[:3, 3], seen_from_outside, mesh.colors)
    if faces == 0:
        raise ValueError("no triangles")


def _triangles(primitive: Any, colors: Mapping[str, Color]) -> Iterator[Mesh]:
    """The triangles of one set of triangles or polygons, with the vertices that they use; nothing for an empty set."""
    triangles = primitive.triangleset() if hasattr(primitive, "triangleset") else primitive
    if len(triangles) == 0:
        return
    corners: Faces = np.array(triangles.vertex_index, dtype=np.int64)
    if corners.min() < 0:
        raise ValueError("a vertex with a negative number")
    used, faces = np.unique(corners, return_inverse=True)
    vertices: Array = np.array(triangles.vertex, dtype=np.float64)[used]
    color = colors.get(primitive.material or "")
    of_faces = None if color is None else np.tile(np.array(color, np.int16), (len(corners), 1))
    yield Mesh(vertices, faces.reshape(-1, 3), of_faces)


def _to_metres(mesh: Mesh, asset: Any) -> Mesh:
    """A mesh in the unit and the axes that a document states, in metres with z upwards."""
    scale = 1.0 if asset.unitmeter is None else float(asset.unitmeter)
    z_up = any(_AXES_NOT_MEANT in (contributor.authoring_tool or "") for contributor in asset.contributors)
    rotation = np.eye(3) if z_up else _UPWARDS.get(asset.upaxis, np.eye(3))
    return mesh._replace(vertices=scale * mesh.vertices @ rotation.T)
