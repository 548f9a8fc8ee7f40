"""Paths beside a mechanism: where they run, how thick they are, what is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import symofros as sf
from reference_models import MODELS
from symofros.errors import ShapeError
from symofros.studio.viewer.drawing.layers import LAYERS
from symofros.studio.viewer.drawing.poses import Mechanism
from symofros.studio.viewer.drawing.tracks import track_part, tracks_of
from symofros.studio.viewer.render.camera import Camera
from symofros.studio.viewer.render.raster import picture

SQUARE = np.array([[0.3, 0.3], [0.9, 0.3], [0.9, -0.3], [0.3, -0.3], [0.3, 0.3]])


def vertices(points: Any, size: float = 1.0) -> np.ndarray:
    (track,) = tracks_of([("path", points)])
    return track_part(track, size).mesh.vertices


def distance(places: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Distances of places (n, 3) from a curve through points (m, 3)."""
    start, along = points[:-1], np.diff(points, axis=0)
    share = np.einsum("nmi,mi->nm", places[:, None] - start, along) / np.maximum((along**2).sum(axis=1), 1e-300)
    near = start + np.clip(share, 0.0, 1.0)[..., None] * along
    found: np.ndarray = np.linalg.norm(places[:, None] - near, axis=2).min(axis=1)
    return found


def test_a_track_is_a_thin_tube_along_its_points() -> None:
    t = np.linspace(0.0, 4 * np.pi, 300)
    helix = np.stack([np.cos(t), np.sin(t), t / 10], axis=1)
    found = distance(vertices(helix), helix)
    assert found.max() < 1.01 * 0.0025 and np.median(found) > 0.9 * 0.0025


def test_corners_stay_where_they_are() -> None:
    places = vertices(SQUARE)
    for corner in SQUARE:
        assert np.linalg.norm(places - [*corner, 0.0], axis=1).min() < 0.003
    assert np.abs(places[:, 2]).max() < 0.003  # (n, 2) is in the plane z = 0.


@pytest.mark.parametrize("count", [10, 100_000])
def test_long_tracks_are_thinned(count: int) -> None:
    t = np.linspace(0.0, 400 * np.pi, count)
    circles = np.stack([np.cos(t), np.sin(t), 0 * t], axis=1)
    places = vertices(circles)
    assert len(places) <= 12 * 2003 + 12
    assert np.linalg.norm(places - circles[-1], axis=1).min() < 0.003


def test_standing_still_and_turning_back_are_drawn() -> None:
    points = np.array([[0.0, 0, 0], [0, 0, 0], [1, 0, 0], [1, 0, 0], [0, 0, 0], [0, 1, 0]])
    assert np.all(np.isfinite(vertices(points))) and np.all(np.isfinite(vertices(points[:2])))


@pytest.mark.parametrize(
    ("path", "expected"),
    [
        (("a",), "1 items\n"),
        (("a", [[0.0, 0.0, 0.0]]), r"points \(1, 3\)"),
        (("a", np.zeros((5, 4))), r"points \(5, 4\)"),
        (("a", [[0.0, 0.0], [np.nan, 0.0]]), "not finite"),
        (("a", SQUARE, (0, 0, 300)), r"color \(0, 0, 300\)"),
        (("a", SQUARE, (0, 0)), r"color \(0, 0\)"),
    ],
)
def test_invalid_paths_are_refused(path: tuple[Any, ...], expected: str) -> None:
    with pytest.raises(ShapeError, match=expected):
        tracks_of([path])
    with pytest.raises(ShapeError, match="names of paths are different"):
        tracks_of([("a", SQUARE), ("a", SQUARE)])


def test_a_picture_has_them_in_their_colors_and_within() -> None:
    far = np.array([[4.0, -1.0], [4.0, 1.0]])  # Beyond what the robot reaches.
    drawing = Mechanism(MODELS["planar_robot"], tracks_of([("far", far, (0, 0, 255))])).drawing()
    posture = Mechanism(MODELS["planar_robot"]).posture(np.zeros(10))
    for layers, seen in ((frozenset(LAYERS), True), (frozenset(LAYERS) - {"paths"}, False)):
        image = picture(drawing, posture, layers, Camera.of(drawing), 320, 240).astype(int)
        blue = (image[..., 2] > 100) & (image[..., :2].max(axis=2) < image[..., 2] / 3)
        assert (blue.sum() > 30) == seen


def test_the_viewer_keeps_them_with_another_system() -> None:
    with sf.Viewer(MODELS["planar_robot"], port=0, paths=[("square", SQUARE)]) as viewer:
        for system in (MODELS["planar_robot"], MODELS["pendulum"]):
            viewer.set_system(system)
            path = viewer._server.scene.get_handle_by_name("/mechanism/world/paths.square")
            assert path is not None
        viewer.set_layer("paths", False)
        assert not path.visible
