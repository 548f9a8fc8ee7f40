"""Across one joint: the motion of its distal frame D in its proximal frame P (docs/theory/rigid.md, section 2).

Every joint is a displacement p_PD(q) in P followed by turns. Partial velocities follow from that alone: those of the
turns by composition, those of formulas by differentiating the graph; no joint needs code of its own in the dynamics.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from symofros.description.joint import Joint
from symofros.description.joint_kinds import JointKindName
from symofros.expr.derivative import directional
from symofros.expr.edges import ONE, ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.quaternion import Quaternion
from symofros.expr.vector import Mat3, Vec3
from symofros.mechanics.kinematics.lowering import Lowering
from symofros.mechanics.kinematics.rotations import (
    AxisTurn,
    Factor,
    MatrixTurn,
    Turn,
    axis_angle_matrix,
    unit_vector,
)


@dataclass(frozen=True)
class Column:
    """The partial velocity of one speed: w_PD_D and v_PDo_D per unit speed, both in D, and their rates in D."""

    w: Vec3
    v: Vec3
    w_rate: Vec3
    v_rate: Vec3


@dataclass(frozen=True)
class AcrossJoint:
    """How D moves in P.

    Attributes:
        R_PD: Rotation.
        p_PD: From Po to Do, in P.
        columns: Partial velocities, one a speed.
    """

    R_PD: Turn
    p_PD: Vec3
    columns: tuple[Column, ...]


@dataclass(frozen=True)
class Axis:
    """A joint's main axis in P, where P and D are turned so that it lies along a coordinate axis if it is constant.

    Attributes:
        n: Unit vector.
        k: The coordinate axis it lies along; None if along none.
        negative: Whether it points against it.
    """

    n: Vec3
    k: int | None
    negative: bool


def across_joint(
    lowering: Lowering, joint: Joint, q: tuple[Edge, ...], speeds: Sequence[Edge], axis: Axis
) -> AcrossJoint:
    """The motion of D in P.

    Args:
        lowering: For the formulas and numbers of the joint.
        joint: What the user stated.
        q: Coordinates of the joint (nq_j).
        speeds: Its speeds (nv_j), for the rates of partial velocities that depend on q.
        axis: Its main axis.

    """
    g = lowering.g
    zero = Vec3(g)
    if joint.traits.quasi_velocities:
        R = Turn(g, (MatrixTurn(Quaternion.of(g, *q[-4:]).matrix),))
        units = [Vec3.unit(g, i) for i in range(3)]
        turning = [Column(unit, zero, zero, zero) for unit in units]
        moving = [Column(zero, unit, zero, zero) for unit in units] if joint.traits.manifold == "pose" else []
        return AcrossJoint(R, Vec3(g, *q[:-4]), tuple(moving + turning))
    return moved(g, q, speeds, *_DISPLACEMENTS[joint.kind](lowering, joint, q, axis))


def moved(g: Graph, q: tuple[Edge, ...], speeds: Sequence[Edge], p_PD: Vec3, turns: list[AngleTurn]) -> AcrossJoint:
    """The motion that a displacement and turns make, where the speeds are the rates of the coordinates.

    Args:
        g: The graph.
        q: The coordinates.
        speeds: Their rates.
        p_PD: The displacement, in P.
        turns: What follows it, first to last.
    """
    R = Turn(g, tuple(turn.factor for turn in turns))
    columns = _differentiated(g, q, p_PD, R, turns)
    return AcrossJoint(R, p_PD, tuple(_with_rates(g, q, speeds, w, v) for w, v in columns))


@dataclass(frozen=True)
class AngleTurn:
    """One turn of a joint: about an axis by an angle, or by a matrix whose entries depend on q."""

    factor: Factor
    n: Vec3 | None = None
    angle: Edge = ZERO


def about(n: Vec3, angle: Edge, k: int | None, negative: bool) -> AngleTurn:
    """A turn about a unit axis.

    Args:
        n: The axis.
        angle: Of the turn.
        k: The coordinate axis that n lies along; None if along none.
        negative: Whether n points against it.
    """
    g = n.g
    c, s = g.call("cos", angle), g.call("sin", angle)
    factor = MatrixTurn(axis_angle_matrix(n, c, s)) if k is None else AxisTurn(k, c, -s if negative else s)
    return AngleTurn(factor, n, angle)


def _about_stated(n: Vec3, angle: Edge) -> AngleTurn:
    """A turn about any unit axis, cheap if it is a coordinate axis."""
    along = [i for i, edge in enumerate(n) if abs(edge) == ONE]
    return about(n, angle, along[0], tuple(n)[along[0]] < 0) if along else about(n, angle, None, False)


# Displacement p_PD and the turns that follow it.
_Displacement = tuple[Vec3, list["AngleTurn"]]


def _fixed(lowering: Lowering, joint: Joint, q: tuple[Edge, ...], axis: Axis) -> _Displacement:
    return Vec3(lowering.g), []


def _revolute(lowering: Lowering, joint: Joint, q: tuple[Edge, ...], axis: Axis) -> _Displacement:
    return Vec3(lowering.g), [about(axis.n, q[0], axis.k, axis.negative)]


def _prismatic(lowering: Lowering, joint: Joint, q: tuple[Edge, ...], axis: Axis) -> _Displacement:
    return axis.n.scaled(q[0]), []


def _screw(lowering: Lowering, joint: Joint, q: tuple[Edge, ...], axis: Axis) -> _Displacement:
    shift = lowering.g.mul(lowering.value(joint.pitch), q[0])
    return axis.n.scaled(shift), [about(axis.n, q[0], axis.k, axis.negative)]


def _cylindrical(lowering: Lowering, joint: Joint, q: tuple[Edge, ...], axis: Axis) -> _Displacement:
    return axis.n.scaled(q[1]), [about(axis.n, q[0], axis.k, axis.negative)]


def _universal(lowering: Lowering, joint: Joint, q: tuple[Edge, ...], axis: Axis) -> _Displacement:
    second = unit_vector(lowering.vector(joint.axis2))
    return Vec3(lowering.g), [_about_stated(axis.n, q[0]), _about_stated(second, q[1])]


def _planar(lowering: Lowering, joint: Joint, q: tuple[Edge, ...], axis: Axis) -> _Displacement:
    g = lowering.g
    return Vec3(g, q[0], q[1]), [about(Vec3.unit(g, 2), q[2], 2, False)]


def _general(lowering: Lowering, joint: Joint, q: tuple[Edge, ...], axis: Axis) -> _Displacement:
    return lowering.vector(joint.moving_position), _stated_turns(lowering, joint)


# Kinds whose speeds are the rates of their coordinates.
_DISPLACEMENTS: dict[JointKindName, Callable[[Lowering, Joint, tuple[Edge, ...], Axis], _Displacement]] = {
    "fixed": _fixed,
    "revolute": _revolute,
    "continuous": _revolute,
    "prismatic": _prismatic,
    "screw": _screw,
    "cylindrical": _cylindrical,
    "universal": _universal,
    "planar": _planar,
    "general": _general,
}


def _stated_turns(lowering: Lowering, joint: Joint) -> list[AngleTurn]:
    """The turns of the user's own R_PD(q)."""
    g, rotation = lowering.g, joint.moving_rotation
    if rotation.is_identity:
        return []
    values = [lowering.value(value) for value in rotation.values]
    if rotation.kind == "rpy":
        return [about(Vec3.unit(g, k), values[k], k, False) for k in (2, 1, 0) if values[k] != ZERO]
    if rotation.kind == "axis_angle" and all(map(g.is_constant, values[:3])):
        return [_about_stated(unit_vector(Vec3(g, *values[:3])), values[3])]
    return [AngleTurn(MatrixTurn(lowering.rotation(rotation)))]


def _differentiated(
    g: Graph, q: tuple[Edge, ...], p_PD: Vec3, R: Turn, turns: list[AngleTurn]
) -> list[tuple[Vec3, Vec3]]:
    """Partial velocities w and v of v = q', in D (eqs. 32, 33)."""
    columns = []
    for coordinate in q:
        seeds = {coordinate: ONE}
        w = Vec3(g)
        for turn in turns:
            # What was turned so far is seen from the next frame, where this turn adds its own part.
            w = Turn(g, (turn.factor,)).apply_inverse(w) + _turn_rate(g, turn, seeds)
        v = R.apply_inverse(Vec3(g, *directional(g, list(p_PD), seeds)))
        columns.append((w, v))
    return columns


def _turn_rate(g: Graph, turn: AngleTurn, seeds: dict[Edge, Edge]) -> Vec3:
    """Angular velocity of one turn, in the frame it leads to."""
    if turn.n is not None:
        # The axis is the same vector on both sides of the turn.
        return turn.n.scaled(directional(g, [turn.angle], seeds)[0])
    R = turn.factor.matrix(g)
    R_rate = Mat3(g, tuple(directional(g, list(R.entries), seeds)))
    columns = [R.column(i) for i in range(3)]
    rates = [R_rate.column(i) for i in range(3)]
    return Vec3(g, columns[2].dot(rates[1]), columns[0].dot(rates[2]), columns[1].dot(rates[0]))


def _with_rates(g: Graph, q: tuple[Edge, ...], speeds: Sequence[Edge], w: Vec3, v: Vec3) -> Column:
    seeds = dict(zip(q, speeds, strict=True))
    w_rate, v_rate = (Vec3(g, *directional(g, list(x), seeds)) for x in (w, v))
    return Column(w, v, w_rate, v_rate)


def neutral_coordinates(joint: Joint, nq: int) -> tuple[float, ...]:
    """A configuration on the manifold: zeros, and quaternions of no rotation."""
    return (*(0.0,) * (nq - 1), 1.0) if joint.traits.quasi_velocities else (0.0,) * nq
