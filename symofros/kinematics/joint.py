"""Across one joint: the motion of its distal frame D in its proximal frame P (docs/theory/rigid.md, section 2)."""

from __future__ import annotations

from dataclasses import dataclass

from symofros.description.system import Joint
from symofros.expr.graph import Edge, Graph
from symofros.expr.vector import Vec3
from symofros.kinematics.rotations import AxisTurn, MatrixTurn, Turn, axis_angle_matrix, quaternion_matrix


@dataclass(frozen=True)
class Column:
    """The partial velocity of one speed: w_PD_D and v_PDo_D per unit speed, both in D."""

    w: Vec3
    v: Vec3


@dataclass(frozen=True)
class AcrossJoint:
    """How D moves in P.

    Attributes:
        R_PD: Rotation.
        p_PD: From Po to Do, in P.
        columns: Partial velocities, constant in D for the joints of this library.
    """

    R_PD: Turn
    p_PD: Vec3
    columns: tuple[Column, ...]


def across_joint(g: Graph, joint: Joint, q: tuple[Edge, ...], axis: Vec3, k: int | None, negative: bool) -> AcrossJoint:
    """The motion of D in P.

    Args:
        g: The graph.
        joint: For its kind.
        q: Coordinates of the joint (nq_j).
        axis: Unit axis in P, which is also its direction in D.
        k: The coordinate axis that `axis` lies along; None if along none.
        negative: Whether it points against that coordinate axis.

    Raises:
        ValueError: The joint is fixed, and so does not move.
    """
    zero = Vec3(g)
    if joint.kind in ("revolute", "continuous"):
        c, s = g.call("cos", q[0]), g.call("sin", q[0])
        if k is None:
            turn = Turn(g, (MatrixTurn(axis_angle_matrix(axis, c, s)),))
        else:
            turn = Turn(g, (AxisTurn(k, c, -s if negative else s),))
        return AcrossJoint(turn, zero, (Column(axis, zero),))
    if joint.kind == "prismatic":
        return AcrossJoint(Turn(g, ()), axis.scaled(q[0]), (Column(zero, axis),))
    units = [Vec3.unit(g, i) for i in range(3)]
    if joint.kind == "ball":
        turn = Turn(g, (MatrixTurn(quaternion_matrix(g, *q)),))
        return AcrossJoint(turn, zero, tuple(Column(unit, zero) for unit in units))
    if joint.kind == "free":
        turn = Turn(g, (MatrixTurn(quaternion_matrix(g, *q[3:])),))
        columns = [Column(zero, unit) for unit in units] + [Column(unit, zero) for unit in units]
        return AcrossJoint(turn, Vec3(g, *q[:3]), tuple(columns))
    raise ValueError(f"joint '{joint.name}' is {joint.kind}")


def neutral_coordinates(joint: Joint) -> tuple[float, ...]:
    """The coordinates at which D coincides with P."""
    if joint.kind == "ball":
        return (0.0, 0.0, 0.0, 1.0)
    if joint.kind == "free":
        return (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)
    return (0.0,)
