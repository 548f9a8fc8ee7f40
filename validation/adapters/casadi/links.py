"""The moving bodies of a rigid tree in CasADi's scalars, which drop zeros and ones, and what passes to a parent."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

import symofros as sf

from ...mechanics.assembly import BASE, Assembly, Mover
from ..reach import armature

SX = Any  # CasADi has no types.

ZERO: SX = ca.SX.zeros(3)
UNIT: SX = ca.SX.eye(3)
# Numbers as near to -1, 0 or 1 as this are those: what is left of products of rotations.
_NOISE = 1e-13


def exact(values: Any) -> SX:
    """Numbers as constants, noise about -1, 0 and 1 taken off."""
    given = np.asarray(values, dtype=float)
    nearest = np.round(given) + 0.0  # No -0.0, which CasADi keeps.
    small = (np.abs(nearest) <= 1) & (np.abs(given - nearest) < _NOISE)
    return ca.SX(np.where(small, nearest, given))


def symmetric(A: SX) -> SX:
    """A matrix of which the entries above the diagonal count, so that no others are computed."""
    n = A.shape[0]
    return ca.blockcat([[A[min(i, j), max(i, j)] for j in range(n)] for i in range(n)])


def turned(R: SX, S: SX) -> SX:
    """R S R^T of a symmetric S."""
    return symmetric(R @ S @ R.T)


def about(axis: SX, s: SX, c: SX) -> SX:
    """The rotation about a unit axis by the angle of that sine and cosine; about one of coordinates, 0, 1, s and c."""
    along = axis @ axis.T
    return along + c * (UNIT - along) + s * ca.skew(axis)


def of_quaternion(e: SX) -> SX:
    """R of a unit quaternion (x, y, z, w)."""
    x, y, z, w = _entries(e)
    rows = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
        [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
        [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
    ]
    return ca.blockcat(rows)


def _entries(a: SX) -> list[SX]:
    return list(ca.vertsplit(a))


def solve(A: SX, columns: Sequence[SX]) -> SX:
    """A^-1 times columns, side by side, for a symmetric positive definite A.

    Eliminated from the last row to the first, which keeps the zeros between branches of a tree (L^T D L; Featherstone,
    Rigid Body Dynamics Algorithms, 8.4).
    """
    n = A.shape[0]
    L: dict[tuple[int, int], SX] = {}
    D: dict[int, SX] = {}
    for j in range(n - 1, -1, -1):
        scaled = [A[i, j] - sum((L[k, j] * D[k] * L[k, i] for k in range(j + 1, n)), ca.SX(0)) for i in range(j + 1)]
        D[j] = scaled[j]
        inverse = 1.0 / D[j]
        L |= {(j, i): inverse * scaled[i] for i in range(j)}
    return ca.horzcat(*(_substituted(L, D, column) for column in columns))


def _substituted(L: dict[tuple[int, int], SX], D: dict[int, SX], b: SX) -> SX:
    n, x = b.shape[0], _entries(b)
    for i in range(n - 1, -1, -1):
        x[i] = x[i] - sum((L[k, i] * x[k] for k in range(i + 1, n)), ca.SX(0))
    x = [x[i] / D[i] for i in range(n)]
    for i in range(n):
        x[i] = x[i] - sum((L[i, k] * x[k] for k in range(i)), ca.SX(0))
    return ca.vertcat(*x)


# Angular and linear.
Motion = tuple[SX, SX]
# Of an articulated body: n = J w' + H a, f = H^T w' + K a.
Articulated = tuple[SX, SX, SX]


@dataclass(frozen=True)
class Link:
    """One moving body.

    Attributes:
        parent: Index, or BASE.
        R, p: R_AB(q), p_AB(q) from the parent's frame.
        mass, mc, J: Mass, first moments, inertia about the body's origin.
        axis: Axis of its joint; None for a free one.
        slides: Whether the joint is prismatic.
        v: Slice of its speeds in v.
        armature: Inertia added on the diagonal of M.
        axes: Those, as columns, that a free joint's speeds are along.
    """

    parent: int
    R: SX
    p: SX
    mass: float
    mc: SX
    J: SX
    axis: SX | None
    slides: bool
    v: slice
    armature: float
    axes: SX = UNIT

    def columns(self) -> list[Motion]:
        """The joint's motions with unit speeds: (angular, linear)."""
        if self.axis is None:
            axes = ca.horzsplit(self.axes)
            return [(ZERO, e) for e in axes] + [(e, ZERO) for e in axes]
        return [(ZERO, self.axis) if self.slides else (self.axis, ZERO)]


def links_of(system: sf.System, assembly: Assembly, q: SX) -> list[Link]:
    """Every moving body of a description.

    Args:
        system: A rigid tree.
        assembly: The same as numbers.
        q: CasADi's coordinates.
    """
    return [_link(mover, q, armature(system, mover)) for mover in assembly.movers]


def _link(mover: Mover, q_all: SX, armature: float) -> Link:
    R_AP, p_AP = exact(mover.X_AP.R), exact(mover.X_AP.p)
    q = q_all[mover.q]
    merged = mover.merged()
    K = ca.skew(exact(merged.p_BC))
    inertia = merged.mass, exact(merged.mass * merged.p_BC), exact(ca.DM(merged.J_BC - merged.mass * (K @ K)))
    if mover.kind == "free":
        R, p = R_AP @ of_quaternion(q[3:]), p_AP + R_AP @ q[:3]
        return Link(mover.parent, R, p, *inertia, None, False, mover.v, armature)
    axis = exact(mover.axis)
    if mover.kind == "prismatic":
        return Link(mover.parent, R_AP, p_AP + q * (R_AP @ axis), *inertia, axis, True, mover.v, armature)
    R = R_AP @ about(axis, ca.sin(q), ca.cos(q))
    return Link(mover.parent, R, p_AP, *inertia, axis, False, mover.v, armature)


def in_world(links: Sequence[Link]) -> list[Link]:
    """The same bodies along world axes, so that wrenches pass from body to body without a rotation."""
    aligned: list[Link] = []
    rotations: list[SX] = []
    for link in links:
        R_A = rotations[link.parent] if link.parent != BASE else UNIT
        R = R_A @ link.R
        rotations.append(R)
        axis = None if link.axis is None else R @ link.axis
        moved = {"p": R_A @ link.p, "mc": R @ link.mc, "J": turned(R, link.J), "axis": axis, "axes": R}
        aligned.append(replace(link, R=UNIT, **moved))
    return aligned


def shifted(link: Link, n: SX, f: SX) -> Motion:
    """A wrench about the body's origin, about the parent's, in its axes."""
    f = link.R @ f
    return link.R @ n + ca.cross(link.p, f), f


def composed(onto: tuple[SX, SX, SX], link: Link, body: tuple[SX, SX, SX]) -> tuple[SX, SX, SX]:
    """A parent's composite body with a child's added."""
    m, mc, J = body
    h, p = link.R @ mc, link.p
    far = 2.0 * ca.dot(p, h) + m * ca.dot(p, p)
    apart = far * UNIT - p @ h.T - h @ p.T - m * p @ p.T
    return onto[0] + m, onto[1] + h + m * p, onto[2] + turned(link.R, J) + symmetric(apart)


def shifted_to_parent(link: Link, J: SX, H: SX, K: SX) -> Articulated:
    """An articulated inertia (n = J w' + H a, f = H^T w' + K a) about the parent's origin, in its axes."""
    R, P = link.R, ca.skew(link.p)
    J, H, K = turned(R, J), R @ H @ R.T, turned(R, K)
    at_parent = H + P @ K
    return symmetric(J - H @ P + P @ at_parent.T), at_parent, K


def joined(a: Articulated, b: Articulated) -> Articulated:
    """The sum of two about one point."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]
