"""Wrenches of several speeds at one link in packs, one lane a speed: how they pass a joint, and their virtual power."""

from __future__ import annotations

from collections.abc import Sequence

from symofros.expr.edges import ONE, Edge
from symofros.expr.packs.combine import linear_combination
from symofros.expr.packs.pack import EMPTY, SignedPack
from symofros.expr.vector import Vec3
from symofros.mechanics.kinematics.links import MovingLink
from symofros.mechanics.spatial.across import PartialVelocity

# Six components: force (or linear momentum), then moment (or angular momentum) about the link's origin, in its frame.
NO_WRENCHES: list[SignedPack] = [(ONE, EMPTY)] * 6


def with_wrench(wrenches: Sequence[SignedPack], lane: int, f: Vec3, n: Vec3) -> list[SignedPack]:
    """The same with one lane filled."""
    return [
        (sign, pack.with_lane(lane, edge if sign == ONE else -edge))
        for (sign, pack), edge in zip(wrenches, (*f, *n), strict=True)
    ]


def wrenches_in_parent(link: MovingLink, wrenches: Sequence[SignedPack]) -> list[SignedPack]:
    """Wrenches about Lo in L -> about Ao in A: f_A = R f, n_A = R n + p x f_A."""
    g = link.p_AL.g
    f, n = list(wrenches[:3]), list(wrenches[3:])
    for factor in reversed(link.R_AL.factors):
        rows = [factor.matrix(g).row(i) for i in range(3)]
        f = [linear_combination(g, list(zip(row, f, strict=True))) for row in rows]
        n = [linear_combination(g, list(zip(row, n, strict=True))) for row in rows]
    p = link.p_AL
    return f + [
        linear_combination(g, [(ONE, n[0]), (p.y, f[2]), (-p.z, f[1])]),
        linear_combination(g, [(ONE, n[1]), (p.z, f[0]), (-p.x, f[2])]),
        linear_combination(g, [(ONE, n[2]), (p.x, f[1]), (-p.y, f[0])]),
    ]


def virtual_powers(partial: PartialVelocity, wrenches: Sequence[SignedPack]) -> SignedPack:
    """Virtual power of each wrench per unit of one speed of the link's joint (rigid.md, eq. 20)."""
    factors: tuple[Edge, ...] = (*partial.v, *partial.w)
    return linear_combination(partial.w.g, list(zip(factors, wrenches, strict=True)))
