"""One frame's motion in another: a rotation, a displacement, partial velocities (docs/theory/rigid.md, section 2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from symofros.expr.derivative import directional
from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.vector import Mat3, Vec3
from symofros.mechanics.spatial.rotations import (
    AxisRotation,
    Factor,
    MatrixRotation,
    RotationProduct,
    axis_angle_matrix,
)


@dataclass(frozen=True)
class PartialVelocity:
    """Partial velocity of one speed, and the derivatives of its components.

    Attributes:
        w: w_PD_D per unit speed; w_AL_L of a link.
        v: v_PDo_D per unit speed; v_ALo_L of a link.
        w_rate: Derivative of the components of w in D.
        v_rate: Derivative of the components of v in D.
    """

    w: Vec3
    v: Vec3
    w_rate: Vec3
    v_rate: Vec3


@dataclass(frozen=True)
class AcrossJoint:
    """Motion of the distal frame D in the proximal frame P.

    Attributes:
        R_PD: Rotation.
        p_PD: Position from Po to Do, in P [m].
        partial_velocities: Partial velocities of D in P, in D, one a speed.
    """

    R_PD: RotationProduct
    p_PD: Vec3
    partial_velocities: tuple[PartialVelocity, ...]


def across_rotations(
    g: Graph, q: tuple[Edge, ...], speeds: Sequence[Edge], p_PD: Vec3, rotations: list[JointRotation]
) -> AcrossJoint:
    """Motion across a displacement and rotations after it, where the speeds are the rates of the coordinates.

    Args:
        g: The graph.
        q: The coordinates.
        speeds: Rates of the coordinates.
        p_PD: Displacement, in P.
        rotations: Rotations after the displacement, first to last.
    """
    R = RotationProduct(g, tuple(rotation.factor for rotation in rotations))
    partials = _partial_velocities(g, q, p_PD, R, rotations)
    return AcrossJoint(R, p_PD, tuple(with_rates(g, q, speeds, w, v) for w, v in partials))


@dataclass(frozen=True)
class JointRotation:
    """One rotation of a joint: about an axis by an angle, or by a matrix whose entries depend on q."""

    factor: Factor
    axis: Vec3 | None = None
    angle: Edge = ZERO


def rotation_about(n: Vec3, angle: Edge, k: int | None, negative: bool) -> JointRotation:
    """Rotation about a unit axis.

    Args:
        n: Unit axis.
        angle: Angle of the rotation [rad].
        k: The coordinate axis that n lies along; None if along none.
        negative: Whether n points against it.
    """
    g = n.g
    c, s = g.call("cos", angle), g.call("sin", angle)
    factor = MatrixRotation(axis_angle_matrix(n, c, s)) if k is None else AxisRotation(k, c, -s if negative else s)
    return JointRotation(factor, n, angle)


def _partial_velocities(
    g: Graph, q: tuple[Edge, ...], p_PD: Vec3, R: RotationProduct, rotations: list[JointRotation]
) -> list[tuple[Vec3, Vec3]]:
    """Partial velocities w and v of v = q', in D (eqs. 32, 33)."""
    partials = []
    for coordinate in q:
        seeds = {coordinate: ONE}
        w = Vec3(g)
        for rotation in rotations:
            # What was turned so far is seen from the next frame, where this rotation adds its own part.
            w = RotationProduct(g, (rotation.factor,)).apply_inverse(w) + _angular_velocity(g, rotation, seeds)
        v = R.apply_inverse(Vec3(g, *directional(g, list(p_PD), seeds)))
        partials.append((w, v))
    return partials


def _angular_velocity(g: Graph, rotation: JointRotation, seeds: dict[Edge, Edge]) -> Vec3:
    """Angular velocity of one rotation, in the frame it leads to."""
    if rotation.axis is not None:
        # The axis is the same vector on both sides of the rotation.
        return rotation.axis.scaled(directional(g, [rotation.angle], seeds)[0])
    R = rotation.factor.matrix(g)
    R_rate = Mat3(g, tuple(directional(g, list(R.entries), seeds)))
    columns = [R.column(i) for i in range(3)]
    rates = [R_rate.column(i) for i in range(3)]
    return Vec3(g, columns[2].dot(rates[1]), columns[0].dot(rates[2]), columns[1].dot(rates[0]))


def with_rates(g: Graph, q: tuple[Edge, ...], speeds: Sequence[Edge], w: Vec3, v: Vec3) -> PartialVelocity:
    """A partial velocity with its derivative along q' = speeds."""
    seeds = dict(zip(q, speeds, strict=True))
    w_rate, v_rate = (Vec3(g, *directional(g, list(x), seeds)) for x in (w, v))
    return PartialVelocity(w, v, w_rate, v_rate)
