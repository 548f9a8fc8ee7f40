"""Meshes with fewer corners: within a stated distance of what they were, or with a stated number of triangles."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array
from symofros.studio.viewer.drawing.meshes import Faces, Mesh

_ROUNDS = 40
_WORTH = 0.02  # Of the corners left, that a round must remove for the next one to be made.
_TURN = np.cos(np.radians(25.0))  # A triangle's normal turns by no more than this in one collapse.
_CHOICES = 3  # Of collapses for one round, each among those that the earlier ones leave.
_LEVELS = 4.0  # Of the tolerance: collapses of one level of error are made in any order, many at once.


class _Collapses(NamedTuple):
    """Collapses: corners that go, the neighbours that they go to, their errors and those of earlier ones [m]."""

    corner: Faces
    onto: Faces
    error: Array

    def at(self, chosen: npt.NDArray[np.bool_]) -> _Collapses:
        """Some of them."""
        return _Collapses(self.corner[chosen], self.onto[chosen], self.error[chosen])


class _Fans(NamedTuple):
    """Triangles about each inner corner, as spokes: the corner, and the two that follow it in a triangle (K).

    Those of one corner follow each other, `number` of them from `first` on (V).
    """

    hub: Faces
    ahead: Faces
    behind: Faces
    first: Faces
    number: Faces

    def around(self, corners: Faces) -> tuple[Faces, Faces]:
        """Fan and index of each spoke of the given corners (M)."""
        repeats = self.number[corners]
        ends = np.cumsum(repeats)
        of = np.repeat(np.arange(len(corners)), repeats)
        return of, np.arange(len(of)) + (self.first[corners] - ends + repeats)[of]


def decimated(mesh: Mesh, tolerance: float) -> Mesh:
    """A mesh without the corners that its shape does not need.

    A corner is moved onto a neighbour where it then lies within the tolerance of the triangles that are left about it;
    what earlier collapses took of the tolerance there counts. Corners at open edges stay, so that meshes which meet
    there go on meeting.

    Args:
        mesh: Mesh of one color.
        tolerance: Distance of a corner that is left out from the surface that is left, as far as errors add up in one
            place; measured on balls, the largest is 1.3 times that [m].
    """
    vertices, faces = mesh.vertices, mesh.faces
    left = len(vertices)
    used, is_open = np.zeros(len(vertices)), np.ones(len(vertices), dtype=bool)
    for _ in range(_ROUNDS):
        found = _collapses(vertices, faces, used, is_open, tolerance)
        is_open[:] = False
        is_open[found.corner] = True
        made = found.at(_are_apart(faces, found, len(vertices), tolerance))
        if len(made.corner) <= _WORTH * left:
            break
        left -= len(made.corner)
        goes = np.arange(len(vertices))
        goes[made.corner] = made.onto
        np.maximum.at(used, made.onto, made.error)
        faces = goes[faces]
        faces = faces[(faces != faces[:, [1, 2, 0]]).all(axis=1)]
        changed = np.zeros(len(vertices), dtype=bool)
        changed[made.onto] = True
        is_open[faces[changed[faces].any(axis=1)]] = True
    kept, faces = np.unique(faces, return_inverse=True)
    return Mesh(vertices[kept], faces.reshape(-1, 3))


def clustered(mesh: Mesh, most: int) -> tuple[Mesh, float]:
    """A mesh of at most `most` triangles, possibly none: corners in one cell of a grid become one, amid them.

    Args:
        mesh: Mesh with finite corners, which may state colors.
        most: Number of triangles.

    Returns:
        The mesh, and the largest distance by which a corner has moved [m].
    """
    low, length = mesh.vertices.min(axis=0), float(np.ptp(mesh.vertices, axis=0).max()) or 1.0
    cells = max(1.0, np.sqrt(most / 2))  # Along the longest side.
    while True:
        place = np.minimum(cells * ((mesh.vertices - low) / length), cells - 0.5).astype(np.int64)
        known, of = np.unique(place @ (int(cells) + 1) ** np.arange(3), return_inverse=True)
        faces = of[mesh.faces]
        is_kept = (faces != faces[:, [1, 2, 0]]).all(axis=1)
        # Of equal ones that are seen from the same side, one; each begins with its least corner.
        turned = np.take_along_axis(faces, (faces.argmin(axis=1)[:, None] + np.arange(3)) % 3, axis=1)
        _, first = np.unique(turned[is_kept] @ len(known) ** np.arange(3), return_index=True)
        if len(first) <= most:
            break
        cells = max(1.0, cells / np.sqrt(2.0))
    index = np.flatnonzero(is_kept)[first]
    middle = np.stack([np.bincount(of, weights=x) for x in mesh.vertices.T], axis=1) / np.bincount(of)[:, None]
    moved = float(np.linalg.norm(middle[of] - mesh.vertices, axis=1).max())
    colors = None if mesh.colors is None else mesh.colors[index]
    places = None if mesh.places is None else mesh.places[index]
    return Mesh(middle, faces[index], colors, places), moved


def _collapses(
    vertices: Array, faces: Faces, used: Array, is_open: npt.NDArray[np.bool_], tolerance: float
) -> _Collapses:
    """The collapse with the smallest error of each open corner that has one.

    Places are relative to the corner that goes: a triangle about it has the other corners a and b, and is (t, a, b)
    once the corner has gone to t. The normals, as long as twice the areas, are n = a x b and m = n + t x (a - b).
    """
    fans = _fans(faces, len(vertices), is_open)
    corners = np.ascontiguousarray(vertices.T)
    corner = corners.take(fans.hub, axis=1)
    a, b = corners.take(fans.ahead, axis=1) - corner, corners.take(fans.behind, axis=1) - corner
    n, apart = _cross(a, b), a - b
    n_length = _length(n)
    spoke, face = fans.around(fans.hub)  # Collapse of each spoke's corner to its other end; triangles about the corner.
    target = fans.ahead.take(spoke)
    lasting = np.flatnonzero((fans.ahead.take(face) != target) & (fans.behind.take(face) != target))
    spoke, face = spoke.take(lasting), face.take(lasting)
    m = n.take(face, axis=1) + _cross(a.take(spoke, axis=1), apart.take(face, axis=1))
    m_length, length = _length(m), n_length.take(face)
    stays = _dot(m, n.take(face, axis=1)) >= _TURN * m_length * length
    is_refused = np.zeros(len(fans.hub), dtype=bool)
    is_refused[spoke[~stays | (m_length == 0.0) | (length == 0.0)]] = True
    allowed = np.flatnonzero(~is_refused[spoke])
    spoke, face, m, m_length = spoke.take(allowed), face.take(allowed), m.take(allowed, axis=1), m_length.take(allowed)
    t = a.take(spoke, axis=1)
    # The corner, which is the origin, lies over the triangle: of the edge from a to b, m n > 0 says so.
    covers = (_dot(m, _cross(t, a.take(face, axis=1))) >= 0.0) & (_dot(m, _cross(b.take(face, axis=1), t)) >= 0.0)
    error = np.full(len(fans.hub), -1.0)
    np.maximum.at(error, spoke[covers], np.abs(_dot(n.take(face, axis=1), t) / m_length)[covers])
    error = np.where(error < 0.0, np.inf, error) + used[fans.hub]
    by_error = np.lexsort((error, fans.hub))
    best = by_error[np.diff(fans.hub[by_error], prepend=-1) > 0]
    best = best[error[best] <= tolerance]
    return _Collapses(fans.hub[best], fans.ahead[best], error[best])


def _fans(faces: Faces, count: int, is_open: npt.NDArray[np.bool_]) -> _Fans:
    """Fans of the open corners that have closed ones."""
    hub, ahead, behind = (np.roll(faces, -k, axis=1).ravel() for k in range(3))
    forth, back = np.sort(hub * count + ahead), np.sort(hub * count + behind)
    # Each neighbour is once ahead and once behind.
    is_inner = np.ones(count, dtype=bool)
    is_inner[forth[~_among(back, forth)] // count] = False
    is_inner[back[~_among(forth, back)] // count] = False
    is_inner[forth[1:][forth[1:] == forth[:-1]] // count] = False
    kept = np.flatnonzero((is_inner & is_open)[hub])
    kept = kept[np.argsort(hub[kept], kind="stable")]
    number = np.bincount(hub[kept], minlength=count)
    return _Fans(hub[kept], ahead[kept], behind[kept], np.cumsum(number) - number, number)


def _among(keys: Faces, asked: Faces) -> npt.NDArray[np.bool_]:
    """Which of the asked keys are among sorted ones."""
    if not len(keys):
        return np.zeros(len(asked), dtype=bool)
    found: npt.NDArray[np.bool_] = keys[np.minimum(np.searchsorted(keys, asked), len(keys) - 1)] == asked
    return found


def _are_apart(faces: Faces, found: _Collapses, count: int, tolerance: float) -> npt.NDArray[np.bool_]:
    """Which collapses come first of all that change one of their triangles; then of those that are left, and so on."""
    shuffled = np.random.default_rng(0).permutation(len(found.corner))
    rank = np.full(count, count)
    rank[found.corner[np.lexsort((shuffled, np.ceil(_LEVELS * found.error / tolerance)))]] = np.arange(len(shuffled))
    is_chosen = np.zeros(count, dtype=bool)
    for _ in range(_CHOICES):
        faces = faces[(rank[faces] < count).any(axis=1)]
        ranks = rank[faces]
        least = rank.copy()
        np.minimum.at(least, faces.ravel(), np.repeat(ranks.min(axis=1), 3))
        comes_first = (least == rank) & (rank < count)
        is_chosen |= comes_first
        rank[faces[comes_first[faces].any(axis=1)]] = count
    chosen: npt.NDArray[np.bool_] = is_chosen[found.corner]
    return chosen


def _cross(first: Array, second: Array) -> Array:
    """Cross products of vectors (3, n)."""
    (a, b, c), (x, y, z) = first, second
    product = np.empty_like(first)
    product[0] = b * z - c * y
    product[1] = c * x - a * z
    product[2] = a * y - b * x
    return product


def _dot(first: Array, second: Array) -> Array:
    """Scalar products of vectors (3, n)."""
    product: Array = first[0] * second[0] + first[1] * second[1] + first[2] * second[2]
    return product


def _length(vectors: Array) -> Array:
    """Lengths of vectors (3, n)."""
    length: Array = np.sqrt(_dot(vectors, vectors))
    return length
