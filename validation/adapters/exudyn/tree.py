"""Exudyn's own recursions for rigid trees, ObjectKinematicTree, by the engine matrix's plug-in.

Its joints turn about or slide along one axis. Balls, free joints and screws are none of its kinds: those trees are made
of bodies with Euler parameters (`mapped`).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ...contract.conventions import times
from ...contract.interface import Engine, States, Subject, Unsupported
from ...mechanics import carried
from ...mechanics.geometry import Array
from ...mechanics.joint_kinds import PartKind
from ..charted import ChartedEngine
from ..charted import build as build_charted
from ..reach import unrepresented
from . import mapped

NAME = "exudyn"
# States in one call: Jacobians are read column by column.
MOST_STATES = 300
_JOINTS: frozenset[PartKind] = frozenset({"revolute", "prismatic"})


@dataclass(frozen=True)
class KinematicTreeEngine(ChartedEngine):
    """Exudyn's ObjectKinematicTree: M, h and link poses are its own; energies and dynamics follow from them.

    Attributes:
        masses: Masses of its links, and times their mass centres (links, 4).
        gravity: Acceleration of gravity (3).
    """

    masses: Array = field(default_factory=lambda: np.zeros((0, 4)))
    gravity: Array = field(default_factory=lambda: np.zeros(3))

    def kinetic_energy(self, states: States) -> Array:
        """v^T M v / 2."""
        return np.asarray(np.einsum("ni,nij,nj->n", states.v, self.mass_matrix(states), states.v) / 2.0)

    def potential_energy(self, states: States) -> Array:
        """Gravitational potential energy (N,) [J], from the places of mass centres."""
        poses = self.asked("link_poses", states)[:, : len(self.masses)]
        R = poses[..., 3:].reshape(*poses.shape[:2], 3, 3)
        moments = self.masses[:, :1] * poses[..., :3] + (R @ self.masses[:, 1:, None])[..., 0]
        return np.asarray(-moments.sum(axis=1) @ self.gravity)

    def inverse_dynamics(self, states: States) -> Array:
        """M a + h - passive."""
        return times(self.mass_matrix(states), states.a) + self.bias(states) - states.passive

    def forward_dynamics(self, states: States) -> Array:
        """M^-1 (applied - h)."""
        net = states.applied - self.bias(states)
        return np.asarray(np.linalg.solve(self.mass_matrix(states), net[:, :, None])[:, :, 0])


def build(subject: Subject) -> Engine | Unsupported:
    """Exudyn's tree of a rigid description; one of bodies, where a joint is not of its kinds."""
    system, assembly = subject.system, subject.assembly
    beam = next((body for body in system.beams), None)
    if beam is not None:
        return Unsupported(f"beam '{beam.name}': left to finite elements, exudyn-beams")
    if assembly.moves_no_mass:
        return Unsupported("a joint that moves no mass: its systems are solved, which gives NaN")
    obstacle = unrepresented(system, assembly, carried.KINDS)
    if obstacle is not None:
        return obstacle
    if any(mover.kind not in _JOINTS for mover in assembly.movers):
        return mapped.engine(subject, NAME)
    engine = build_charted(NAME, subject, _JOINTS, whole=False, merged=True)
    if isinstance(engine, Unsupported):
        return engine
    merged = [mover.merged() for mover in assembly.movers]
    masses = np.array([[one.mass, *(one.mass * one.p_BC)] for one in merged])
    given = vars(engine) | {"capabilities": mapped.offered(system), "most_states": MOST_STATES}
    return KinematicTreeEngine(**given, masses=masses, gravity=assembly.gravity)
