"""Exudyn's joints: every body in coordinates of its own, every joint and closure a connector of Exudyn's.

Bodies have Euler parameters, joints are `ObjectJointGeneric`, rods `ObjectConnectorDistance`. Exudyn gives the mass
matrix, the forces, the conditions and their Jacobian; the equations of index 1

    M x'' - C^T mu = f,     C x'' = -C' x'                                                               (1)

are solved here, by least squares, because planar loops repeat conditions across their plane. C' x' is the derivative
of C x' along the motion, by a difference of sixth order: conditions are polynomials in the coordinates but for rods.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import exudyn
import numpy as np
from exudyn import itemInterface as items

import symofros as sf

from ...contract.conventions import xyzw_to_wxyz
from ...contract.interface import States, Subject, Unsupported
from ...mechanics.absolute import Moving, bodies, joint_accelerations, work_rows
from ...mechanics.assembly import BASE, Assembly, FrameSite, Mover, anchor_name
from ...mechanics.geometry import Array, Placement, along_z, matrix_quaternion
from ...mechanics.joint_kinds import PartKind
from ..closed import AXES
from ..reach import armature, unrepresented
from .system import VERSION, ExudynSystem, assembled

NAME = "exudyn-loops"
CAPABILITIES = frozenset({"forward_dynamics", "closure_gap", "frame_response"})
# Kinds of simple joints that it has.
_JOINTS: frozenset[PartKind] = frozenset({"revolute", "prismatic", "ball", "free"})
# Conditions smaller than this share of the largest repeat others.
_RANK = 1e-10
# Of the difference along the motion, as a change of the coordinates: its sixth power is what is left for rods.
_STEP = 4e-3


class _Solved(NamedTuple):
    """One state: the bodies, and the accelerations of their origins and their angular ones (bodies, 3)."""

    moving: list[Moving]
    a: Array
    alpha: Array


@dataclass(frozen=True)
class JointedEngine:
    """An Exudyn system with a node of Euler parameters for every moving body of a description.

    Attributes:
        system: Exudyn's.
        assembly: Assembly of the description.
        frames: The subject's.
    """

    system: ExudynSystem
    assembly: Assembly
    frames: tuple[FrameSite, ...]
    name: str = NAME
    version: str = VERSION
    capabilities: frozenset[str] = CAPABILITIES

    def forward_dynamics(self, states: States) -> Array:
        """Joint accelerations v' (N, nv), from the accelerations of the bodies that the joints connect."""
        return self._each(states, lambda at: joint_accelerations(self.assembly, at.moving, at.a, at.alpha))

    def frame_response(self, states: States) -> Array:
        """Accelerations of points of the bodies."""
        return self._each(states, lambda at: np.array([_carried(at, site) for site in self.frames]))

    def closure_gap(self, states: States) -> Array:
        """The largest of Exudyn's conditions, joints of the tree among them."""
        gaps = []
        for q, v in zip(states.q, states.v, strict=True):
            x, _ = _coordinates(bodies(self.assembly, q, v))
            gaps.append(np.abs(self.system.conditions(x)).max())
        return np.array(gaps)

    def _each(self, states: States, result: Callable[[_Solved], Array]) -> Array:
        rows = zip(states.q, states.v, states.applied, strict=True)
        return np.array([result(self._solved(*row)) for row in rows])

    def _solved(self, q: Array, v: Array, force: Array) -> _Solved:
        moving = bodies(self.assembly, q, v)
        x, rate = _coordinates(moving)
        M, f = self.system.at(x, rate)
        T = _twists(moving)
        f = f + T.T @ work_rows(self.assembly, moving).T @ force
        C = self.system.jacobian(x)
        h = _STEP / max(1.0, float(np.abs(rate).max()))
        weights = ((1, 3 / 4), (2, -3 / 20), (3, 1 / 60))
        drift = np.zeros(len(C))
        for k, weight in weights:
            drift += (
                weight / h * (self.system.jacobian(x + k * h * rate) - self.system.jacobian(x - k * h * rate)) @ rate
            )
        solution = _index_one(M, f, C, -drift)
        # R' = [w]x R, and the Euler parameters' own second rate |w|^2/4 turns nothing.
        acceleration = (T @ solution).reshape(-1, 6)
        return _Solved(moving, acceleration[:, :3], acceleration[:, 3:])


def _index_one(M: Array, f: Array, C: Array, c: Array) -> Array:
    """The x'' of (1); unique where M is positive along what the conditions allow."""
    # Motions that keep the conditions, and the least one that meets c.
    U, s, Vt = np.linalg.svd(C)
    rank = int(np.sum(s > _RANK * s[0]))
    least = Vt[:rank].T @ ((U[:, :rank].T @ c) / s[:rank])
    Z = Vt[rank:].T
    return np.asarray(least + Z @ np.linalg.solve(Z.T @ M @ Z, Z.T @ (f - M @ least)))


def _coordinates(moving: list[Moving]) -> tuple[Array, Array]:
    """Exudyn's coordinates (7 bodies): displacements from nodes at the origin, wxyz less that of no turn; and rates."""
    x, rate = [], []
    for body in moving:
        e = xyzw_to_wxyz(matrix_quaternion(body.X.R))
        x.append(np.concatenate([body.X.p, e - (1.0, 0.0, 0.0, 0.0)]))
        rate.append(np.concatenate([body.v, _turning(e).T @ body.w / 2]))
    return np.concatenate(x), np.concatenate(rate)


def _turning(e: Array) -> Array:
    """E (3, 4) with w = 2 E e', in world axes, of Euler parameters (w, x, y, z)."""
    s, x, y, z = e
    return np.array([[-x, s, -z, y], [-y, z, s, -x], [-z, -y, x, s]])


def _twists(moving: list[Moving]) -> Array:
    """The velocities (6 bodies) from the rates (7 bodies)."""
    T = np.zeros((6 * len(moving), 7 * len(moving)))
    for i, body in enumerate(moving):
        T[6 * i : 6 * i + 3, 7 * i : 7 * i + 3] = np.eye(3)
        e = xyzw_to_wxyz(matrix_quaternion(body.X.R))
        T[6 * i + 3 : 6 * i + 6, 7 * i + 3 : 7 * i + 7] = 2 * _turning(e)
    return T


def _carried(at: _Solved, site: FrameSite) -> Array:
    if site.mover == BASE:
        return np.zeros(6)
    body, a, alpha = at.moving[site.mover], at.a[site.mover], at.alpha[site.mover]
    r = body.X.R @ site.X_BF.p
    return np.concatenate([a + np.cross(alpha, r) + np.cross(body.w, np.cross(body.w, r)), alpha])


def build(subject: Subject) -> JointedEngine | Unsupported:
    """Exudyn's system of a description with closures and rods."""
    assembly = subject.assembly
    obstacle = unrepresented(subject.system, assembly, _JOINTS) or _obstacle(subject.system, assembly)
    if obstacle is not None:
        return obstacle
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    ground = system.AddObject(items.ObjectGround())
    made = [_body(system, mover, assembly.gravity) for mover in assembly.movers]

    def carrier(mover: int) -> Any:
        return ground if mover == BASE else made[mover]

    for body, mover in zip(made, assembly.movers, strict=True):
        _joint(system, mover, carrier(mover.parent), body)
    for item in subject.system.constraints:
        assert isinstance(item, sf.Closure | sf.Rod)
        ends = [_site(assembly, anchor) for anchor in (item.first, item.second)]
        markers = [_marker(system, carrier(site.mover), site.X_BF) for site in ends]
        if isinstance(item, sf.Rod):
            length = float(sf.evaluate(item.length, subject.system.parameter_values()))
            system.AddObject(items.ObjectConnectorDistance(markerNumbers=markers, distance=length))
            continue
        axes = [int(axis in item.translations) for axis in AXES] + [int(axis in item.rotations) for axis in AXES]
        _generic(system, markers, axes)
    frames = tuple(assembly.frames[name] for name in subject.frames)
    return JointedEngine(assembled(container, system), assembly, frames)


def _obstacle(system: sf.System, assembly: Assembly) -> Unsupported | None:
    for mover in assembly.movers:
        if armature(system, mover):
            return Unsupported(f"joint '{mover.joint.name}': an armature, which bodies by themselves do not feel")
    for item in system.constraints:
        if not isinstance(item, sf.Closure | sf.Rod):
            return Unsupported(f"'{item.name}': no {type(item).__name__} among the connectors used")
        if isinstance(item, sf.Closure) and len(item.rotations) == 1:
            return Unsupported(f"closure '{item.name}': one blocked rotation is an angle to Exudyn, not a right angle")
    return None


def _body(system: Any, mover: Mover, gravity: Array) -> Any:
    merged = mover.merged()
    p = merged.p_BC
    J = merged.J_BC + merged.mass * (p @ p * np.eye(3) - np.outer(p, p))
    node = system.AddNode(items.NodeRigidBodyEP(referenceCoordinates=[0, 0, 0, 1, 0, 0, 0]))
    inertia = [J[0, 0], J[1, 1], J[2, 2], J[1, 2], J[0, 2], J[0, 1]]
    body = system.AddObject(
        items.ObjectRigidBody(mass=merged.mass, inertia=inertia, centerOfMass=list(p), nodeNumber=node)
    )
    if merged.mass:
        marker = system.AddMarker(items.MarkerBodyMass(bodyNumber=body))
        system.AddLoad(items.LoadMassProportional(markerNumber=marker, loadVector=list(gravity)))
    return body


def _joint(system: Any, mover: Mover, parent: Any, body: Any) -> None:
    blocked = {"revolute": [1, 1, 1, 1, 1, 0], "prismatic": [1, 1, 0, 1, 1, 1], "ball": [1, 1, 1, 0, 0, 0]}
    if mover.kind == "free":
        return
    turned = Placement(along_z(mover.axis), np.zeros(3))
    markers = [_marker(system, parent, mover.X_AP @ turned), _marker(system, body, turned)]
    _generic(system, markers, blocked[mover.kind])


def _marker(system: Any, carrier: Any, X: Placement) -> Any:
    # Exudyn's own stub lacks the names of the arguments.
    transformation: Any = exudyn.HT
    place = transformation(rotation=X.R, translation=X.p)
    return system.AddMarker(items.MarkerBodyRigid(bodyNumber=carrier, localHT=place))


def _generic(system: Any, markers: list[Any], axes: list[int]) -> None:
    system.AddObject(items.ObjectJointGeneric(markerNumbers=markers, constrainedAxes=axes))


def _site(assembly: Assembly, anchor: tuple[str, str | None]) -> FrameSite:
    return assembly.frames[anchor_name(assembly, anchor) or "world"]
