"""Rigid bodies of Exudyn's, one for every moving body of a description, moved by our speeds (see `mapped`)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import exudyn
import numpy as np
from exudyn import itemInterface as items

from ...contract.conventions import times, xyzw_to_wxyz
from ...mechanics.assembly import BASE, Assembly, FrameSite
from ...mechanics.carried import Carried
from ...mechanics.geometry import Array, matrix_quaternion
from .system import ExudynSystem, assembled, new_system, weigh

NO_TURN = (1.0, 0.0, 0.0, 0.0)
# Coordinates of a node: a place and Euler parameters.
COORDINATES = 7


@dataclass(frozen=True)
class Nodal:
    """Coordinates of K nodes of places and Euler parameters for N states: 7 a node, counted from no displacement.

    Attributes:
        x: Coordinates (N, 7 K).
        J: Rates of unit speeds (N, 7 K, n).
        bend: Second rates at the given rates of the speeds (N, 7 K).
    """

    x: Array
    J: Array
    bend: Array

    @staticmethod
    def of(triads: Carried, v: Array, places: bool = True) -> Nodal:
        """Coordinates of nodes at triads.

        Args:
            triads: Places and rotations for N states.
            v: Speeds (N, n).
            places: Whether nodes move with their triads, rather than turn only.
        """
        e = xyzw_to_wxyz(matrix_quaternion(triads.R))
        E = 0.5 * euler_parameter_rates(e)
        w = np.einsum("nkai,ni->nka", triads.J_w, v)
        e_bend = np.einsum("nkea,nka->nke", E, triads.alpha) - 0.25 * np.sum(w * w, axis=-1, keepdims=True) * e
        moved = 1.0 if places else 0.0
        count, n = v.shape
        return Nodal(
            np.concatenate([moved * triads.p, e - NO_TURN], axis=2).reshape(count, -1),
            np.concatenate([moved * triads.J, E @ triads.J_w], axis=2).reshape(count, -1, n),
            np.concatenate([moved * triads.a, e_bend], axis=2).reshape(count, -1),
        )


def euler_parameter_rates(e: Array) -> Array:
    """E (..., 4, 3) of docs/theory/elements.md, (3), of Euler parameters (w, x, y, z) (..., 4), w along world axes."""
    s, x, y, z = (e[..., k] for k in range(4))
    rows = [-x, -y, -z, s, z, -y, -z, s, x, y, -x, s]
    return np.stack(rows, axis=-1).reshape(*e.shape[:-1], 4, 3)


def inertial(system: ExudynSystem, nodal: Nodal, v: Array) -> tuple[Array, Array]:
    """J^T M J (N, n, n) and J^T (M x'' - f) (N, n) of a system of Exudyn's.

    Args:
        system: The system.
        nodal: Coordinates of its nodes.
        v: Speeds (N, n).
    """
    M, h = [], []
    rates = times(nodal.J, v)
    for x, rate, J, bend in zip(nodal.x, rates, nodal.J, nodal.bend, strict=True):
        M_x, force = system.at(x, rate)
        M.append(J.T @ M_x @ J)
        h.append(J.T @ (M_x @ bend - force))
    return np.array(M), np.array(h)


@dataclass(frozen=True)
class Solids:
    """The rigid bodies.

    Attributes:
        system: Exudyn's.
        numbers: Numbers of its bodies, one for each mover.
        assembly: Assembly of the description.
    """

    system: ExudynSystem
    numbers: tuple[Any, ...]
    assembly: Assembly

    def potential_energy(self, nodal: Nodal) -> Array:
        """Gravitational potential energy (N,) [J], from the places of Exudyn's mass centres."""
        masses = [mover.merged() for mover in self.assembly.movers]
        gravity = self.assembly.gravity
        place = exudyn.OutputVariableType.Position

        def weight() -> float:
            return -sum(mass.mass * float(gravity @ self._output(i, place, mass.p_BC)) for i, mass in enumerate(masses))

        return np.array([weight() for _ in self._at(nodal, 0.0 * nodal.x)])

    def pose(self, nodal: Nodal, sites: Sequence[FrameSite]) -> Array:
        """Positions, then rows of the rotations (N, F, 12)."""
        kind = exudyn.OutputVariableType

        def one(site: FrameSite) -> Array:
            if site.mover == BASE:
                return np.concatenate([site.X_BF.p, site.X_BF.R.ravel()])
            p = self._output(site.mover, kind.Position, site.X_BF.p)
            R = self._output(site.mover, kind.RotationMatrix, site.X_BF.p).reshape(3, 3) @ site.X_BF.R
            return np.concatenate([p, R.ravel()])

        return np.array([[one(site) for site in sites] for _ in self._at(nodal, 0.0 * nodal.x)])

    def twist(self, nodal: Nodal, rates: Array, sites: Sequence[FrameSite]) -> Array:
        """Velocities (linear; angular) (N, F, 6), for rates of the coordinates (N, 7 K)."""
        kind = exudyn.OutputVariableType
        return self._outputs(nodal, rates, sites, kind.Velocity, kind.AngularVelocity)

    def twist_rate(self, nodal: Nodal, rates: Array, sites: Sequence[FrameSite]) -> Array:
        """Accelerations (linear; angular) (N, F, 6)."""
        kind = exudyn.OutputVariableType
        return self._outputs(nodal, rates, sites, kind.Acceleration, kind.AngularAcceleration)

    def jacobian(self, nodal: Nodal, sites: Sequence[FrameSite]) -> Array:
        """Velocities of unit speeds (N, F, 6, n): those of unit rates of a body's 7 coordinates, times J."""
        J = np.zeros((len(nodal.x), len(sites), 6, nodal.J.shape[2]))
        for k in range(COORDINATES):
            rates = np.zeros_like(nodal.x)
            rates[:, k::COORDINATES] = 1.0  # Of all bodies at once: each moves by its own.
            unit = self.twist(nodal, rates, sites)
            for i, site in enumerate(sites):
                if site.mover != BASE:
                    J[:, i] += unit[:, i, :, None] * nodal.J[:, None, COORDINATES * site.mover + k]
        return J

    def _outputs(self, nodal: Nodal, rates: Array, sites: Sequence[FrameSite], linear: Any, angular: Any) -> Array:
        read, current = self.system.system.GetObjectOutputBody, exudyn.ConfigurationType.Current
        places = [(i, self.numbers[one.mover], one.X_BF.p) for i, one in enumerate(sites) if one.mover != BASE]
        outputs = np.zeros((len(nodal.x), len(sites), 6))
        for output, _ in zip(outputs, self._at(nodal, rates), strict=True):
            for i, number, local in places:
                output[i, :3] = read(number, linear, local, current)
                output[i, 3:] = read(number, angular, local, current)
        return outputs

    def _output(self, mover: int, kind: Any, local: Array) -> Array:
        system = self.system.system
        return np.array(system.GetObjectOutputBody(self.numbers[mover], kind, local, exudyn.ConfigurationType.Current))

    def _at(self, nodal: Nodal, rates: Array) -> Iterator[None]:
        """Set one state after the other."""
        data, current = self.system.system.systemData, exudyn.ConfigurationType.Current
        for x, rate, bend in zip(nodal.x, rates, nodal.bend, strict=True):
            data.SetODE2Coordinates(x, configuration=current)
            data.SetODE2Coordinates_t(rate, configuration=current)
            data.SetODE2Coordinates_tt(bend, configuration=current)
            yield


def solids(assembly: Assembly) -> Solids:
    """Exudyn's rigid bodies of a description."""
    container, system = new_system()
    numbers = []
    for mover in assembly.movers:
        merged = mover.merged()
        p = merged.p_BC
        J = merged.J_BC + merged.mass * (p @ p * np.eye(3) - np.outer(p, p))
        node = system.AddNode(items.NodeRigidBodyEP(referenceCoordinates=[0, 0, 0, *NO_TURN]))
        moments = [J[0, 0], J[1, 1], J[2, 2], J[1, 2], J[0, 2], J[0, 1]]
        body = items.ObjectRigidBody(mass=merged.mass, inertia=moments, centerOfMass=list(p), nodeNumber=node)
        numbers.append(system.AddObject(body))
        if merged.mass:
            weigh(system, numbers[-1], assembly.gravity)
    return Solids(assembled(container, system), tuple(numbers), assembly)
