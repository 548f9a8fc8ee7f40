"""The moving bodies of a rigid tree in CasADi's scalars, and what passes from one to its parent."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import casadi as ca

import symofros as sf

from ...mechanics.assembly import BASE, Assembly, Mover
from ..reach import armature
from .algebra import SX, UNIT, ZERO, about, exact, of_quaternion, symmetric, turned

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
