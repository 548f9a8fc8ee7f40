"""The inertia of an articulated body: the wrench per acceleration of a link while the joints beyond it are free."""

from __future__ import annotations

from dataclasses import dataclass

from symofros.expr.edges import ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.vector import Mat3, Sym3, Vec3
from symofros.mechanics.dynamics.acceleration import Acceleration
from symofros.mechanics.kinematics.links import MovingLink
from symofros.mechanics.spatial.inertia import LinkInertia
from symofros.mechanics.spatial.wrench import Wrench

Rows = list[list[Edge]]


@dataclass(frozen=True)
class ArticulatedInertia:
    """The wrench f = A a + B alpha, n = B^T a + C alpha about Lo, in L (docs/theory/rigid.md, eq. 39)."""

    A: Sym3
    B: Mat3
    C: Sym3

    @staticmethod
    def none(g: Graph) -> ArticulatedInertia:
        """Zero inertia."""
        return ArticulatedInertia(Sym3(g), Mat3(g, (ZERO,) * 9), Sym3(g))

    @staticmethod
    def of(body: LinkInertia) -> ArticulatedInertia:
        """Inertia of a rigid body: A = m 1, B = -[S], C = J (eq. 40)."""
        g, m, (x, y, z) = body.mp_LLcm.g, body.m, body.mp_LLcm
        return ArticulatedInertia(Sym3(g, m, m, m), Mat3(g, (ZERO, z, -y, -z, ZERO, x, y, -x, ZERO)), body.I_LLo_L)

    @staticmethod
    def of_rows(g: Graph, rows: Rows) -> ArticulatedInertia:
        """The articulated inertia from the lower triangle of its 6 x 6 matrix, ordered (f, a), then (n, alpha)."""

        def block(at: int) -> Sym3:
            return Sym3(g, *(rows[at + i][at + j] for i, j in ((0, 0), (1, 1), (2, 2), (1, 0), (2, 0), (2, 1))))

        return ArticulatedInertia(
            block(0), Mat3(g, tuple(rows[3 + j][i] for i in range(3) for j in range(3))), block(3)
        )

    def rows(self) -> Rows:
        """The 6 x 6 matrix."""
        A, B, C = self.A.matrix(), self.B, self.C.matrix()
        return [[*A.row(i), *B.row(i)] for i in range(3)] + [[*B.column(i), *C.row(i)] for i in range(3)]

    def __add__(self, other: ArticulatedInertia) -> ArticulatedInertia:
        return ArticulatedInertia(self.A + other.A, self.B + other.B, self.C + other.C)

    def times(self, x: Acceleration) -> Wrench:
        """The wrench of an acceleration."""
        return Wrench(self.A.times(x.a) + self.B.times(x.alpha), self.B.T.times(x.a) + self.C.times(x.alpha))

    def added_to_parent(self, link: MovingLink, parent: ArticulatedInertia) -> ArticulatedInertia:
        """The parent's inertia with this one added, about the parent's origin, in the parent's frame (eq. 44).

        Sums end with what is known last, the parts that need B_A: in a chain each link waits for them.
        """
        g, p, axes = self.B.g, link.p_AL, range(3)
        A, B, C = link.R_AL.conjugate(self.A), link.R_AL.conjugate_any(self.B), link.R_AL.conjugate(self.C)
        # Rows of -A [p] are p x those of A, columns of [p] B are p x those of B.
        B_A = Mat3(g, tuple(edge for i in axes for edge in plus_cross(B.row(i), p, A.matrix().row(i))))
        pB_T = Mat3(g, tuple(edge for j in axes for edge in p.cross(B.column(j))))  # The transpose of [p] B.
        C = parent.C + C
        x, y, z = (plus_cross(C.matrix().column(j) + pB_T.column(j), p, B_A.column(j)) for j in axes)
        shifted = ArticulatedInertia(A, B_A, Sym3(g, x.x, y.y, z.z, y.x, z.x, z.y))
        return shifted + ArticulatedInertia(parent.A, parent.B, Sym3(g))


def plus_cross(start: Vec3, a: Vec3, b: Vec3) -> Vec3:
    """Sum start + a x b, product by product: processors multiply and add at once."""
    g, (x, y, z) = start.g, start
    return Vec3(
        g,
        g.sub(g.add(x, g.mul(a.y, b.z)), g.mul(a.z, b.y)),
        g.sub(g.add(y, g.mul(a.z, b.x)), g.mul(a.x, b.z)),
        g.sub(g.add(z, g.mul(a.x, b.y)), g.mul(a.y, b.x)),
    )


def wrench_in_parent(link: MovingLink, wrench: Wrench) -> Wrench:
    """A wrench about Lo, in L -> about Ao, in A (eq. 11)."""
    f = link.R_AL.apply(wrench.f)
    return Wrench(f, plus_cross(link.R_AL.apply(wrench.n), link.p_AL, f))


def acceleration_from_parent(link: MovingLink, x: Acceleration) -> Acceleration:
    """The parent's acceleration -> what the link takes over of it, apart from speeds (eqs. 7, 8)."""
    a = link.R_AL.apply_inverse(plus_cross(x.a, x.alpha, link.p_AL))
    return Acceleration(link.R_AL.apply_inverse(x.alpha), a)
