"""The moving bodies of a rigid tree in CasADi's scalars, and what passes from one to its parent."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

import symofros as sf

from ...mechanics.assembly import BASE, Assembly, Mover
from ..reach import armature
from .algebra import (
    ZERO,
    Matrix,
    Scalar,
    Vector,
    about,
    add,
    cross,
    dot,
    exact,
    of_quaternion,
    plus,
    product,
    scale,
    skew,
    symmetric,
    times,
    transposed,
    turned,
)

UNIT: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
Motion = tuple[Vector, Vector]
# Of an articulated body: n = J w' + H a, f = H^T w' + K a.
Articulated = tuple[Matrix, Matrix, Matrix]


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
        axes: Along which a free joint's speeds are.
    """

    parent: int
    R: Matrix
    p: Vector
    mass: float
    mc: Vector
    J: Matrix
    axis: Vector | None
    slides: bool
    v: slice
    armature: float
    axes: Matrix = UNIT

    def columns(self) -> list[tuple[Vector, Vector]]:
        """The joint's motions with unit speeds: (angular, linear)."""
        if self.axis is None:
            return [(ZERO, e) for e in self.axes] + [(e, ZERO) for e in self.axes]
        return [(ZERO, self.axis) if self.slides else (self.axis, ZERO)]


def links_of(system: sf.System, assembly: Assembly, q: Any) -> list[Link]:
    """Every moving body of a description.

    Args:
        system: A rigid tree.
        assembly: The same as numbers.
        q: CasADi's coordinates.
    """
    return [_link(mover, q, armature(system, mover)) for mover in assembly.movers]


def _link(mover: Mover, q_all: Any, armature: float) -> Link:
    R_AP, p_AP = exact(mover.X_AP.R), exact(mover.X_AP.p)
    q = [q_all[i] for i in range(mover.q.start, mover.q.stop)]
    merged = mover.merged()
    K = skew(exact(merged.p_BC))
    J = merged.J_BC - merged.mass * np.array(product(K, K))
    inertia = merged.mass, exact(merged.mass * merged.p_BC), exact(J)
    if mover.kind == "free":
        R, p = product(R_AP, of_quaternion(q[3:])), add(p_AP, times(R_AP, q[:3]))
        return Link(mover.parent, R, p, *inertia, None, False, mover.v, armature)
    axis = exact(mover.axis)
    if mover.kind == "prismatic":
        p = add(p_AP, scale(q[0], times(R_AP, axis)))
        return Link(mover.parent, R_AP, p, *inertia, axis, True, mover.v, armature)
    R = product(R_AP, about(axis, ca.sin(q[0]), ca.cos(q[0])))
    return Link(mover.parent, R, p_AP, *inertia, axis, False, mover.v, armature)


def in_world(links: Sequence[Link]) -> list[Link]:
    """The same bodies along world axes, so that wrenches pass from body to body without a rotation."""
    aligned: list[Link] = []
    rotations: list[Matrix] = []
    for link in links:
        R_A = rotations[link.parent] if link.parent != BASE else UNIT
        R = product(R_A, link.R)
        rotations.append(R)
        axis = None if link.axis is None else times(R, link.axis)
        aligned.append(
            replace(
                link,
                R=UNIT,
                p=times(R_A, link.p),
                mc=times(R, link.mc),
                J=turned(R, link.J),
                axis=axis,
                axes=transposed(R),
            )
        )
    return aligned


def shifted(link: Link, n: Vector, f: Vector) -> Motion:
    """A wrench about the body's origin, about the parent's, in its axes."""
    f = times(link.R, f)
    return add(times(link.R, n), cross(link.p, f)), f


def composed(onto: tuple[Scalar, Vector, Matrix], link: Link, body: tuple[Scalar, Vector, Matrix]) -> Any:
    """A parent's composite body with a child's added."""
    m, mc, J = body
    h, p = times(link.R, mc), link.p
    J = turned(link.R, J)
    far = 2.0 * dot(p, h) + m * dot(p, p)
    J = plus(J, symmetric(lambda i, j: (far if i == j else 0.0) - p[i] * h[j] - h[i] * p[j] - m * p[i] * p[j]))
    return onto[0] + m, add(onto[1], h, scale(m, p)), plus(onto[2], J)


def shifted_to_parent(link: Link, J: Matrix, H: Matrix, K: Matrix) -> Articulated:
    """An articulated inertia (n = J w' + H a, f = H^T w' + K a) about the parent's origin, in its axes."""
    R, P = link.R, skew(link.p)
    J, H, K = turned(R, J), product(product(R, H), transposed(R)), turned(R, K)
    at_parent = plus(H, product(P, K))
    HP, PH = product(H, P), product(P, transposed(at_parent))
    return symmetric(lambda i, j: J[i][j] - HP[i][j] + PH[i][j]), at_parent, K


def joined(a: Articulated, b: Articulated) -> Articulated:
    """The sum of two about one point."""
    return plus(a[0], b[0]), plus(a[1], b[1]), plus(a[2], b[2])
