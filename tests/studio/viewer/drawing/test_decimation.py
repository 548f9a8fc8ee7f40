"""Decimated meshes: how far they are from what they were, and what stays."""

from __future__ import annotations

import numpy as np
import pytest

from symofros.studio.viewer.drawing.decimation import clustered, decimated
from symofros.studio.viewer.drawing.meshes import Mesh
from tests.late import late

creation = late("trimesh.creation", "view")


def of(solid: object) -> Mesh:
    return Mesh(np.array(solid.vertices), np.array(solid.faces, dtype=np.int64))  # type: ignore[attr-defined]


def distances(points: np.ndarray, mesh: Mesh) -> np.ndarray:
    """Distance of each point (n, 3) from the nearest triangle, by its corners, edges and face."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    best = np.full(len(points), np.inf)
    for i, p in enumerate(points):
        height = np.einsum("ij,ij->i", normal, p - a)
        inside = np.ones(len(a), dtype=bool)
        found = np.inf
        for start, end in ((a, b), (b, c), (c, a)):
            inside &= np.einsum("ij,ij->i", normal, np.cross(end - start, p - start)) >= 0.0
            along = end - start
            s = np.clip(np.einsum("ij,ij->i", along, p - start) / np.einsum("ij,ij->i", along, along), 0.0, 1.0)
            found = min(found, np.linalg.norm(p - start - s[:, None] * along, axis=1).min())
        best[i] = min(found, np.abs(height[inside]).min(initial=np.inf))
    return best


def volume(mesh: Mesh) -> float:
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


def is_closed(mesh: Mesh) -> bool:
    edges = np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]], mesh.faces[:, [2, 0]]])
    forth, back = {tuple(edge) for edge in edges.tolist()}, {tuple(edge[::-1]) for edge in edges.tolist()}
    return forth == back and len(forth) == len(edges)


@pytest.mark.parametrize(("finer", "tolerance"), [(4, 0.02), (4, 0.005), (5, 0.001)])
def test_a_ball_stays_a_ball(finer: int, tolerance: float) -> None:
    """Closed, of one piece, within 1.5 times the tolerance; a cap of height h on a radius of 1 is √(8h) wide."""
    before = of(creation.icosphere(subdivisions=finer))
    after = decimated(before, tolerance)
    assert is_closed(after) and len(after.vertices) - len(after.faces) // 2 == 2
    assert distances(before.vertices[:: len(before.vertices) // 200], after).max() < 1.5 * tolerance
    assert np.linalg.norm(after.vertices, axis=1) == pytest.approx(1.0, abs=1e-12)  # Corners are some of those before.
    middles = after.vertices[after.faces].mean(axis=1)
    assert np.linalg.norm(middles, axis=1).min() > 1.0 - 1.5 * tolerance
    # Equilateral triangles of that width on a sphere of area 4 π would be as many; three times them is what is found.
    least = 4 * np.pi / (np.sqrt(3) / 4 * 8 * tolerance)
    assert least < len(after.faces) < 6 * least
    assert len(after.faces) < 0.5 * len(before.faces)


def test_flat_sides_keep_their_edges() -> None:
    """A box whose sides are many triangles: what is left has its volume and its eight corners."""
    solid = creation.box()
    for _ in range(4):
        solid = solid.subdivide()
    before = of(solid)
    after = decimated(before, 1e-6)
    assert len(after.faces) < 0.1 * len(before.faces)
    assert volume(after) == pytest.approx(1.0, abs=1e-9)
    corners = {tuple(corner) for corner in np.round(after.vertices, 9).tolist()}
    assert {(x, y, z) for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)} <= corners


def test_open_edges_keep_their_corners() -> None:
    """A flat sheet with a hole: all inner corners go, and no other."""
    n = 20
    i, j = np.meshgrid(np.arange(n), np.arange(n), indexing="ij")
    a = (i * (n + 1) + j)[(abs(i - 10) > 2) | (abs(j - 10) > 2)]
    faces = np.concatenate([np.stack([a, a + n + 1, a + n + 2], 1), np.stack([a, a + n + 2, a + 1], 1)])
    x, y = np.meshgrid(np.arange(n + 1.0), np.arange(n + 1.0), indexing="ij")
    sheet = Mesh(np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], 1), faces)
    after = decimated(sheet, 1e-9)
    edge = (x % n == 0) | (y % n == 0)
    hole = (np.maximum(abs(x - 10.5), abs(y - 10.5)) == 2.5).ravel()
    kept = {tuple(point) for point in after.vertices[:, :2].tolist()}
    at_edges = {tuple(point) for point in sheet.vertices[edge.ravel() | hole][:, :2].tolist()}
    assert at_edges <= kept and len(kept) < len(at_edges) + 40
    first, second, third = (after.vertices[after.faces[:, k]] for k in range(3))
    area = np.cross(second - first, third - first)[:, 2] / 2
    assert area.sum() == pytest.approx(n * n - 25) and area.min() > 0.0


@pytest.mark.parametrize("faces", [[[0, 1, 2]], [[0, 1, 2], [0, 1, 2]], [[0, 1, 2], [1, 0, 3], [0, 1, 4]], [[0, 1, 1]]])
def test_meshes_without_a_surface_stay(faces: list[list[int]]) -> None:
    mesh = Mesh(np.random.default_rng(3).normal(size=(5, 3)), np.array(faces))
    after = decimated(mesh, 10.0)
    np.testing.assert_array_equal(after.vertices[after.faces], mesh.vertices[mesh.faces])


@pytest.mark.parametrize("most", [5000, 300, 12, 1])
def test_a_mesh_is_clustered_to_as_many_triangles_as_are_drawn(most: int) -> None:
    """No corner moves by more than what is said; each triangle keeps its color, and the side that it is seen from."""
    ball = of(creation.icosphere(subdivisions=5))
    top = ball.vertices[ball.faces].mean(axis=1)[:, 2] > 0.0
    colors = np.where(top[:, None], [255, 0, 0], [0, 0, 255]).astype(np.int16)
    after, moved = clustered(ball._replace(colors=colors), most)
    assert len(after.faces) <= most and moved <= np.sqrt(3) * 2.0 / np.sqrt(most / 64)
    assert after.colors is not None and len(after.colors) == len(after.faces)
    if most >= 300:
        assert len(after.faces) > most / 8 and volume(after) == pytest.approx(4 / 3 * np.pi, rel=12 / most**0.5 / 4)
        middles = after.vertices[after.faces].mean(axis=1)
        assert np.array_equal(middles[:, 2] > moved, (middles[:, 2] > moved) & (after.colors[:, 0] == 255))
        assert distances(after.vertices[:: len(after.vertices) // 30], ball).max() <= moved
    same, nothing = clustered(of(creation.box((1.0, 1.0, 1.5))), 12)
    assert nothing == 0.0 and len(same.faces) == 12 and volume(same) == pytest.approx(1.5)
