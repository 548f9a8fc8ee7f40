"""Meshes: closed, seen from outside, of the size that was asked for."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from symofros.base.arrays import Array
from symofros.studio.viewer.drawing import meshes
from symofros.studio.viewer.drawing.meshes import Mesh

LINE = np.array([[0.0, 0.0, 0.0], [0.5, 0.1, 0.0], [1.0, 0.3, 0.2], [1.2, 0.8, 0.5]])
MESHES = {
    "box": lambda: meshes.box(np.array([1.0, 2.0, 3.0])),
    "sphere": lambda: meshes.sphere(2.0),
    "cylinder": lambda: meshes.cylinder(np.array([0.0, 0.0, 1.0]), np.array([1.0, 2.0, 0.0]), 0.1),
    "cone": lambda: meshes.cone(np.array([0.0, 0.0, 1.0]), np.array([1.0, 2.0, 0.0]), 0.1),
    "disc": lambda: meshes.disc(1.0, 0.1),
    "tube": lambda: meshes.tube(meshes.ellipse(0.05, 0.1), LINE, np.stack([meshes.axes_along(np.ones(3))] * 4)),
    "merged": lambda: meshes.merged(
        [meshes.disc(1.0, 0.1), meshes.box(np.ones(3)).transformed(5 * np.ones(3), np.eye(3))]
    ),
}
# Areas of regular polygons over those of their circles.
TWELVE_SIDES, WHEEL = (n / (2 * np.pi) * np.sin(2 * np.pi / n) for n in (12, 48))


def volume(mesh: Mesh) -> float:
    """Volume by the divergence theorem: positive only where faces look outwards."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


@pytest.mark.parametrize("name", MESHES)
def test_every_edge_has_two_faces_that_run_along_it_both_ways(name: str) -> None:
    mesh = MESHES[name]()
    _, place = np.unique(np.round(mesh.vertices, 9), axis=0, return_inverse=True)
    corners = place.reshape(-1)[mesh.faces]
    edges = Counter((a, b) for face in corners for a, b in zip(face, np.roll(face, -1), strict=True) if a != b)
    # A face that shrinks to a line, at a pole or a tip, brings an edge and its reverse.
    assert all(count == edges[b, a] for (a, b), count in edges.items())


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("box", 6.0),
        ("cylinder", 0.01 * np.pi * np.sqrt(6) * TWELVE_SIDES),
        ("disc", 0.1 * np.pi * WHEEL),
        ("cone", 0.01 * np.pi * np.sqrt(6) * TWELVE_SIDES / 3),
        ("merged", 0.1 * np.pi * WHEEL + 1.0),
    ],
)
def test_meshes_enclose_the_expected_volume(name: str, expected: float) -> None:
    assert volume(MESHES[name]()) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("direction", [*np.eye(3), *-np.eye(3), np.array([1.0, -2.0, 0.5])], ids=str)
def test_axes_along_a_direction_are_a_rotation(direction: Array) -> None:
    R = meshes.axes_along(direction)
    assert np.array_equal(meshes.axes_along(0 * direction), np.eye(3))  # No direction is no turn.
    assert np.allclose(R @ R.T, np.eye(3)) and np.linalg.det(R) == pytest.approx(1.0)
    assert np.allclose(R[:, 0], direction / np.linalg.norm(direction))


def test_a_tube_moves_as_its_stations_do() -> None:
    """Vertices attached to stations that move: what a browser does with bones gives the tube of the moved line."""
    outline = meshes.ellipse(0.05, 0.1)
    R = np.stack([meshes.axes_along(d) for d in np.diff(LINE, axis=0, append=LINE[-1:] + 1)])
    straight = np.stack([np.linspace(0, 1, 4), np.zeros(4), np.zeros(4)], axis=1)
    at_rest = meshes.tube(outline, straight, np.stack([np.eye(3)] * 4))
    stations = meshes.tube_stations(4, len(outline))
    moved = np.einsum("vij,vj->vi", R[stations], at_rest.vertices - straight[stations]) + LINE[stations]
    assert np.allclose(moved, meshes.tube(outline, LINE, R).vertices)


def test_corners_on_a_grid_stay_where_nobody_sees_a_step() -> None:
    """Half a step of at most size / 4096 off, and with few digits in single precision."""
    vertices = np.random.default_rng(1).uniform(-1.0, 1.0, (1000, 3))
    snapped = meshes.on_grid(vertices, 2.0)
    off = np.abs(snapped - vertices).max()
    assert 2.0**-14 < off <= 2.0**-12 and np.array_equal(snapped.astype(np.float32), snapped)
    assert np.array_equal(meshes.on_grid(snapped, 2.0), snapped)
    assert meshes.on_grid(1e-6 * vertices, 2e-6) == pytest.approx(1e-6 * vertices, abs=2.5e-10)
