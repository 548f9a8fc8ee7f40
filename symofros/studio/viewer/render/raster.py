"""Pictures without a browser: triangles by lines of pixels, nearest on top, in NumPy alone.

Recordings need neither a graphics card nor Chromium this way, and come out the same everywhere.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array
from symofros.studio.viewer.drawing.drawing import Color, Drawing
from symofros.studio.viewer.drawing.ground import GRAVITY_COLOR, gravity_arrow, ground_lines
from symofros.studio.viewer.drawing.layers import ARROWS, HEAD, HEAD_RADIUS, SHAFT_RADIUS, Arrows
from symofros.studio.viewer.drawing.meshes import Mesh, cone, cylinder, tube
from symofros.studio.viewer.drawing.poses import Posture, beam_sweep, connector_sweep
from symofros.studio.viewer.page.viser_scene import SEE_THROUGH
from symofros.studio.viewer.render.camera import Camera

Image = npt.NDArray[np.uint8]
Indices = npt.NDArray[np.int64]

_FINER = 2  # Pixels computed for one shown, each way: edges are smooth.
_BACKGROUND, _LINE = 255.0, 205.0
_DARKEST = 0.45  # Of a surface seen from its edge.
_LIGHT = np.array([-0.4, -0.7, -1.0])  # From where light comes: right, down, forward of the camera.


class _Fragments(NamedTuple):
    """Pixels that surfaces cover: which pixel (n), inverse depth (n) [1/m], color (n, 3)."""

    pixel: Indices
    nearness: Array
    color: Array


def picture(
    drawing: Drawing,
    posture: Posture,
    layers: frozenset[str],
    camera: Camera,
    width: int = 960,
    height: int = 720,
    arrows: Arrows | None = None,
) -> Image:
    """A picture (height, width, 3) of a mechanism; labels and frames are not in it.

    Args:
        drawing: Drawing to show.
        posture: Posture of the mechanism.
        layers: Layers that are shown.
        camera: Camera.
        width: Width [pixels].
        height: Height [pixels].
        arrows: Arrows of forces and moments.
    """
    return _Canvas(camera, width, height).painted(drawing, posture, layers, arrows or {})


class _Canvas:
    def __init__(self, camera: Camera, width: int, height: int) -> None:
        self.camera, self.shape = camera, (height * _FINER, width * _FINER)
        self.focus = self.shape[0] / 2 / np.tan(camera.fov / 2)
        light = _LIGHT / np.linalg.norm(_LIGHT)
        self.light = light

    def painted(self, drawing: Drawing, posture: Posture, layers: frozenset[str], arrows: Arrows) -> Image:
        colors = np.full((self.shape[0] * self.shape[1], 3), _BACKGROUND)
        nearness = np.zeros(len(colors))
        opaque, clear = self._surfaces(drawing, posture, layers)
        opaque += _arrows(drawing, arrows, layers)
        fragments = [self._filled(mesh, color) for mesh, color in opaque]
        if "ground" in layers:
            fragments += [self._line(line) for line in ground_lines(drawing)]
        if fragments:
            all_of = _Fragments(*(np.concatenate(arrays) for arrays in zip(*fragments, strict=True)))
            # Where a pixel is given several times, the last stays: the nearest.
            order = np.argsort(all_of.nearness, kind="stable")
            colors[all_of.pixel[order]] = all_of.color[order]
            nearness[all_of.pixel[order]] = all_of.nearness[order]
        # Boxes are convex: of one that is seen from outside, a pixel has one front.
        for one in sorted((self._filled(*item) for item in clear), key=lambda f: float(np.sum(f.nearness))):
            ahead = one.nearness > nearness[one.pixel]
            pixel = one.pixel[ahead]
            colors[pixel] += SEE_THROUGH * (one.color[ahead] - colors[pixel])
        height, width = self.shape
        blocks = colors.reshape(height // _FINER, _FINER, width // _FINER, _FINER, 3)
        image: Image = np.rint(blocks.mean(axis=(1, 3))).astype(np.uint8)
        return image

    def _surfaces(
        self, drawing: Drawing, posture: Posture, layers: frozenset[str]
    ) -> tuple[list[tuple[Mesh, Array]], list[tuple[Mesh, Array]]]:
        """Meshes in the world with their colors: those that hide what is behind, and those that do not."""
        opaque: list[tuple[Mesh, Array]] = []
        clear: list[tuple[Mesh, Array]] = []
        for part in drawing.parts:
            if part.kind in layers:
                mesh = part.mesh.transformed(posture.p[part.link], posture.R[part.link])
                (clear if part.kind == "inertias" else opaque).append((mesh, np.array(part.color, dtype=float)))
        for beam in drawing.beams if "bodies" in layers else ():
            opaque.append((tube(beam.outline, *beam_sweep(beam, posture)), np.array(beam.color, dtype=float)))
        for connector in drawing.connectors:
            if connector.kind in layers:
                opaque.append(
                    (
                        tube(connector.outline, *connector_sweep(connector, posture)),
                        np.array(connector.color, dtype=float),
                    )
                )
        return opaque, clear

    def _seen(self, points: Array) -> Array:
        """Points (..., 3) as (column, row, depth) in pixels and metres."""
        there = (points - self.camera.position) @ self.camera.axes.T
        depth = there[..., 2:]
        with np.errstate(divide="ignore", invalid="ignore"):  # What is beside the camera is left out later.
            flat = self.focus * there[..., :2] / depth
        return np.concatenate([flat + np.array(self.shape[::-1]) / 2, depth], axis=-1)

    def _filled(self, mesh: Mesh, color: Array) -> _Fragments:
        corners = mesh.vertices[mesh.faces]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        area = np.linalg.norm(normals, axis=1)
        seen = self._seen(corners)
        facing = np.einsum("ij,ij->i", normals, self.camera.position - corners[:, 0]) > 0.0
        kept = facing & (area > 0.0) & (seen[:, :, 2] > 0.0).all(axis=1)
        seen, normals = seen[kept], (normals[kept] / area[kept, None]) @ self.camera.axes.T
        bright = _DARKEST + (1 - _DARKEST) * np.clip(normals @ self.light, 0.0, 1.0)
        which, row, column = _pixels(seen[:, :, :2], self.shape)
        near = _inverse_depth(seen, which, row, column)
        return _Fragments(row * self.shape[1] + column, near, color * bright[which, None])

    def _line(self, ends: Array) -> _Fragments:
        """A line between two points (2, 3), one pixel wide."""
        share = np.linspace(0.0, 1.0, 2 * max(self.shape))[:, None]
        seen = self._seen(ends[0] + share * (ends[1] - ends[0]))
        seen = seen[seen[:, 2] > 0.0]
        at = np.floor(np.clip(seen[:, :2], -1.0, max(self.shape))).astype(np.int64)
        kept = (at >= 0).all(axis=1) & (at[:, 0] < self.shape[1]) & (at[:, 1] < self.shape[0])
        at, seen = at[kept], seen[kept]
        return _Fragments(at[:, 1] * self.shape[1] + at[:, 0], 1.0 / seen[:, 2], np.full((len(at), 3), _LINE))


def _arrows(drawing: Drawing, arrows: Arrows, layers: frozenset[str]) -> list[tuple[Mesh, Array]]:
    """Arrows of gravity, forces and moments as meshes with their colours."""
    gravity, found = gravity_arrow(drawing) if "ground" in layers else None, []
    if gravity is not None:
        length = float(np.linalg.norm(gravity[1] - gravity[0]))
        found += _arrow(gravity, length / 4, length / 25, length / 10, GRAVITY_COLOR)
    size = drawing.size
    for layer, ends in arrows.items():
        for end in ends[~np.isnan(ends).any(axis=(1, 2))]:
            found += _arrow(end, HEAD * size, SHAFT_RADIUS * size, HEAD_RADIUS * size, ARROWS[layer][0])
    return found


def _arrow(ends: Array, head: float, shaft_radius: float, head_radius: float, color: Color) -> list[tuple[Mesh, Array]]:
    """Shaft and head of an arrow from its tail to its tip (2, 3)."""
    tail, tip = ends
    middle = tip - head * (tip - tail) / np.linalg.norm(tip - tail)
    meshes = [cylinder(tail, middle, shaft_radius), cone(middle, tip, head_radius)]
    return [(mesh, np.array(color, dtype=float)) for mesh in meshes]


def _inverse_depth(seen: Array, which: Indices, row: Indices, column: Indices) -> Array:
    """1/depth at pixels of triangles (n): it is linear over the picture, as depth is not."""
    x, y, depth = seen[..., 0], seen[..., 1], seen[..., 2]
    (x1, x2), (y1, y2) = ((a[:, 1] - a[:, 0], a[:, 2] - a[:, 0]) for a in (x, y))
    w = 1.0 / depth
    w1, w2 = w[:, 1] - w[:, 0], w[:, 2] - w[:, 0]
    twice = x1 * y2 - x2 * y1
    twice = np.where(twice == 0.0, 1.0, twice)  # Seen from its edge, it covers no pixel.
    by_x, by_y = (w1 * y2 - w2 * y1) / twice, (w2 * x1 - w1 * x2) / twice
    dx, dy = column + 0.5 - x[which, 0], row + 0.5 - y[which, 0]
    interpolated: Array = w[which, 0] + by_x[which] * dx + by_y[which] * dy
    return interpolated


def _pixels(corners: Array, shape: tuple[int, int]) -> tuple[Indices, Indices, Indices]:
    """Pixels whose centres lie in triangles (N, 3, 2): which triangle, row, column of each (n)."""
    y = corners[:, :, 1]
    which, row = _ranges(_first(y.min(axis=1), shape[0]), _first(y.max(axis=1), shape[0]))
    level = row + 0.5
    left, right = np.full(len(which), np.inf), np.full(len(which), -np.inf)
    for i in range(3):
        a, b = corners[which, i], corners[which, (i + 1) % 3]
        rise = b[:, 1] - a[:, 1]
        share = (level - a[:, 1]) / np.where(rise == 0.0, 1.0, rise)
        x = a[:, 0] + share * (b[:, 0] - a[:, 0])
        crosses = (rise != 0.0) & (share >= 0.0) & (share <= 1.0)
        left = np.where(crosses, np.minimum(left, x), left)
        right = np.where(crosses, np.maximum(right, x), right)
    line, column = _ranges(_first(left, shape[1]), _first(right, shape[1]))
    return which[line], row[line], column


def _first(edge: Array, most: int) -> Indices:
    """The first pixel whose centre is not before an edge, within the picture."""
    return np.ceil(np.clip(edge, -1.0, most + 1.0) - 0.5).clip(0, most).astype(np.int64)


def _ranges(start: Indices, stop: Indices) -> tuple[Indices, Indices]:
    """All whole numbers from start to before stop of several ranges: which range, and the number."""
    count = np.maximum(stop - start, 0)
    which = np.repeat(np.arange(len(count)), count)
    offset = np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count)
    return which, start[which] + offset
