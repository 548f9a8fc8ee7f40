"""Tracks: curves that stand still in the world beside a mechanism, as a path that its tip should follow."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from symofros.base.arrays import Array
from symofros.errors import ShapeError
from symofros.mechanics.topology import BASE
from symofros.studio.viewer.drawing.drawing import Color, DrawnPart
from symofros.studio.viewer.drawing.meshes import Mesh, axes_along, ellipse, tube

_COLORS: tuple[Color, ...] = ((204, 51, 17), (30, 30, 30), (0, 119, 187), (238, 119, 51))
# Shares of the mechanism's size.
_RADIUS, _STEP = 0.0025, 0.002
_MOST = 2000  # Points that are drawn of one track.


class Track(NamedTuple):
    """A curve: its name, points (n, 3) in the world [m], and color (red, green, blue, 0 to 255)."""

    name: str
    points: Array
    color: Color


def tracks_of(given: Sequence[Sequence[Any]]) -> tuple[Track, ...]:
    """Tracks stated as (name, points) or (name, points, color); points (n, 2) lie in the plane z = 0.

    Raises:
        ShapeError: Points are not (n, 3) or (n, 2) finite numbers, n at least 2; a color is not three of 0 to 255; two
            tracks have one name.
    """
    tracks: list[Track] = []
    for i, item in enumerate(given):
        if len(item) not in (2, 3):
            _refuse(f"path {i}", f"{len(item)} items", "a path is (name, points) or (name, points, color)")
        name, points = str(item[0]), np.array(item[1], dtype=np.float64)
        if points.ndim != 2 or points.shape[1] not in (2, 3) or len(points) < 2:
            _refuse(f"path '{name}'", f"points {points.shape}", "points are (n, 3) in the world, or (n, 2), n > 1")
        if not np.all(np.isfinite(points)):
            _refuse(f"path '{name}'", "points that are not finite", "points are finite numbers of metres")
        color = tuple(int(x) for x in item[2]) if len(item) == 3 else _COLORS[i % len(_COLORS)]
        if len(color) != 3 or not all(0 <= x <= 255 for x in color):
            _refuse(f"path '{name}'", f"color {color}", "a color is red, green and blue, 0 to 255")
        if name in {other.name for other in tracks}:
            _refuse(f"path '{name}'", "two of that name", "names of paths are different")
        flat = points if points.shape[1] == 3 else np.column_stack([points, np.zeros(len(points))])
        tracks.append(Track(name, flat, (color[0], color[1], color[2])))
    return tuple(tracks)


def track_part(track: Track, size: float) -> DrawnPart:
    """A track as a thin tube.

    Args:
        track: The curve.
        size: Size of the mechanism [m].
    """
    return DrawnPart(
        f"paths/{track.name}", "paths", BASE, _mesh(_thinned(track.points, _STEP * size), _RADIUS * size), track.color
    )


def _thinned(points: Array, step: float) -> Array:
    """Points at least a step apart, a longer one where there would be too many; the first and the last stay."""
    length = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
    step = max(step, length / _MOST)
    kept = [points[0]]
    for point in points[1:]:
        if np.linalg.norm(point - kept[-1]) >= step:
            kept.append(point)
    if np.any(kept[-1] != points[-1]) or len(kept) == 1:
        kept.append(points[-1])
    return np.array(kept)


def _mesh(points: Array, radius: float) -> Mesh:
    """A tube along points, its sections turned no more than the curve turns."""
    ahead = np.diff(points, axis=0)
    along = np.concatenate([ahead[:1], ahead[:-1] + ahead[1:], ahead[-1:]])
    axes = [axes_along(along[0])]
    for direction in along[1:]:
        before, length = axes[-1], float(np.linalg.norm(direction))
        x = direction / length if length > 0.0 else before[:, 0]  # A point where the curve turns back.
        z = np.cross(x, before[:, 1])
        rest = float(np.linalg.norm(z))
        axes.append(np.stack([x, np.cross(z / rest, x), z / rest], axis=1) if rest > 1e-6 else axes_along(x))
    return tube(ellipse(radius, radius), points, np.array(axes))


def _refuse(what: str, found: str, rule: str) -> None:
    raise ShapeError(f"view: {what} can't be drawn", found, rule, "for example ('desired', points)")
