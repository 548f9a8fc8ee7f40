"""Exudyn's own recursions for rigid trees: ObjectKinematicTree, in joint coordinates (github.com/jgerstm/EXUDYN).

Its joints turn about or slide along one axis of coordinates, so each link's frame is turned until its z axis is the
joint's; joints of several such coordinates are a series. Balls, free joints and screws are none of its kinds: those
trees are made of bodies with Euler parameters (`mapped`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import exudyn
import numpy as np
from exudyn import itemInterface as items

from ...contract.conventions import times
from ...contract.interface import Engine, States, Subject, Unsupported
from ...mechanics import carried
from ...mechanics.assembly import BASE, Assembly, FrameSite, Mover
from ...mechanics.geometry import Array, Placement, along_z
from ...mechanics.joint_kinds import PartKind
from ..reach import armature, unrepresented
from . import mapped
from .system import VERSION, ExudynSystem, assembled

NAME = "exudyn"
# States in one call: Jacobians are read column by column.
MOST_STATES = 300
_TYPES: dict[PartKind, Any] = {"revolute": exudyn.JointType.RevoluteZ, "prismatic": exudyn.JointType.PrismaticZ}
# Exudyn's own stub gives these no arguments.
_Matrices: Any = exudyn.Matrix3DList
_Vectors: Any = exudyn.Vector3DList
_KIND = exudyn.OutputVariableType
_CURRENT = exudyn.ConfigurationType.Current


class Sensors(NamedTuple):
    """Numbers of the sensors of one frame, and its rotation in the link's frame."""

    place: Any
    rotation: Any
    twist: tuple[Any, Any]
    twist_rate: tuple[Any, Any]
    R: Array


@dataclass(frozen=True)
class KinematicTreeEngine:
    """An ObjectKinematicTree behind the `Engine` protocol.

    Attributes:
        system: Exudyn's.
        assembly: Assembly of the description.
        centers: Sensors of the places of mass centres.
        frames: Sensors of the subject's frames; the placement of one on the base.
        capabilities: Quantities that it offers for this system.
        most_states: Largest number of states in one call.
    """

    system: ExudynSystem
    assembly: Assembly
    centers: tuple[Any, ...]
    frames: tuple[Sensors | Placement, ...]
    capabilities: frozenset[str]
    most_states: int = MOST_STATES
    name: str = NAME
    version: str = VERSION

    def mass_matrix(self, states: States) -> Array:
        """M."""
        return np.array([self.system.at(q, 0.0 * q)[0] for q in states.q])

    def bias(self, states: States) -> Array:
        """Minus the forces on Exudyn's right-hand side."""
        return np.array([-self.system.at(q, v)[1] for q, v in zip(states.q, states.v, strict=True)])

    def kinetic_energy(self, states: States) -> Array:
        """v^T M v / 2."""
        return np.asarray(np.einsum("ni,nij,nj->n", states.v, self.mass_matrix(states), states.v) / 2.0)

    def potential_energy(self, states: States) -> Array:
        """Gravitational potential energy (N,) [J], from the places of mass centres."""
        masses = np.array([mover.merged().mass for mover in self.assembly.movers])

        def weight() -> Array:
            places = np.array([self._value(sensor) for sensor in self.centers])
            return np.asarray(-masses @ places @ self.assembly.gravity)

        return self._each(states, weight)

    def inverse_dynamics(self, states: States) -> Array:
        """M a + h - passive."""
        return times(self.mass_matrix(states), states.a) + self.bias(states) - states.passive

    def forward_dynamics(self, states: States) -> Array:
        """M^-1 (applied - h)."""
        net = states.applied - self.bias(states)
        return np.asarray(np.linalg.solve(self.mass_matrix(states), net[:, :, None])[:, :, 0])

    def frame_pose(self, states: States) -> Array:
        """Position, then rotation row by row."""

        def one(frame: Sensors | Placement) -> Array:
            if isinstance(frame, Placement):
                return np.concatenate([frame.p, frame.R.ravel()])
            R = self._value(frame.rotation).reshape(3, 3) @ frame.R
            return np.concatenate([self._value(frame.place), R.ravel()])

        return self._each(states, lambda: np.array([one(frame) for frame in self.frames]))

    def frame_velocity(self, states: States) -> Array:
        """Linear, angular."""
        return self._each(states, lambda: self._pairs("twist"))

    def frame_acceleration(self, states: States) -> Array:
        """Linear, angular."""
        return self._each(states, lambda: self._pairs("twist_rate"))

    def frame_jacobian(self, states: States) -> Array:
        """Velocities of unit speeds."""
        units = np.eye(self.assembly.nv)

        def columns() -> Array:
            data = self.system.system.systemData
            result = []
            for unit in units:
                data.SetODE2Coordinates_t(unit, configuration=_CURRENT)
                result.append(self._pairs("twist"))
            return np.stack(result, axis=-1)

        return self._each(states, columns)

    def _pairs(self, which: str) -> Array:
        none = np.zeros(6)
        return np.array(
            [
                none
                if isinstance(frame, Placement)
                else np.concatenate([self._value(sensor) for sensor in getattr(frame, which)])
                for frame in self.frames
            ]
        )

    def _value(self, sensor: Any) -> Array:
        return np.array(self.system.system.GetSensorValues(sensor, configuration=_CURRENT))

    def _each(self, states: States, result: Callable[[], Array]) -> Array:
        """What is read at each state."""
        data, values = self.system.system.systemData, []
        for q, v, a in zip(states.q, states.v, states.a, strict=True):
            data.SetODE2Coordinates(q, configuration=_CURRENT)
            data.SetODE2Coordinates_t(v, configuration=_CURRENT)
            data.SetODE2Coordinates_tt(a, configuration=_CURRENT)
            values.append(result())
        return np.array(values)


def build(subject: Subject) -> Engine | Unsupported:
    """Exudyn's tree of a rigid description; one of bodies, where a joint is not of its kinds."""
    system = subject.system
    beam = next((body for body in system.beams), None)
    if beam is not None:
        return Unsupported(f"beam '{beam.name}': left to finite elements, exudyn-beams")
    assembly = subject.assembly
    if assembly.moves_no_mass:
        return Unsupported("a joint that moves no mass: its systems are solved, which gives NaN")
    obstacle = unrepresented(system, assembly, carried.KINDS)
    if obstacle is not None:
        return obstacle
    if any(mover.kind not in _TYPES for mover in assembly.movers):
        return mapped.engine(subject, NAME)
    container = exudyn.SystemContainer()
    mbs: Any = container.AddSystem()
    # A part of a general joint may come before another one whose coordinate is the first.
    order = [mover.q.start for mover in assembly.movers]
    if order != sorted(order):
        return mapped.engine(subject, NAME)
    turns = [along_z(mover.axis) for mover in assembly.movers]
    tree = _tree(mbs, assembly, turns, [armature(system, mover) for mover in assembly.movers])
    centers = tuple(
        _sensor(mbs, tree, i, turn.T @ mover.merged().p_BC, _KIND.Position)
        for i, (mover, turn) in enumerate(zip(assembly.movers, turns, strict=True))
    )
    frames = tuple(_sensors(mbs, tree, assembly.frames[name], turns) for name in subject.frames)
    return KinematicTreeEngine(assembled(container, mbs), assembly, centers, frames, mapped.offered(system))


def _tree(mbs: Any, assembly: Assembly, turns: Sequence[Array], armatures: Sequence[float]) -> Any:
    """The object; links' frames are our bodies' turned."""
    movers, nv = assembly.movers, assembly.nv
    still = [0.0] * nv
    node = mbs.AddNode(
        items.NodeGenericODE2(
            referenceCoordinates=still,
            initialCoordinates=still,
            initialCoordinates_t=still,
            numberOfODE2Coordinates=nv,
        )
    )
    masses = [mover.merged() for mover in movers]

    def parent(mover: Mover) -> Array:
        return np.eye(3) if mover.parent == BASE else turns[mover.parent]

    pairs = list(zip(movers, turns, strict=True))
    tree = items.ObjectKinematicTree(
        nodeNumber=node,
        gravity=list(assembly.gravity),
        jointTypes=[_TYPES[mover.kind] for mover in movers],
        linkParents=[mover.parent for mover in movers],
        jointTransformations=_Matrices([parent(mover).T @ mover.X_AP.R @ turn for mover, turn in pairs]),
        jointOffsets=_Vectors([parent(mover).T @ mover.X_AP.p for mover in movers]),
        linkInertiasCOM=_Matrices([turn.T @ mass.J_BC @ turn for mass, turn in zip(masses, turns, strict=True)]),
        linkCOMs=_Vectors([turn.T @ mass.p_BC for mass, turn in zip(masses, turns, strict=True)]),
        linkMasses=[mass.mass for mass in masses],
    )
    number = mbs.AddObject(tree)
    if any(armatures):
        # What has inertia in joint space alone is an object on the same coordinates.
        mbs.AddObject(items.ObjectGenericODE2(nodeNumbers=[node], massMatrix=np.diag(armatures)))
    return number


def _sensors(mbs: Any, tree: Any, site: FrameSite, turns: Sequence[Array]) -> Sensors | Placement:
    if site.mover == BASE:
        return site.X_BF
    turn = turns[site.mover]
    kinds = (
        _KIND.Position,
        _KIND.RotationMatrix,
        _KIND.Velocity,
        _KIND.AngularVelocity,
        _KIND.Acceleration,
        _KIND.AngularAcceleration,
    )
    place, rotation, v, w, a, alpha = (_sensor(mbs, tree, site.mover, turn.T @ site.X_BF.p, kind) for kind in kinds)
    return Sensors(place, rotation, (v, w), (a, alpha), turn.T @ site.X_BF.R)


def _sensor(mbs: Any, tree: Any, link: int, local: Array, kind: Any) -> Any:
    return mbs.AddSensor(
        items.SensorKinematicTree(
            objectNumber=tree, linkNumber=link, localPosition=list(local), outputVariableType=kind, writeToFile=False
        )
    )
