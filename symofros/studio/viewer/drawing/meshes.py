"""Triangle meshes of the few shapes that drawings are made of."""

from __future__ import annotations

from importlib import import_module
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array
from symofros.errors import SymofrosError

Faces = npt.NDArray[np.int64]
Colors = npt.NDArray[np.int16]

_SIDES = 12  # Of anything round: few enough for hundreds of them in a browser.
_WHEEL = 48  # Of discs, which may be the largest thing there is.
_SUBDIVISIONS = 2  # Of the icosahedron's faces in spheres; 320 triangles.


class Mesh(NamedTuple):
    """A surface of triangles, seen from the side around which their corners run counter-clockwise.

    Attributes:
        vertices: (V, 3) [m].
        faces: Indices of corners (F, 3).
        colors: Red, green, blue of each face, 0 to 255, -1 where its file states none (F, 3); None without such.
        places: Middle of each face in a picture, as its file states it: to the right and up, 0 to 1, repeated beyond
            (F, 2); None without such.
    """

    vertices: Array
    faces: Faces
    colors: Colors | None = None
    places: Array | None = None

    def transformed(self, position: Array, rotation: Array) -> Mesh:
        """The mesh as seen from the frame in which its own stands at a position (3) and rotation (3, 3)."""
        return self._replace(vertices=self.vertices @ rotation.T + position)

    def by_color(self) -> list[tuple[tuple[int, int, int] | None, Mesh]]:
        """The faces of each color as a mesh of their own, None those without one."""
        if self.colors is None:
            return [(None, self)]
        colors, of = np.unique(self.colors, axis=0, return_inverse=True)
        parts: list[tuple[tuple[int, int, int] | None, Mesh]] = []
        for i, (red, green, blue) in enumerate(colors.tolist()):
            used, faces = np.unique(self.faces[of.ravel() == i], return_inverse=True)
            part = Mesh(self.vertices[used], faces.reshape(-1, 3).astype(np.int64))
            parts.append(((red, green, blue) if red >= 0 else None, part))
        return parts


def on_grid(vertices: Array, size: float) -> Array:
    """Corners (V, 3) on a grid of steps that are a power of two and at most size / 4096 [m].

    Nobody sees a step of a mechanism of that size, and numbers with few digits are packed by a third.
    """
    step = 2.0 ** np.floor(np.log2(size / 4096))
    snapped: Array = np.round(vertices / step) * step
    return snapped


def merged(meshes: list[Mesh]) -> Mesh:
    """Several meshes as one; at least one."""
    first = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
    unstated = [np.full((len(mesh.faces), 3), -1, np.int16) if mesh.colors is None else mesh.colors for mesh in meshes]
    places = [mesh.places for mesh in meshes if mesh.places is not None]
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.faces + start for mesh, start in zip(meshes, first, strict=True)]),
        None if all(mesh.colors is None for mesh in meshes) else np.concatenate(unstated),
        np.concatenate(places) if len(places) == len(meshes) else None,
    )


def box(sizes: Array) -> Mesh:
    """A box about the origin, of these edges (3); each triangle has corners of its own, which keeps the edges sharp."""
    solid = _creation().box(sizes)
    solid.unmerge_vertices()
    return Mesh(_vertices(solid), np.array(solid.faces, dtype=np.int64))


def sphere(radius: float) -> Mesh:
    """A sphere about the origin."""
    solid = _creation().icosphere(subdivisions=_SUBDIVISIONS, radius=radius)
    return Mesh(_vertices(solid), np.array(solid.faces, dtype=np.int64))


def cylinder(start: Array, end: Array, radius: float) -> Mesh:
    """A closed cylinder between two points (3)."""
    length = float(np.linalg.norm(end - start))
    return _turned(_creation().cylinder(radius, length, sections=_SIDES), (start + end) / 2, end - start)


def cone(base: Array, tip: Array, radius: float) -> Mesh:
    """A closed cone between two points (3)."""
    length = float(np.linalg.norm(tip - base))
    return _turned(_creation().cone(radius, length, sections=_SIDES), base, tip - base)


def disc(radius: float, thickness: float) -> Mesh:
    """A flat cylinder about the origin, its axis along z."""
    solid = _creation().cylinder(radius, thickness, sections=_WHEEL)
    return _turned(solid, np.zeros(3), np.array([0.0, 0.0, 1.0]))


def _creation() -> Any:
    """Trimesh's makers of primitives.

    Raises:
        SymofrosError: trimesh is not installed.
    """
    try:
        return import_module("trimesh.creation")
    except ImportError:
        raise SymofrosError.of_extra(
            "view: trimesh is not installed", "no module trimesh", "the viewer is an extra", "view"
        ) from None


def _vertices(solid: Any) -> Array:
    return np.array(solid.vertices, dtype=np.float64)


def _turned(solid: Any, position: Array, direction: Array) -> Mesh:
    """A solid of revolution about z, moved to a position (3) with its axis along a direction (3).

    The flat ends get vertices of their own, so that a viewer that smooths over shared ones keeps their rims sharp.
    """
    end = np.round(solid.face_normals[:, 2])  # 1 and -1 on the ends, 0 on the mantle of anything that is not flat.
    end[np.abs(solid.face_normals[:, 2]) < 1.0 - 1e-9] = 0.0
    keys = np.stack([solid.faces, np.broadcast_to(end[:, None], solid.faces.shape)], axis=-1).reshape(-1, 2)
    used, faces = np.unique(keys, axis=0, return_inverse=True)
    # From z along the direction: x of axes_along is the direction, so its y and z stand for x and y of the solid.
    R = axes_along(direction)[:, [1, 2, 0]]
    return Mesh(_vertices(solid)[used[:, 0].astype(np.int64)], faces.reshape(-1, 3)).transformed(position, R)


def tube(outline: Array, points: Array, axes: Array) -> Mesh:
    """The closed surface that a section sweeps along a line.

    Args:
        outline: Outline of the section, in its y-z plane, counter-clockwise as seen against x (K, 2) [m].
        points: Points of the line (S, 3) [m].
        axes: Axes of the section at each of them: R with x along the line (S, 3, 3).
    """
    rings = points[:, None, :] + outline @ axes[:, :, 1:].transpose(0, 2, 1)
    count, sides = rings.shape[:2]
    # Its ends have corners of their own, so that a viewer that smooths over shared corners keeps them flat.
    vertices = np.concatenate([rings, rings[:1], rings[-1:]]).reshape(-1, 3)
    fan = np.array([(0, i, i + 1) for i in range(1, sides - 1)])
    ends = fan[:, ::-1] + count * sides, fan + (count + 1) * sides
    return Mesh(vertices, np.concatenate([_sleeve(count, sides), *ends]))


def tube_stations(count: int, sides: int) -> Faces:
    """Which of a tube's points each of its vertices goes with (V): it moves as the section there does."""
    return np.concatenate([np.repeat(np.arange(count), sides), np.repeat([0, count - 1], sides)])


def ellipse(half_y: float, half_z: float) -> Array:
    """The outline of an elliptic section (K, 2)."""
    outline: Array = _circle(1.0) * np.array([half_y, half_z])
    return outline


def axes_along(direction: Array) -> Array:
    """A rotation whose x axis points along a direction (3, 3); the unit matrix for no direction."""
    length = float(np.linalg.norm(direction))
    if length == 0.0:
        return np.eye(3)
    x = direction / length
    y = np.cross(np.eye(3)[int(np.argmin(np.abs(x)))], x)
    y /= np.linalg.norm(y)
    R: Array = np.stack([x, y, np.cross(x, y)], axis=1)
    return R


def _circle(radius: float, sides: int = _SIDES) -> Array:
    angles = np.linspace(0.0, 2 * np.pi, sides, endpoint=False)
    return radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def _sleeve(rings: int, sides: int) -> Faces:
    """Faces between neighbouring rings, seen from outside where the rings follow each other along x."""
    i, k = np.meshgrid(np.arange(rings - 1), np.arange(sides), indexing="ij")
    a, b = i * sides + k, i * sides + (k + 1) % sides
    quads = np.stack([a, a + sides, b + sides, b], axis=-1).reshape(-1, 4)[:, ::-1]
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
