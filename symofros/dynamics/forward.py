"""Forward dynamics: M v' = Q - h by the factorisation M = L^T D L, which keeps the zeros between branches.

Eliminating from the tips to the base fills nothing in: L has an entry where M has one (Featherstone 2005, "Efficient
factorization of the joint-space inertia matrix for branched kinematic trees"; docs/theory/rigid.md, section 7).
"""

from __future__ import annotations

from symofros.dynamics.mass_matrix import Matrix
from symofros.expr.graph import ONE, ZERO, Edge, Graph


class SingularMassMatrixError(ArithmeticError):
    """M has no inverse in any state.

    Attributes:
        speed: Index of one whose row depends on those of the speeds after it.
    """

    def __init__(self, speed: int) -> None:
        super().__init__(f"row {speed} depends on the rows after it")
        self.speed = speed


def solve(g: Graph, M: Matrix, right: list[Edge]) -> list[Edge]:
    """The solution x of M x = right.

    Args:
        g: The graph.
        M: Symmetric, with tree-shaped zeros; not changed.
        right: Right-hand side (nv).

    Raises:
        SingularMassMatrixError: A pivot is the number zero.
    """
    n = len(right)
    L = [list(row) for row in M]
    inverse: list[Edge] = [ZERO] * n
    for k in reversed(range(n)):
        if L[k][k] == ZERO:
            raise SingularMassMatrixError(k)
        inverse[k] = g.div(ONE, L[k][k])
        support = [i for i in range(k) if L[k][i] != ZERO]
        for i in reversed(support):
            factor = g.mul(L[k][i], inverse[k])
            for j in support:
                if j <= i:
                    L[i][j] = g.sub(L[i][j], g.mul(factor, L[k][j]))
            L[k][i] = factor
    x = list(right)
    for k in reversed(range(n)):
        for i in range(k):
            x[i] = g.sub(x[i], g.mul(L[k][i], x[k]))
    for k in range(n):
        x[k] = g.mul(x[k], inverse[k])
        for i in range(k):
            x[k] = g.sub(x[k], g.mul(L[k][i], x[i]))
    return x
