"""Meshes with fewer corners that stay within a stated distance of what they were."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from symofros.base.arrays import Array
from symofros.studio.viewer.drawing.meshes import Faces, Mesh

_ROUNDS = 40
_WORTH = 0.02  # Of the corners left, that a round must remove for the next one to be made.
_TURN = np.cos(np.radians(25.0))  # A triangle's normal turns by no more than this in one collapse.
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
        """For each spoke of the given corners (M): which of these it is of, and its index."""
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


def _collapses(
    vertices: Array, faces: Faces, used: Array, is_open: npt.NDArray[np.bool_], tolerance: float
) -> _Collapses:
    """The collapse with the smallest error of each open corner that has one."""
    fans = _fans(faces, len(vertices), is_open)
    each = np.arange(len(fans.hub))
    spoke, face = fans.around(fans.hub)  # Collapse of each spoke's corner to its other end; triangles about the corner.
    starts = np.flatnonzero(np.diff(spoke, prepend=-1))
    corner, target, ahead, behind = (vertices[of] for of in (fans.hub, fans.ahead, fans.ahead, fans.behind))
    normal = _unit(_cross(ahead - corner, behind - corner))
    here, there = corner[spoke], target[spoke]
    ahead, behind = ahead[face], behind[face]
    vanishes = (fans.ahead[face] == fans.ahead[spoke]) | (fans.behind[face] == fans.ahead[spoke])
    left = _unit(_cross(ahead - there, behind - there))
    is_refused = ~vanishes & (_dot(left, normal[face]) < _TURN)
    covers = ~vanishes
    for start, end in ((there, ahead), (ahead, behind), (behind, there)):
        covers &= _dot(left, _cross(end - start, here - start)) >= 0.0
    distance = np.where(is_refused, np.inf, np.where(covers, np.abs(_dot(left, here - there)), -1.0))
    error = np.maximum.reduceat(distance, starts) if len(each) else np.zeros(0)
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
    """Which collapses come first of all that change one of their triangles."""
    shuffled = np.random.default_rng(0).permutation(len(found.corner))
    rank = np.full(count, count)
    rank[found.corner[np.lexsort((shuffled, np.ceil(_LEVELS * found.error / tolerance)))]] = np.arange(len(shuffled))
    least = rank.copy()
    np.minimum.at(least, faces.ravel(), np.repeat(rank[faces].min(axis=1), 3))
    first: npt.NDArray[np.bool_] = least[found.corner] == rank[found.corner]
    return first


def _cross(first: Array, second: Array) -> Array:
    (a, b, c), (x, y, z) = first.T, second.T
    return np.stack([b * z - c * y, c * x - a * z, a * y - b * x], axis=1)


def _dot(first: Array, second: Array) -> Array:
    product: Array = np.einsum("ij,ij->i", first, second)
    return product


def _unit(vectors: Array) -> Array:
    length = np.sqrt(_dot(vectors, vectors))
    unit: Array = vectors / np.where(length > 0.0, length, 1.0)[:, None]
    return unit
