"""Joints of a compiled MJCF model.

A MuJoCo body has any number of joints, each with an anchor and an axis that are stated in the body's frame B as it is
in the reference configuration; there, the coordinate of a hinge or slide is `ref`, not zero. In the order of the
joints, with J(q) the motion of one (R_PD or p_PD) and T(a) a shift by its anchor a, the body is at

    X_AB(q) = X_AB(ref) * product over joints of T(a) J(q - ref) T(-a).

As J(q - ref) = J(-ref) J(q), the constant parts go into the placements of our joints, whose coordinates then equal
MuJoCo's: T(a) J(-ref) before a joint and T(-a) behind it. Each joint but the last has a massless body of its own.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from symofros.base.arrays import Array
from symofros.base.rotations import matrix_product
from symofros.description.forces import Spring
from symofros.description.imported.geometry import Exact, about
from symofros.description.imported.tree import ImportedJoint, Resistance
from symofros.description.joints.joint import WORLD, Joint, Limits
from symofros.description.joints.joint_kinds import JointKindName
from symofros.description.mjcf.names import Names
from symofros.description.remarks import Remarks
from symofros.description.values import Value

# mjtJoint and mjtDisableBit of mujoco/mjmodel.h, which never change: compiled models are stored by them.
FREE, BALL, SLIDE, HINGE = range(4)
_NO_SPRINGS, _NO_DAMPERS = 1 << 5, 1 << 6
_NO_FRICTION, _NO_LIMITS = 1 << 0 | 1 << 2, 1 << 0 | 1 << 3  # The first bit switches all constraints off.
_SPEEDS = {FREE: 6, BALL: 3, SLIDE: 1, HINGE: 1}


@dataclass
class Chain:
    """Where a body is, at the references of its joints, as seen from what carries it; it is moved on joint by joint.

    Attributes:
        p: Position of Bo in the carrying body's frame (3,) [m].
        R: Rotation from that frame to B (3, 3).
    """

    p: Array
    R: Array

    @property
    def is_offset(self) -> bool:
        """Whether B is not the frame that the last joint moves."""
        return bool(np.any(self.p))


@dataclass(frozen=True)
class JointEfforts:
    """Efforts of actuators on a joint.

    Attributes:
        formulas: Efforts, one a speed; none where no actuator is a formula.
        actuated: Whether an effort on each speed is an input as well.
    """

    formulas: tuple[Value, ...] = ()
    actuated: bool = False


class JointReader:
    """Reads the joints of a model.

    Args:
        model: An MjModel.
        names: Names of the joints.
        efforts: Efforts of actuators, by the index of their joint.
        remarks: Remarks on what is ignored.
        exact: Makes numbers exact.
    """

    def __init__(
        self, model: Any, names: Names, efforts: Mapping[int, JointEfforts], remarks: Remarks, exact: Exact
    ) -> None:
        self.model = model
        self.names = names
        self.efforts = efforts
        self.remarks = remarks
        self.exact = exact

    def free(self, j: int, chain: Chain) -> ImportedJoint:
        """A free joint: its coordinates say where the body is in the world, wherever the model puts it first."""
        chain.p, chain.R = np.zeros(3), np.eye(3)
        armature = self._armature(j)
        if armature:
            self.remarks.add(
                "armature of free joints acts along body axes, without MuJoCo's gyroscopic part", "joint", self.names[j]
            )
        self._remark(j)
        return ImportedJoint(Joint(self.names[j], "free", armature=armature), self._resistances(j))

    def joint(self, j: int, chain: Chain) -> ImportedJoint:
        """A hinge, slide or ball, placed on the chain's parent; the chain is left at what the joint moves."""
        m, kind = self.model, int(self.model.jnt_type[j])
        axis = np.array(m.jnt_axis[j])
        # A shift is the same wherever it is anchored.
        anchor = np.zeros(3) if kind == SLIDE else np.array(m.jnt_pos[j])
        ref = 0.0 if kind == BALL else float(m.qpos0[m.jnt_qposadr[j]])
        p, R = chain.p + matrix_product(chain.R, anchor), chain.R
        if kind == SLIDE:
            p = p - ref * matrix_product(R, axis)
        elif ref:
            R = matrix_product(R, about(axis, -ref))
        position, rotation = self.exact.placement(p, R)
        efforts = self.efforts.get(j, JointEfforts())
        limits = self._limits(j)
        hinge: JointKindName = "revolute" if limits else "continuous"
        kinds: dict[int, JointKindName] = {BALL: "ball", SLIDE: "prismatic", HINGE: hinge}
        self._remark(j)
        chain.p, chain.R = -anchor, np.eye(3)
        made = Joint(
            self.names[j],
            kinds[kind],
            WORLD,
            None,
            position,
            rotation,
            (0.0, 0.0, 1.0) if kind == BALL else self.exact.direction(axis),
            actuated=efforts.actuated,
            effort=efforts.formulas,
            limits=limits,
            armature=self._armature(j),
        )
        return ImportedJoint(made, self._resistances(j))

    def _armature(self, j: int) -> float:
        # One number for all speeds of a joint, like its damping.
        return float(self.model.dof_armature[self.model.jnt_dofadr[j]])

    def _limits(self, j: int) -> Limits | None:
        off = self.model.opt.disableflags & _NO_LIMITS
        if off or not self.model.jnt_limited[j] or self.model.jnt_type[j] == BALL:
            return None
        lower, upper = (float(bound) if np.isfinite(bound) else None for bound in self.model.jnt_range[j])
        return Limits(lower, upper)

    def _resistances(self, j: int) -> tuple[Resistance, ...]:
        """Spring, damping and friction of each speed of a joint; MuJoCo's higher orders where a Resistance has them.

        MuJoCo: F = -(k x + k2 x^2 + k3 x^3) with x = q - springref, and F = -(d v + d2 v |v| + d3 v^3).
        """
        m, dof, name = self.model, int(self.model.jnt_dofadr[j]), self.names[j]
        simple = bool(m.jnt_type[j] in (SLIDE, HINGE))
        d, (d2, d3) = float(m.dof_damping[dof]), map(float, m.dof_dampingpoly[dof])
        if m.opt.disableflags & _NO_DAMPERS:
            d = d2 = d3 = 0.0
        if d3 or (d2 and not simple):
            self.remarks.add("damping of higher order ignored", "joint", name)
        friction = 0.0 if m.opt.disableflags & _NO_FRICTION else float(m.dof_frictionloss[dof])
        one = Resistance(self._spring(j, simple), d, d2 if simple else 0.0, friction)
        return (one,) * _SPEEDS[int(m.jnt_type[j])]

    def _spring(self, j: int, simple: bool) -> Spring | None:
        m, name = self.model, self.names[j]
        k, (k2, k3) = float(m.jnt_stiffness[j]), map(float, m.jnt_stiffnesspoly[j])
        if not (k or k2 or k3) or m.opt.disableflags & _NO_SPRINGS:
            return None
        if not simple:
            self.remarks.add("stiffness of ball and free joints ignored", "joint", name)
            return None
        if k2:
            self.remarks.add("quadratic stiffness ignored", "joint", name)
        return Spring(k, float(m.qpos_spring[m.jnt_qposadr[j]]), k3) if k or k3 else None

    def _remark(self, j: int) -> None:
        m, name = self.model, self.names[j]
        if m.jnt_limited[j] and m.jnt_type[j] == BALL:
            self.remarks.add("limits of ball joints ignored", "joint", name)
        if m.jnt_springyield[j] and (m.jnt_stiffness[j] or np.any(m.jnt_stiffnesspoly[j])):
            self.remarks.add("yield of springs ignored", "joint", name)
