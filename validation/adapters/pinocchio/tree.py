"""Pinocchio: recursive algorithms on rigid trees (https://github.com/stack-of-tasks/pinocchio)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from ...contract.conventions import Chart
from ...contract.interface import States, Subject, Unsupported
from ...contract.quantities import TREE_QUANTITIES
from ...mechanics.assembly import FrameSite, Mass, Mover
from ...mechanics.geometry import Array, Placement
from ...mechanics.joint_kinds import PartKind
from ..reach import armature, bears_its_weight_alone, offered, unrepresented

NAME = "pinocchio"
VERSION: str = pin.__version__
# Kinds of simple joints that it has.
_JOINTS: frozenset[PartKind] = frozenset({"revolute", "prismatic", "screw", "ball", "free"})
_WORLD_AXES = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED


@dataclass(frozen=True)
class PinocchioEngine:
    """A `pinocchio.Model` behind the `Engine` protocol.

    Attributes:
        name: "pinocchio", or "pinocchio-urdf" for its own reading of a file.
        model: Pinocchio's model.
        chart: Map between its coordinates and ours.
        frames: Indices of the subject's frames in its model.
        capabilities: Quantities that it offers on this route.
    """

    name: str
    model: Any
    chart: Chart
    frames: tuple[int, ...] = ()
    capabilities: frozenset[str] = TREE_QUANTITIES
    version: str = VERSION

    def _each(self, states: States, result: Callable[[Any, Array, Array, Array, Array], Any]) -> Array:
        """One state at a time: results of `result(data, q, v, a, forces)`, stacked."""
        chart, data = self.chart, self.model.createData()
        q, v = chart.coordinates(states.q), chart.speeds(states.q, states.v)
        a, forces = chart.accelerations(states.q, states.v, states.a), chart.forces(states.q, states.applied)
        return np.array([np.array(result(data, *state)) for state in zip(q, v, a, forces, strict=True)])

    def _matrix(self, matrix: Any) -> Array:
        """A copy with nv columns: the binding turns a matrix of one column into a vector."""
        return np.array(matrix).reshape(-1, self.model.nv)

    def mass_matrix(self, states: States) -> Array:
        """Composite rigid bodies."""
        M = self._each(states, lambda data, q, v, a, f: self._matrix(pin.crba(self.model, data, q)))
        return self.chart.mass_matrix(states.q, M)

    def bias(self, states: States) -> Array:
        """`nonLinearEffects`; the charts of this engine do not turn, so nothing is added."""
        h = self._each(states, lambda data, q, v, a, f: pin.nonLinearEffects(self.model, data, q, v))
        return self.chart.our_forces(states.q, h)

    def kinetic_energy(self, states: States) -> Array:
        """Kinetic energy, from body velocities (N,) [J]."""
        return self._each(states, lambda data, q, v, a, f: pin.computeKineticEnergy(self.model, data, q, v))

    def potential_energy(self, states: States) -> Array:
        """Gravitational potential energy (N,) [J]."""
        return self._each(states, lambda data, q, v, a, f: pin.computePotentialEnergy(self.model, data, q))

    def inverse_dynamics(self, states: States) -> Array:
        """Newton-Euler."""
        forces = self._each(states, lambda data, q, v, a, f: pin.rnea(self.model, data, q, v, a))
        return self.chart.our_forces(states.q, forces) - states.passive

    def joint_wrenches(self, states: States) -> Array:
        """`data.f` after Newton-Euler; of a joint that is a series of simple ones, that of the last."""
        movers = [slot.mover for slot in self.chart.slots]
        last = [i for i, mover in enumerate(movers[1:], start=1) if not mover.continues] + [len(movers)]

        def result(data: Any, q: Array, v: Array, a: Array, f: Array) -> Any:
            pin.rnea(self.model, data, q, v, a)
            return [data.f[i].vector for i in last]

        return self._each(states, result)

    def forward_dynamics(self, states: States) -> Array:
        """Articulated bodies: no mass matrix is formed, so this is a second algorithm, not a second solve."""
        a = self._each(states, lambda data, q, v, a, f: pin.aba(self.model, data, q, v, f))
        return self.chart.our_accelerations(states.q, states.v, a)

    def frame_pose(self, states: States) -> Array:
        """Poses of the frames, from forward kinematics: p_WF and the rows of R_WF (N, F, 12)."""

        def result(data: Any, q: Array, v: Array, a: Array, f: Array) -> Any:
            pin.framesForwardKinematics(self.model, data, q)
            poses = [data.oMf[frame] for frame in self.frames]
            return [np.append(pose.translation, pose.rotation) for pose in poses]

        return self._each(states, result)

    def frame_velocity(self, states: States) -> Array:
        """Velocities of the frames, from forward kinematics, (linear; angular) in world axes (N, F, 6)."""

        def result(data: Any, q: Array, v: Array, a: Array, f: Array) -> Any:
            pin.forwardKinematics(self.model, data, q, v)
            return [pin.getFrameVelocity(self.model, data, frame, _WORLD_AXES).vector for frame in self.frames]

        return self._each(states, result)

    def frame_acceleration(self, states: States) -> Array:
        """The classical acceleration: the spatial one lacks w x v."""

        def result(data: Any, q: Array, v: Array, a: Array, f: Array) -> Any:
            pin.forwardKinematics(self.model, data, q, v, a)
            get = pin.getFrameClassicalAcceleration
            return [get(self.model, data, frame, _WORLD_AXES).vector for frame in self.frames]

        return self._each(states, result)

    def frame_jacobian(self, states: States) -> Array:
        """Jacobians of the frames, from joint Jacobians, (linear; angular) in world axes (N, F, 6, nv)."""

        def result(data: Any, q: Array, v: Array, a: Array, f: Array) -> Any:
            pin.computeJointJacobians(self.model, data, q)
            pin.updateFramePlacements(self.model, data)
            get = pin.getFrameJacobian
            return [self._matrix(get(self.model, data, frame, _WORLD_AXES)) for frame in self.frames]

        return self.chart.jacobian(states.q, self._each(states, result))

    def frame_jacobian_rate(self, states: States) -> Array:
        """Time derivatives of the frame Jacobians, from joint Jacobians and their rates (N, F, 6, nv)."""

        def result(data: Any, q: Array, v: Array, a: Array, f: Array) -> Any:
            pin.computeJointJacobiansTimeVariation(self.model, data, q, v)
            pin.updateFramePlacements(self.model, data)
            get = pin.getFrameJacobianTimeVariation
            return [self._matrix(get(self.model, data, frame, _WORLD_AXES)) for frame in self.frames]

        return self.chart.jacobian(states.q, self._each(states, result))


def build(subject: Subject) -> PinocchioEngine | Unsupported:
    """Pinocchio's model of a description; it merges what is fixed to a joint's body by itself."""
    assembly = subject.assembly
    obstacle = unrepresented(subject.system, assembly, _JOINTS)
    if obstacle is not None:
        return obstacle
    model = pin.Model()
    model.gravity.linear = assembly.gravity
    ids = [0]
    for mover in assembly.movers:
        ids.append(model.addJoint(ids[mover.parent + 1], _joint_model(mover), _se3(mover.X_AP), mover.name))
        for part in mover.masses:
            model.appendBodyToJoint(ids[-1], _inertia(part), pin.SE3.Identity())
    frames = tuple(_add_frame(model, ids, assembly.frames[name], name) for name in subject.frames)
    chart = Chart.in_series(assembly)
    for slot in chart.slots:
        model.armature[slot.v : slot.v + slot.mover.part.speeds] = armature(subject.system, slot.mover)
    # Pinocchio 4.1 counts an armature in the energy of some joints (prismatic, free) and not of others (revolute about
    # a general axis), while its M counts all: with armatures, its kinetic energy is not one to compare with.
    silent = {"kinetic_energy"} if np.any(model.armature) else set()
    if not bears_its_weight_alone(subject.system):
        silent.add("joint_wrenches")
    return PinocchioEngine(NAME, model, chart, frames, offered(PinocchioEngine, subject.system) - silent)


def _se3(X: Placement) -> Any:
    return pin.SE3(X.R, X.p)


def _inertia(part: Mass) -> Any:
    # The constructor refuses an inertia that no body can have; files state such, and the setters take them.
    inertia = pin.Inertia.Zero()
    inertia.mass, inertia.lever, inertia.inertia = part.mass, part.p_BC, part.J_BC
    return inertia


def _joint_model(mover: Mover) -> Any:
    if mover.kind == "free":
        return pin.JointModelFreeFlyer()
    if mover.kind == "ball":
        return pin.JointModelSpherical()
    if mover.kind == "screw":
        return pin.JointModelHelicalUnaligned(mover.axis, mover.pitch)
    unaligned = pin.JointModelPrismaticUnaligned if mover.kind == "prismatic" else pin.JointModelRevoluteUnaligned
    return unaligned(mover.axis)


def _add_frame(model: Any, ids: list[int], frame: FrameSite, name: str) -> int:
    placed = pin.Frame(name, ids[frame.mover + 1], 0, _se3(frame.X_BF), pin.FrameType.OP_FRAME)
    return int(model.addFrame(placed))
