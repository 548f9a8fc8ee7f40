"""Triangle meshes of the few shapes that drawings are made of."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Faces = npt.NDArray[np.int64]

_SIDES = 12  # Of anything round: few enough for hundreds of them in a browser.
_WHEEL = 48  # Of discs, which may be the largest thing there is.
_RINGS = 7


class Mesh(NamedTuple):
    """A surface of triangles, seen from the side around which their corners run counter-clockwise.

    Attributes:
        vertices: (V, 3) [m].
        faces: Indices of corners (F, 3).
    """

    vertices: Array
    faces: Faces

    def moved(self, position: Array, rotation: Array) -> Mesh:
        """The mesh as seen from the frame in which its own stands at a position (3) and rotation (3, 3)."""
        return Mesh(self.vertices @ rotation.T + position, self.faces)


def merged(meshes: list[Mesh]) -> Mesh:
    """Several meshes as one; at least one."""
    first = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.faces + start for mesh, start in zip(meshes, first, strict=True)]),
    )


def box(sizes: Array) -> Mesh:
    """A box about the origin, of these edges (3)."""
    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    sides = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    # Each side has corners of its own, so that a viewer that smooths over shared corners keeps the edges sharp.
    vertices = np.concatenate([corners[list(side)] for side in sides]) * sizes
    faces = [(4 * k, 4 * k + i, 4 * k + i + 1) for k in range(6) for i in (1, 2)]
    return Mesh(vertices, np.array(faces))


def sphere(radius: float) -> Mesh:
    """A sphere about the origin."""
    angles = np.linspace(0.0, np.pi, _RINGS)
    rings = _circle(radius)[None] * np.sin(angles)[:, None, None]
    vertices = np.concatenate(
        [rings, np.broadcast_to((-radius * np.cos(angles))[:, None, None], (_RINGS, _SIDES, 1))], axis=2
    )
    return Mesh(vertices.reshape(-1, 3), _sleeve(_RINGS, _SIDES))


def cylinder(start: Array, end: Array, radius: float, sides: int = _SIDES) -> Mesh:
    """A closed cylinder between two points (3)."""
    R = axes_along(end - start)
    return tube(_circle(radius, sides), np.stack([start, end]), np.stack([R, R]))


def cone(base: Array, tip: Array, radius: float) -> Mesh:
    """A closed cone between two points (3)."""
    mesh = cylinder(base, tip, radius)
    vertices = mesh.vertices.copy()
    vertices[_SIDES : 2 * _SIDES] = vertices[3 * _SIDES :] = tip
    return Mesh(vertices, mesh.faces)


def disc(radius: float, thickness: float) -> Mesh:
    """A flat cylinder about the origin, its axis along z."""
    half = np.array([0.0, 0.0, thickness / 2])
    return cylinder(-half, half, radius, _WHEEL)


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
