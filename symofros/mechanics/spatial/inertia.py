"""Inertia about a frame's origin, on the graph (docs/theory/rigid.md, section 4)."""

from __future__ import annotations

from dataclasses import dataclass

from symofros.expr.edges import ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.vector import Mat3, Sym3, Vec3
from symofros.mechanics.spatial.rotations import MatrixRotation

# Pairs of axes in the order of Sym3: xx, yy, zz, xy, xz, yz.
PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


@dataclass(frozen=True)
class LinkInertia:
    """Inertia of a link L with all that is fixed to it, or of the composite body that it carries, in L.

    Attributes:
        m: Mass [kg].
        mp_LLcm: First moment of mass about Lo, S in the theory [kg m].
        I_LLo_L: Inertia tensor about Lo, J in the theory [kg m^2].
    """

    m: Edge
    mp_LLcm: Vec3
    I_LLo_L: Sym3

    def __add__(self, other: LinkInertia) -> LinkInertia:
        return LinkInertia(
            self.mp_LLcm.g.add(self.m, other.m), self.mp_LLcm + other.mp_LLcm, self.I_LLo_L + other.I_LLo_L
        )

    def second_moment(self) -> Sym3:
        """Second moment E = int r r^T dm about Lo, in L: 1/2 tr(J) 1 - J."""
        g, J = self.mp_LLcm.g, self.I_LLo_L
        half = g.mul(g.constant(0.5), g.add(g.add(J.xx, J.yy), J.zz))
        return Sym3(g, g.sub(half, J.xx), g.sub(half, J.yy), g.sub(half, J.zz), -J.xy, -J.xz, -J.yz)


def no_inertia(g: Graph) -> LinkInertia:
    """Zero inertia."""
    return LinkInertia(ZERO, Vec3(g), Sym3(g))


def point_inertia(m: Edge, p: Vec3) -> Sym3:
    """Inertia tensor of a point mass: m (p.p 1 - p p^T)."""
    mp = p.scaled(m)
    return _shift_form(mp, p)


def _shift_form(a: Vec3, b: Vec3) -> Sym3:
    """The symmetric matrix (a.b) 1 - a b^T for parallel a, b."""
    g = a.g
    xx, yy, zz = (g.mul(i, j) for i, j in zip(a, b, strict=True))
    return Sym3(g, g.add(yy, zz), g.add(xx, zz), g.add(xx, yy), -g.mul(a.x, b.y), -g.mul(a.x, b.z), -g.mul(a.y, b.z))


def shifted(S: Vec3, J: Sym3, p: Vec3) -> Sym3:
    """Inertia tensor about a new origin, for matter of first moment S and no net mass (eq. 15).

    Args:
        S: First moment about the old origin.
        J: Inertia tensor about the old origin.
        p: Position of the old origin from the new one [m].
    """
    g = S.g
    twice = p + p
    xx, yy, zz = (g.mul(a, b) for a, b in zip(twice, S, strict=True))

    def off(a: Edge, Sb: Edge, b: Edge, Sa: Edge) -> Edge:
        return -g.add(g.mul(a, Sb), g.mul(b, Sa))

    shift = Sym3(
        g,
        g.add(yy, zz),
        g.add(xx, zz),
        g.add(xx, yy),
        off(p.x, S.y, p.y, S.x),
        off(p.x, S.z, p.z, S.x),
        off(p.y, S.z, p.z, S.y),
    )
    return J + shift


def rotated(R: Mat3, J: Sym3) -> Sym3:
    """R J R^T."""
    return MatrixRotation(R).conjugate(R.g, J) if R != Mat3.identity(R.g) else J
