"""Quaternions whose entries are edges of a graph: what joints take of the rotations in `symofros.base.rotations`."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from symofros.base import rotations
from symofros.expr.edges import Edge
from symofros.expr.graph import Graph
from symofros.expr.terms import Terms, edges_of, terms
from symofros.expr.vector import Mat3


@dataclass(frozen=True, slots=True)
class Quaternion:
    """A quaternion (x, y, z, w)."""

    g: Graph
    edges: tuple[Edge, ...]

    @staticmethod
    def of(g: Graph, x: Edge, y: Edge, z: Edge, w: Edge) -> Quaternion:
        """The quaternion of four edges."""
        return Quaternion(g, (x, y, z, w))

    def __iter__(self) -> Iterator[Edge]:
        return iter(self.edges)

    @property
    def terms(self) -> Terms:
        """The entries as an array (4) with arithmetic."""
        return terms(self.g, self.edges)

    @property
    def normalized(self) -> Quaternion:
        """The quaternion divided by its length."""
        return Quaternion(self.g, tuple(edges_of(self.g, rotations.normalized(self.terms))))

    @property
    def matrix(self) -> Mat3:
        """The rotation matrix of a unit quaternion."""
        return Mat3(self.g, tuple(edges_of(self.g, rotations.quaternion_matrix(self.terms))))

    def rate(self, axis: int) -> Quaternion:
        """The rate per unit angular velocity along an axis of the rotated frame."""
        rate = rotations.quaternion_rate(self.terms, np.eye(3)[axis])
        return Quaternion(self.g, tuple(edges_of(self.g, rate)))
