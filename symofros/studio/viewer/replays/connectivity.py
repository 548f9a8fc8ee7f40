"""Triangles of a mesh as a walk over its surface, which takes a few bits each where corner numbers take many bytes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from symofros.studio.viewer.drawing.meshes import Faces

BORDER, NEW, AFTER, BEFORE, KNOWN = range(5)
"""What lies beyond an edge of the walk: nothing; a triangle with a corner not met before; with the corner that the
open edge from its end leads to, or that the open edge to its start comes from; with another corner met before."""

_Edge = tuple[int, int]


@dataclass(frozen=True)
class Walk:
    """Triangles in the order in which a walk meets them.

    Attributes:
        steps: BORDER to KNOWN, one a visited edge; NEW or KNOWN for each corner of a triangle that the
            walk begins at (S).
        back: For each KNOWN, how many corners ago that one was met first (K).
        order: Corners in the order in which they are met; those of no triangle last (V).
        near: For each corner in that order three of those before it, a, b, c, which it lies near to a + b - c of;
            -1 of the first (V, 3).
    """

    steps: npt.NDArray[np.uint8]
    back: Faces
    order: Faces
    near: Faces


def walk(faces: Faces, count: int) -> Walk:
    """The walk over a mesh's triangles (F, 3); `count` is the number of its corners."""
    return _Walker(faces, count).walk()


class _Walker:
    """A walk under way; `unpack.js` goes the same one by its steps."""

    def __init__(self, faces: Faces, count: int) -> None:
        self._faces: list[list[int]] = faces.tolist()
        self._beyond: dict[_Edge, list[int]] = {}
        for index, (a, b, c) in enumerate(self._faces):
            for edge in ((a, b), (b, c), (c, a)):
                self._beyond.setdefault(edge, []).append(index)
        self._is_met = [False] * len(self._faces)
        self._number = [-1] * count
        self._steps: list[int] = []
        self._back: list[int] = []
        self._order: list[int] = []
        self._near: list[tuple[int, int, int]] = []
        self._edges: list[_Edge] = []  # To be visited, the last first, as far as they are still open.
        self._open: dict[_Edge, int] = {}  # Edge -> corner across it.
        self._ends: dict[int, list[int]] = {}
        self._starts: dict[int, list[int]] = {}

    def walk(self) -> Walk:
        left = len(self._faces)
        for index, face in enumerate(self._faces):
            if not self._is_met[index]:
                left -= self._begin(index, face)
            while self._edges and left:
                left -= self._visit(self._edges.pop())
        for corner, number in enumerate(self._number):
            if number < 0:
                self._meet(corner, (len(self._order) - 1,) * 3)
        near = np.array(self._near, dtype=np.int64).reshape(-1, 3)
        return Walk(np.array(self._steps, np.uint8), np.array(self._back, np.int64), np.array(self._order), near)

    def _begin(self, index: int, face: list[int]) -> int:
        for corner in face:
            if self._number[corner] < 0:
                self._steps.append(NEW)
                self._meet(corner, (len(self._order) - 1,) * 3)
            else:
                self._refer(corner)
        self._is_met[index] = True
        a, b, c = (self._number[corner] for corner in face)
        for start, end, across in ((a, b, c), (b, c, a), (c, a, b)):
            self._pass(start, end, across)
        return 1

    def _visit(self, edge: _Edge) -> int:
        if edge not in self._open:
            return 0
        across = self._close(edge)
        start, end = edge
        corners = self._order[start], self._order[end]
        index = next((face for face in self._beyond.get(corners, ()) if not self._is_met[face]), None)
        if index is None:
            self._steps.append(BORDER)
            return 0
        self._is_met[index] = True
        face = self._faces[index]
        corner = face[(face.index(corners[0]) + 2) % 3]
        ahead, behind = self._ends.get(end), self._starts.get(start)
        if self._number[corner] < 0:
            self._steps.append(NEW)
            self._meet(corner, (start, end, across))
        elif ahead and ahead[-1] == self._number[corner]:
            self._steps.append(AFTER)
        elif behind and behind[-1] == self._number[corner]:
            self._steps.append(BEFORE)
        else:
            self._refer(corner)
        third = self._number[corner]
        self._pass(end, third, start)
        self._pass(third, start, end)
        return 1

    def _meet(self, corner: int, near: tuple[int, int, int]) -> None:
        self._number[corner] = len(self._order)
        self._order.append(corner)
        self._near.append(near)

    def _refer(self, corner: int) -> None:
        self._steps.append(KNOWN)
        self._back.append(len(self._order) - 1 - self._number[corner])

    def _pass(self, start: int, end: int, across: int) -> None:
        """Pass an edge of a triangle: it closes if it was open; otherwise it opens, as seen from the other side."""
        if (start, end) in self._open:
            self._close((start, end))
        elif (end, start) not in self._open:
            self._open[end, start] = across
            self._edges.append((end, start))
            self._ends.setdefault(end, []).append(start)
            self._starts.setdefault(start, []).append(end)

    def _close(self, edge: _Edge) -> int:
        start, end = edge
        self._ends[start].remove(end)
        self._starts[end].remove(start)
        return self._open.pop(edge)
