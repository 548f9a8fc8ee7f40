"""Across one joint: the motion of its distal frame D in its proximal frame P (docs/theory/rigid.md, section 2).

Every joint is a displacement p_PD(q) in P followed by rotations. Partial velocities follow from that alone: those of
the rotations by composition, those of formulas by differentiating the graph; the dynamics need no code for a joint.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from symofros.description.joints.joint import Joint
from symofros.description.joints.joint_kinds import JointKindName
from symofros.expr.edges import ZERO, Edge
from symofros.expr.graph import Graph
from symofros.expr.quaternion import Quaternion
from symofros.expr.vector import Vec3
from symofros.mechanics.kinematics.lowering import Lowering
from symofros.mechanics.spatial.across import (
    AcrossJoint,
    JointRotation,
    PartialVelocity,
    across_rotations,
    rotation_about,
)
from symofros.mechanics.spatial.rotations import (
    AxisRotation,
    MatrixRotation,
    RotationProduct,
    coordinate_axis,
    unit_vector,
)
from symofros.mechanics.topology.coordinates import coordinate_names


@dataclass(frozen=True)
class Axis:
    """A joint's main axis in P, where P and D are turned so that it lies along a coordinate axis if it is constant.

    Attributes:
        direction: Unit vector.
        k: The coordinate axis it lies along; None if along none.
        negative: Whether it points against that coordinate axis.
    """

    direction: Vec3
    k: int | None
    negative: bool


def across_joint(
    lowering: Lowering, joint: Joint, q: tuple[Edge, ...], speeds: Sequence[Edge], axis: Axis
) -> AcrossJoint:
    """The motion of D in P.

    Args:
        lowering: Edges of the joint's formulas and numbers.
        joint: The joint as described.
        q: Coordinates of the joint (nq_j).
        speeds: Speeds of the joint (nv_j), for the rates of partial velocities that depend on q.
        axis: Main axis of the joint.

    """
    g = lowering.g
    zero = Vec3(g)
    if joint.traits.quasi_velocities:
        R = RotationProduct(g, (MatrixRotation(Quaternion.of(g, *q[-4:]).matrix),))
        units = [Vec3.unit(g, i) for i in range(3)]
        turning = [PartialVelocity(unit, zero, zero, zero) for unit in units]
        moving = [PartialVelocity(zero, unit, zero, zero) for unit in units] if joint.traits.manifold == "pose" else []
        return AcrossJoint(R, Vec3(g, *q[:-4]), tuple(moving + turning))
    p_PD, rotations = _DISPLACEMENTS[joint.kind](lowering, joint, q, axis)
    _name_sines(g, dict(zip(q, coordinate_names(joint), strict=True)), rotations)
    return across_rotations(g, q, speeds, p_PD, rotations)


def _name_sines(g: Graph, names: dict[Edge, str], rotations: list[JointRotation]) -> None:
    """Call the cosine and the sine of a coordinate by the user's name of it."""
    for rotation in rotations:
        if isinstance(rotation.factor, AxisRotation) and rotation.angle in names:
            g.name(rotation.factor.c, f"cos[{names[rotation.angle]}]")
            g.name(rotation.factor.s, f"sin[{names[rotation.angle]}]")


def _rotation_about_any(n: Vec3, angle: Edge) -> JointRotation:
    """Rotation about any unit axis, cheap if it is a coordinate axis."""
    k, negative = coordinate_axis(n) or (None, False)
    return rotation_about(n, angle, k, negative)


# Displacement p_PD and the rotations that follow it.
_Displacement = tuple[Vec3, list["JointRotation"]]


def _fixed(lowering: Lowering, joint: Joint, q: tuple[Edge, ...], axis: Axis) -> _Displacement:
    return Vec3(lowering.g), []


def _revolute(lowering: Lowering, joint: Joint, q: tuple[Edge, ...], axis: Axis) -> _Displacement:
    return Vec3(lowering.g), [rotation_about(axis.direction, q[0], axis.k, axis.negative)]


def _prismatic(lowering: Lowering, joint: Joint, q: tuple[Edge, ...], axis: Axis) -> _Displacement:
    return axis.direction.scaled(q[0]), []


def _screw(lowering: Lowering, joint: Joint, q: tuple[Edge, ...], axis: Axis) -> _Displacement:
    shift = lowering.g.mul(lowering.value(joint.pitch), q[0])
    return axis.direction.scaled(shift), [rotation_about(axis.direction, q[0], axis.k, axis.negative)]


def _cylindrical(lowering: Lowering, joint: Joint, q: tuple[Edge, ...], axis: Axis) -> _Displacement:
    return axis.direction.scaled(q[1]), [rotation_about(axis.direction, q[0], axis.k, axis.negative)]


def _universal(lowering: Lowering, joint: Joint, q: tuple[Edge, ...], axis: Axis) -> _Displacement:
    second = unit_vector(lowering.vector(joint.axis2))
    return Vec3(lowering.g), [_rotation_about_any(axis.direction, q[0]), _rotation_about_any(second, q[1])]


def _planar(lowering: Lowering, joint: Joint, q: tuple[Edge, ...], axis: Axis) -> _Displacement:
    g = lowering.g
    return Vec3(g, q[0], q[1]), [rotation_about(Vec3.unit(g, 2), q[2], 2, False)]


def _general(lowering: Lowering, joint: Joint, q: tuple[Edge, ...], axis: Axis) -> _Displacement:
    return lowering.vector(joint.moving_position), _stated_rotations(lowering, joint)


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


def _stated_rotations(lowering: Lowering, joint: Joint) -> list[JointRotation]:
    """The rotations of the user's own R_PD(q)."""
    g, rotation = lowering.g, joint.moving_rotation
    if rotation.is_identity:
        return []
    values = [lowering.value(value) for value in rotation.values]
    if rotation.kind == "rpy":
        return [rotation_about(Vec3.unit(g, k), values[k], k, False) for k in (2, 1, 0) if values[k] != ZERO]
    if rotation.kind == "axis_angle" and all(map(g.is_constant, values[:3])):
        return [_rotation_about_any(unit_vector(Vec3(g, *values[:3])), values[3])]
    return [JointRotation(MatrixRotation(lowering.rotation(rotation)))]


def neutral_coordinates(joint: Joint, nq: int) -> tuple[float, ...]:
    """A configuration on the manifold: zeros, and quaternions of no rotation."""
    return (*(0.0,) * (nq - 1), 1.0) if joint.traits.quasi_velocities else (0.0,) * nq
