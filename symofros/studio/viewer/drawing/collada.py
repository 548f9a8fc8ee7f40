"""Triangles of a COLLADA file (.dae), which many robots' files have for meshes.

Read are geometries made of triangles and polygons, at the places that the scene has them, in metres, z upwards.
Materials, skins and animations are not read.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any
from xml.etree import ElementTree

import numpy as np

from symofros.studio.viewer.drawing.meshes import Array, Faces, Mesh, merged

# From axes with another one upwards to ours.
_UPWARDS = {
    "Y_UP": np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]),
    "X_UP": np.array([[0.0, -1, 0], [0, 0, -1], [1, 0, 0]]),
}
# It writes Y_UP whatever the axes of the mesh are that it saves.
_AXES_NOT_MEANT = "MeshLab"
_MOST_NODES, _DEEPEST = 10_000, 50
Element = ElementTree.Element


def read_collada(data: bytes, most_faces: int) -> Mesh:
    """All triangles of a file as one mesh [m].

    Raises:
        ValueError: It is no such file, or has more triangles than that.
    """
    try:
        root = ElementTree.fromstring(data, ElementTree.XMLParser(target=_Builder()))
        return _Document(root, most_faces).mesh()
    except (ElementTree.ParseError, KeyError, IndexError, TypeError, LookupError) as error:
        raise ValueError(f"{type(error).__name__}: {error}") from None


class _Builder(ElementTree.TreeBuilder):
    """Elements without their namespace."""

    def start(self, tag: Any, attrs: Any) -> Element:
        return super().start(tag.rpartition("}")[2], attrs)

    def end(self, tag: Any) -> Element:
        return super().end(tag.rpartition("}")[2])

    def doctype(self, *_: object) -> None:
        raise ValueError("document types are refused")


class _Document:
    def __init__(self, root: Element, most_faces: int) -> None:
        if root.tag != "COLLADA":
            raise ValueError(f"the root element is <{root.tag[:40]}>, not <COLLADA>")
        self.root = root
        self.by_id = {element.attrib["id"]: element for element in root.iter() if "id" in element.attrib}
        self.left, self.nodes = most_faces, 0
        self.known: dict[str, Mesh | None] = {}

    def mesh(self) -> Mesh:
        unit, up = self.root.find("asset/unit"), self.root.findtext("asset/up_axis", "Y_UP").strip()
        if _AXES_NOT_MEANT in self.root.findtext("asset/contributor/authoring_tool", ""):
            up = "Z_UP"
        scale = float(unit.get("meter", "1")) if unit is not None else 1.0
        scene = self.root.find("scene/instance_visual_scene")
        if scene is not None:
            nodes = self.linked(scene, "url").findall("node")
            found = [mesh for node in nodes for mesh in self.placed(node, np.eye(4), 0)]
        else:
            all_of = map(self.solid, self.root.iterfind("library_geometries/geometry"))
            found = [mesh for mesh in all_of if mesh is not None]
        if not found:
            raise ValueError("no triangles")
        whole = merged(found)
        return Mesh(scale * whole.vertices @ _UPWARDS.get(up, np.eye(3)).T, whole.faces)

    def linked(self, element: Element, attribute: str) -> Element:
        """What an element refers to, in this file: nothing else is opened."""
        return self.by_id[element.attrib[attribute].removeprefix("#")]

    def placed(self, node: Element, above: Array, depth: int) -> Iterator[Mesh]:
        """The meshes of a node and of those in it."""
        self.nodes += 1
        if depth > _DEEPEST or self.nodes > _MOST_NODES:
            raise ValueError(f"more than {_MOST_NODES} nodes, or {_DEEPEST} in each other")
        T = above
        for element in node:
            if element.tag in _STEPS:
                T = T @ _STEPS[element.tag](_floats(element))
        for element in node:
            if element.tag == "instance_geometry":
                mesh = self.solid(self.linked(element, "url"))
                if mesh is not None:
                    self.left -= len(mesh.faces)
                    if self.left < 0:
                        raise ValueError("too many triangles")
                    faces = mesh.faces if np.linalg.det(T[:3, :3]) >= 0.0 else mesh.faces[:, ::-1]
                    yield Mesh(mesh.vertices @ T[:3, :3].T + T[:3, 3], faces)
            elif element.tag == "node":
                yield from self.placed(element, T, depth + 1)
            elif element.tag == "instance_node":
                yield from self.placed(self.linked(element, "url"), T, depth + 1)

    def solid(self, geometry: Element) -> Mesh | None:
        """A geometry's triangles; None for lines and the like."""
        key = geometry.get("id", "")
        if key not in self.known:
            pieces = [piece for element in geometry.iterfind("mesh/*") for piece in self.pieces(element)]
            self.known[key] = merged(pieces) if pieces else None
        return self.known[key]

    def pieces(self, element: Element) -> Iterator[Mesh]:
        if element.tag not in ("triangles", "polylist", "polygons"):
            return
        inputs = element.findall("input")
        width = 1 + max(int(one.get("offset", "0")) for one in inputs)
        vertex = next(one for one in inputs if one.get("semantic") == "VERTEX")
        rows = [_whole(p).reshape(-1, width)[:, int(vertex.get("offset", "0"))] for p in element.iterfind("p")]
        if not rows or not sum(map(len, rows)):
            return
        if element.tag == "polylist":
            counts = _whole(element.find("vcount"))
            corners = rows[0]
        else:
            counts = (
                np.array([len(row) for row in rows]) if element.tag == "polygons" else np.full(len(rows[0]) // 3, 3)
            )
            corners = np.concatenate(rows)
        yield Mesh(self.positions(vertex), corners[_fans(counts, len(corners))])

    def positions(self, vertex: Element) -> Array:
        vertices = self.linked(vertex, "source")
        position = next(one for one in vertices.iterfind("input") if one.get("semantic") == "POSITION")
        source = self.linked(position, "source")
        accessor = source.find("technique_common/accessor")
        stride, start = (int(accessor.get(name, value)) for name, value in (("stride", "3"), ("offset", "0")))  # type: ignore[union-attr]
        numbers = _floats(source.find("float_array"))[start:]
        return numbers[: len(numbers) // stride * stride].reshape(-1, stride)[:, :3]


def _fans(counts: Faces, size: int) -> Faces:
    """Which corners make the triangles (F, 3) of polygons that have so many corners each, one after the other."""
    if counts.sum() > size or counts.min(initial=1) < 0:
        raise ValueError("polygons with more corners than are there")
    first = np.cumsum(counts) - counts
    fans = np.maximum(counts - 2, 0)
    step = np.arange(fans.sum()) - np.repeat(np.cumsum(fans) - fans, fans)
    start = np.repeat(first, fans)
    return np.stack([start, start + step + 1, start + step + 2], axis=1)


def _floats(element: Element | None) -> Array:
    return np.array((element.text or "").split() if element is not None else [], dtype=np.float64)


def _whole(element: Element | None) -> Faces:
    return np.array((element.text or "").split() if element is not None else [], dtype=np.int64)


def _translation(x: Array) -> Array:
    T = np.eye(4)
    T[:3, 3] = x[:3]
    return T


def _turn(x: Array) -> Array:
    """About an axis by an angle in degrees (4)."""
    n = x[:3] / np.linalg.norm(x[:3])
    K = np.array([[0.0, -n[2], n[1]], [n[2], 0.0, -n[0]], [-n[1], n[0], 0.0]])
    angle, T = np.radians(x[3]), np.eye(4)
    T[:3, :3] += np.sin(angle) * K + (1.0 - np.cos(angle)) * K @ K
    return T


_STEPS: dict[str, Callable[[Array], Array]] = {
    "matrix": lambda x: x.reshape(4, 4),
    "translate": _translation,
    "rotate": _turn,
    "scale": lambda x: np.diag([*x[:3], 1.0]),
}
