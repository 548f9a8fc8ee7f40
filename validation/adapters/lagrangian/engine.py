"""Lagrange's equations by automatic differentiation: the second opinion on beams (https://casadi.org).

Kinetic and potential energy are sums over bodies and Gauss stations; CasADi differentiates. It keeps every term of a
beam's second-order field, whatever order the description asks for, so it is compared with our model of everything kept.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import version
from typing import Any

import casadi as ca
import numpy as np

import symofros as sf

from ...contract.interface import SolvedEngine, States, Subject, TreeEngine, Unsupported
from ...contract.quantities import FORCES_STATED, TREE_QUANTITIES
from ...mechanics.assembly import Assembly
from ...mechanics.geometry import Array, skew
from ...mechanics.parts import coordinate_symbols, speed_symbols
from ..description import StatedForces
from .model import Translation
from .tree import GROUND, WORLD, Lagrangian, Pose, rate_of, turning_of

NAME = "lagrangian"
VERSION = f"casadi {version('casadi')}"

# Evaluations of the momentum that one batch of mass matrices may take: some seconds for a model of 50 speeds.
MOST_COLUMNS = 20_000


@dataclass(frozen=True)
class LagrangianEngine(SolvedEngine):
    """The energies of a tree behind the `Engine` protocol.

    Attributes:
        tree: Equations of the tree.
        stated: The description's formulas of joint forces.
        poses: Poses of the subject's frames; velocities and accelerations.
        turnings: Change of the velocities with the configuration, in the direction (a, dds).
        frames: Number of frames.
        capabilities: Quantities that it offers for this system.
        most_states: Largest number of states in one call.
    """

    tree: Lagrangian
    stated: StatedForces
    poses: Any
    velocities: Any
    accelerations: Any
    turnings: Any
    frames: int
    capabilities: frozenset[str]
    most_states: int
    name: str = NAME
    version: str = VERSION

    def mass_matrix(self, states: States) -> Array:
        """The momentum of unit speeds, column by column."""
        return self._columns(self.tree.momentum, states)

    def bias(self, states: States) -> Array:
        """Lagrange's left side without accelerations."""
        return self._each(self.tree.force, states, a=0.0 * states.a)

    def generalized_force(self, states: States) -> Array:
        """The description's formulas; strain, damping and loads of beams from their energies and powers."""
        return self.stated.generalized_force(states) + self._each(self.tree.applied, states)

    def kinetic_energy(self, states: States) -> Array:
        """Kinetic energy of bodies, beam sections and rotors (N,) [J]."""
        return self._each(self.tree.kinetic, states)[:, 0]

    def potential_energy(self, states: States) -> Array:
        """Potential energy of gravity, strain, and joint springs and stops (N,) [J]."""
        return self._each(self.tree.potential, states)[:, 0] + self.stated.stored_energy(states)

    def inverse_dynamics(self, states: States) -> Array:
        """Lagrange's left side."""
        return self._each(self.tree.force, states) - states.passive

    def frame_pose(self, states: States) -> Array:
        """Position, then rotation row by row."""
        return self._each(self.poses, states).reshape(len(states), self.frames, 12)

    def frame_velocity(self, states: States) -> Array:
        """Rates of the pose."""
        return self._each(self.velocities, states).reshape(len(states), self.frames, 6)

    def frame_acceleration(self, states: States) -> Array:
        """Rates of the velocity."""
        return self._each(self.accelerations, states).reshape(len(states), self.frames, 6)

    def frame_jacobian(self, states: States) -> Array:
        """Velocities of unit speeds."""
        nv = states.v.shape[1]
        return self._columns(self.velocities, states).reshape(len(states), self.frames, 6, nv)

    def frame_jacobian_rate(self, states: States) -> Array:
        """Rates of its columns; those of displacements, less what displacements turn against our speeds."""
        nv = states.v.shape[1]
        rate = self._columns(self.turnings, states).reshape(len(states), self.frames, 6, nv)
        return np.asarray(rate - self.frame_jacobian(states) @ self._speeds_turning(states)[:, None])

    def _speeds_turning(self, states: States) -> Array:
        """The rate of T in v = T e' (N, nv, nv), where speeds are no rates (`tree`, (1))."""
        turning = np.zeros((*states.v.shape, states.v.shape[1]))
        for mover in self.stated.assembly.movers:
            if mover.has_quaternion and not mover.joint.prescribed:
                end = mover.v.stop
                w = slice(end - 3, end)
                turning[:, w, w] = -0.5 * skew(states.v[:, w])
                if mover.kind == "free":
                    x = slice(end - 6, end - 3)
                    turning[:, x, x] = turning[:, w, w]
                    turning[:, x, w] = -0.5 * skew(states.v[:, x])
        return turning

    def _each(self, function: Any, states: States, a: Array | None = None) -> Array:
        s, ds, dds, u = self._given(states)
        return _evaluated(function, states.q, states.v, states.a if a is None else a, s, ds, dds, u)

    def _columns(self, function: Any, states: States) -> Array:
        """A function that is linear in the speeds, for each unit speed: (N, rows, nv); in place of rates, speeds."""
        nv = states.v.shape[1]
        s, ds, _, u = (np.repeat(x, nv, axis=0) for x in self._given(states))
        q, v = (np.repeat(x, nv, axis=0) for x in (states.q, states.v))
        columns = _evaluated(function, q, np.tile(np.eye(nv), (len(states), 1)), v, s, 0.0 * ds, ds, u)
        return columns.reshape(len(states), nv, -1).transpose(0, 2, 1)

    def _given(self, states: States) -> tuple[Array, Array, Array, Array]:
        """Prescribed coordinates, their speeds and rates, and the named inputs."""
        assembly, named = self.stated.assembly, len(self.stated.system.inputs)
        parts: tuple[list[Array], list[Array], list[Array]] = ([], [], [])
        at = named + assembly.motors
        for joint in assembly.driven_joints:
            sizes = len(coordinate_symbols(joint)), len(speed_symbols(joint)), len(speed_symbols(joint))
            for part, size in zip(parts, sizes, strict=True):
                part.append(states.u[:, at : at + size])
                at += size
        none = np.zeros((len(states), 0))
        s, ds, dds = (np.concatenate([none, *part], axis=1) for part in parts)
        return s, ds, dds, states.u[:, :named]


def _evaluated(function: Any, *arguments: Array) -> Array:
    """A function of columns for a batch of rows (N, n)."""
    # CasADi takes a matrix as a batch of columns; where all are empty it would see a single call.
    n = len(arguments[0])
    result = function.map(n)(*(ca.DM(x.T) for x in arguments))
    return np.array(result).T.reshape(n, -1)


def build(subject: Subject) -> TreeEngine | Unsupported:
    """The energies of a description that has beams."""
    system = subject.system
    if not bool(system.beams):
        return Unsupported("no beams: rigid trees are left to faster engines")
    assembly = subject.assembly
    obstacle = _obstacle(assembly)
    if obstacle is not None:
        return obstacle
    nodes, symbols = Translation(system, assembly).build()
    tree = Lagrangian(nodes, assembly.gravity.tolist(), symbols)
    frames = [_frame(tree, assembly, name) for name in subject.frames]
    pose = ca.vertcat(ca.SX(0, 1), *(ca.vertcat(frame.p, ca.vec(frame.R.T)) for frame in frames))
    velocity = ca.vertcat(ca.SX(0, 1), *(ca.vertcat(frame.dp, frame.R @ frame.spin()) for frame in frames))
    function: Callable[[str, Any], Any] = symbols.function
    return LagrangianEngine(
        tree,
        StatedForces(system, assembly),
        function("poses", pose),
        function("velocities", velocity),
        function("accelerations", rate_of(symbols, velocity)),
        function("turnings", turning_of(symbols, velocity)),
        len(frames),
        _offered(system),
        max(10, MOST_COLUMNS // max(assembly.nv, 1)),
    )


def _obstacle(assembly: Assembly) -> Unsupported | None:
    for mover in assembly.movers:
        if mover.joint.prescribed and mover.has_quaternion:
            return Unsupported(f"joint '{mover.joint.name}': a prescribed motion with a quaternion")
        if mover.continues and any(rotor.axis is None for rotor in mover.joint.rotors):
            return Unsupported(f"joint '{mover.joint.name}': a rotor about the joint's own axis, of several")
    return None


def _frame(tree: Lagrangian, assembly: Assembly, name: str) -> Pose:
    site = assembly.frames[name]
    body = tree.shown[site.mover] if site.mover != WORLD else GROUND
    return body.carried(ca.SX(site.X_BF.p), ca.SX(site.X_BF.R), ca.SX.zeros(3), ca.SX.zeros(3, 3))


def _offered(system: sf.System) -> frozenset[str]:
    """All but what it was not given: forces that the description states by frames or potentials."""
    offered = TREE_QUANTITIES
    if system.connections or system.potentials:
        return offered - {"potential_energy"}
    loaded = any(body.loads for body in system.bodies if isinstance(body, sf.RigidBody))
    return offered if loaded else offered | FORCES_STATED
