"""A joint whose speeds are free: what it takes of them out of the equations of the bodies beyond it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.factors import SingularMatrixError
from symofros.expr.graph import Graph
from symofros.expr.vector import Vec3
from symofros.mechanics.dynamics.acceleration import Acceleration
from symofros.mechanics.dynamics.forward.articulated_inertia import ArticulatedInertia, Rows, wrench_in_parent
from symofros.mechanics.kinematics.links import MovingLink
from symofros.mechanics.spatial.wrench import Wrench


class ArticulatedBody(NamedTuple):
    """A body and all it carries, the joints beyond it free: the wrench inertia * (acceleration) + bias on it (eq. 39).

    Attributes:
        inertia: Articulated inertia about Lo, in L.
        bias: Wrench at zero acceleration, about Lo, in L.
    """

    inertia: ArticulatedInertia
    bias: Wrench

    def with_acceleration(self, x: Acceleration) -> ArticulatedBody:
        """The body with a known part of its acceleration made part of the bias (eq. 43)."""
        return ArticulatedBody(self.inertia, self.bias + self.inertia.times(x))

    def added_to_parent(self, link: MovingLink, parent: ArticulatedBody) -> ArticulatedBody:
        """The parent, about its own origin, with this body fixed to it at the joint's position (eqs. 11, 44)."""
        inertia = self.inertia.added_to_parent(link, parent.inertia)
        return ArticulatedBody(inertia, parent.bias + wrench_in_parent(link, self.bias))


class FreeJoint:
    """One joint's speeds, eliminated from the equations of the bodies beyond it (eqs. 41, 42).

    Args:
        g: The graph.
        body: Body whose acceleration x' all rows refer to, with the joint locked.
        U: Wrench on that body per rate of each speed (n).
        D: Generalized inertia of the speeds (n x n).
        d: Forces on the speeds at v' = 0, less generalized forces (n).
        in_parent: Whether that body is the parent; otherwise the link itself, as it moves at v' = 0.
        v: Index of the first speed.

    Attributes:
        body: Articulated body with the joint free.
        in_parent: Whether that body is the parent.

    Raises:
        SingularMatrixError: A pivot is the number zero.
    """

    def __init__(
        self,
        g: Graph,
        body: ArticulatedBody,
        U: Sequence[Wrench],
        D: Rows,
        d: Sequence[Edge],
        in_parent: bool,
        v: int,
    ) -> None:
        self.in_parent = in_parent
        self._g = g
        self.ratios: list[list[Edge]] = []
        self.inverses: list[Edge] = []
        self._free: list[Edge] = []
        rows = body.inertia.rows() + [[*U_k.f, *U_k.n, *D[k]] for k, U_k in enumerate(U)]
        right = [*body.bias.f, *body.bias.n, *d]
        for k in reversed(range(6, len(rows))):
            row, pivot = rows[k], rows[k][k]
            if pivot == ZERO:
                raise SingularMatrixError(v + k - 6)
            inverse = g.div(ONE, pivot)
            self.inverses.insert(0, inverse)
            ratios = [_quotient(g, edge, pivot, inverse) for edge in row[:k]]
            for i in range(k):
                for j in range(i + 1):
                    rows[i][j] = g.sub(rows[i][j], _product(g, (row[i], ratios[i]), (row[j], ratios[j])))
                right[i] = g.sub(right[i], g.mul(ratios[i], right[k]))
            self.ratios.insert(0, ratios)
            self._free.insert(0, -g.mul(right[k], inverse))
        wrench = Wrench(Vec3(g, *right[:3]), Vec3(g, *right[3:6]))
        self.body = ArticulatedBody(ArticulatedInertia.of_rows(g, rows), wrench)

    def rates(self, x: Acceleration) -> list[Edge]:
        """Rates v' of the joint's speeds at an acceleration x' of the body (eq. 45)."""
        known = [*x.a, *x.alpha]
        for ratios, free in zip(self.ratios, self._free, strict=True):
            products = [-self._g.mul(a, b) for a, b in zip(ratios, known, strict=True)]
            known.append(_sum_in_pairs(self._g, [free, *products]))
        return known[6:]


def _quotient(g: Graph, edge: Edge, pivot: Edge, inverse: Edge) -> Edge:
    """Quotient edge / pivot: exactly 1 for the pivot, so that entries which a free joint makes vanish fold to zero."""
    return g.div(edge, pivot) if abs(edge) == abs(pivot) else g.mul(edge, inverse)


def _product(g: Graph, x: tuple[Edge, Edge], y: tuple[Edge, Edge]) -> Edge:
    """Product x y / pivot of two entries, each with its quotient; the same node whichever comes first."""
    if abs(x[1]) == ONE or (abs(y[1]) != ONE and abs(x[0]) > abs(y[0])):
        return g.mul(x[1], y[0])
    return g.mul(x[0], y[1])


def _sum_in_pairs(g: Graph, terms: Sequence[Edge]) -> Edge:
    """A sum that waits for fewer additions in a row: along a chain all links wait for it."""
    while len(terms) > 1:
        terms = [g.sum(terms[i : i + 2]) for i in range(0, len(terms), 2)]
    return terms[0]
