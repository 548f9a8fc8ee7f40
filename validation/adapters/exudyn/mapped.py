"""Exudyn's bodies and finite elements moved by our speeds (github.com/jgerstm/EXUDYN; docs/theory/elements.md).

Every rigid body has Euler parameters of its own, every beam meshes of finite elements. Their coordinates are functions
x(q), stated by the harness (`mechanics.carried`); Exudyn gives their mass matrix and forces, and (2) turns these into
M and h. What a beam's mesh contributes is extrapolated over meshes, each of twice the elements of the one before.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

import symofros as sf

from ...contract.conventions import times
from ...contract.interface import SolvedEngine, States, Subject, Unsupported
from ...contract.memory import LatestResults
from ...contract.quantities import TREE_QUANTITIES
from ...mechanics import carried
from ...mechanics.assembly import Assembly, FrameSite
from ...mechanics.carried import AllSpeeds, Carried
from ...mechanics.extrapolation import Refined
from ...mechanics.geometry import Array
from ..compiled import without_rotary
from ..reach import armature, stores_energy
from .elements import Elements, Terms, elements
from .solids import Nodal, Solids, inertial, solids
from .system import VERSION

NAME = "exudyn-beams"
# States in one call, with beams and without.
MOST_STATES, MOST_RIGID_STATES = 100, 300
# Tolerances, relative to the largest entry, of what meshes enter: after extrapolation; where a system is solved, which
# amplifies what extrapolation leaves as it amplifies rounding (`quantities.SOLVE` beside `quantities.ROUNDING`).
EXTRAPOLATED, SOLVED = 1e-8, 1e-6
ACCURACY = {
    **dict.fromkeys(("mass_matrix", "bias", "gravity", "kinetic_energy", "inverse_dynamics"), EXTRAPOLATED),
    **dict.fromkeys(("forward_dynamics", "multipliers"), SOLVED),
}
# Frames that a rod carries, which sections place as they integrate it (rods.md, section 6): 1e-9 at the states drawn.
INTEGRATED = dict.fromkeys(("frame_pose", "frame_velocity", "frame_acceleration", "frame_jacobian"), EXTRAPOLATED)


@dataclass
class MappedEngine(SolvedEngine):
    """Exudyn's bodies and elements behind the `Engine` protocol.

    Attributes:
        assembly: Assembly of the description.
        solids: Rigid bodies.
        elements: Beams.
        armatures: Inertia added to each speed, in joint space (n,).
        sites: The subject's frames.
        first_motion: Index of the first input that prescribes a motion.
        capabilities: Quantities that it offers for this system.
        rotary: The same with rotary inertia of beams that have it to second order; None where none do.
        accuracy: Tolerances, relative to the largest entry, of quantities that are not exact.
        most_states: Largest number of states in one call.
    """

    assembly: Assembly
    solids: Solids
    elements: tuple[Elements, ...]
    armatures: Array
    sites: tuple[FrameSite, ...]
    first_motion: int
    capabilities: frozenset[str]
    rotary: MappedEngine | None
    accuracy: Mapping[str, float]
    most_states: int
    name: str
    version: str = VERSION
    _latest: LatestResults[Terms] = field(default_factory=LatestResults)

    def mass_matrix(self, states: States) -> Array:
        """M."""
        nv = self.assembly.nv
        return self._terms(states).M[:, :nv, :nv]

    def bias(self, states: States) -> Array:
        """What remains without accelerations; prescribed motions keep theirs."""
        return self._terms(states).h[:, : self.assembly.nv]

    def kinetic_energy(self, states: States) -> Array:
        """v^T M v / 2 of all speeds."""
        v = self._all(states, moving=False).v
        return np.asarray(np.einsum("ni,nij,nj->n", v, self._terms(states).M, v) / 2.0)

    def potential_energy(self, states: States) -> Array:
        """Gravitational potential energy of the rigid bodies (N,) [J]."""
        return self.solids.potential_energy(self._solid(self._all(states, moving=False)))

    def frame_pose(self, states: States) -> Array:
        """Position, then rotation row by row."""
        return self.solids.pose(self._solid(self._all(states)), self.sites)

    def frame_velocity(self, states: States) -> Array:
        """Linear, angular."""
        moving = self._all(states)
        nodal = self._solid(moving)
        return self.solids.twist(nodal, times(nodal.J, moving.v), self.sites)

    def frame_acceleration(self, states: States) -> Array:
        """Linear, angular."""
        moving = self._all(states)
        nodal = self._solid(moving)
        return self.solids.twist_rate(nodal, times(nodal.J, moving.v), self.sites)

    def frame_jacobian(self, states: States) -> Array:
        """Velocities of unit speeds."""
        nodal = self._solid(self._all(states))
        return self.solids.jacobian(nodal, self.sites)[..., : self.assembly.nv]

    def refined_inertia(self, states: States) -> list[Refined]:
        """What each beam adds to M (N, n, n), mesh by mesh."""
        moving = self._all(states, moving=False)
        return [part for part, _ in self._refined(self._frames(moving), moving)]

    def _all(self, states: States, moving: bool = True) -> AllSpeeds:
        """The states with prescribed motions; unless moving, without accelerations of the free speeds."""
        a = states.a if moving else 0.0 * states.a
        return carried.all_speeds(self.assembly, states.q, states.v, a, states.u[:, self.first_motion :])

    def _frames(self, states: AllSpeeds) -> list[Carried]:
        beams = {one.mover.body: one.beam for one in self.elements}
        return carried.bodies(self.assembly, beams, states)

    def _solid(self, states: AllSpeeds) -> Nodal:
        return Nodal.of(carried.joined(self._frames(states)), states.v)

    def _terms(self, states: States) -> Terms:
        arguments = states.q, states.v, states.u[:, self.first_motion :]
        return self._latest.get(arguments, lambda: self._evaluated(self._all(states, moving=False)))

    def _evaluated(self, states: AllSpeeds) -> Terms:
        frames = self._frames(states)
        M, h = inertial(self.solids.system, Nodal.of(carried.joined(frames), states.v), states.v)
        M += np.diag(self.armatures)
        h += self.armatures * states.a
        for part, load in self._refined(frames, states):
            M += part.limit()
            h += load.limit()
        return Terms(M, h)

    def _refined(self, frames: list[Carried], states: AllSpeeds) -> Iterator[tuple[Refined, Refined]]:
        for one in self.elements:
            yield from one.inertia(carried.proximal(frames, one.mover, states), states)


def build(subject: Subject) -> MappedEngine | Unsupported:
    """Exudyn's bodies and elements of a description with beams."""
    return engine(subject, NAME)


def engine(subject: Subject, name: str) -> MappedEngine | Unsupported:
    """Exudyn's bodies and elements of a description, without its beams' rotary inertia."""
    assembly = subject.assembly
    for mover in assembly.movers:
        if mover.kind not in carried.KINDS:
            what = "a section of a beam" if mover.kind == "section" else "a motion by formulas"
            return Unsupported(f"joint '{mover.joint.name}': {what}")
    for body in subject.system.bodies:
        if isinstance(body, sf.Beam) and body.is_coupled:
            return Unsupported(
                f"beam '{body.name}': a section whose centres are not on the axis, or that couples strains"
            )
    plain = without_rotary(subject.system)
    approximate = any(
        isinstance(body, sf.Beam) and not body.elastic.is_exact and body.rotary_inertia
        for body in subject.system.bodies
    )
    turning = _engine(subject, subject.system, assembly, name) if approximate else None
    return replace(_engine(subject, plain, assembly, name), rotary=turning)


def _engine(subject: Subject, system: sf.System, assembly: Assembly, name: str) -> MappedEngine:
    slots = carried.slots(assembly)
    made = tuple(
        elements(system, mover, slot, assembly.gravity)
        for mover, slot in zip(assembly.movers, slots, strict=True)
        if mover.kind == "elastic"
    )
    armatures = np.zeros(max(own.stop for _, own in slots))
    for mover, (_, own) in zip(assembly.movers, slots, strict=True):
        armatures[own] = armature(system, mover)
    return MappedEngine(
        assembly,
        solids(assembly),
        made,
        armatures,
        tuple(assembly.frames[name] for name in subject.frames),
        len(system.inputs) + assembly.motors,
        offered(system),
        None,
        (ACCURACY | INTEGRATED if any(one.is_rod for one in made) else ACCURACY) if made else {},
        MOST_STATES if made else MOST_RIGID_STATES,
        name,
    )


def offered(system: sf.System) -> frozenset[str]:
    """All but the rates of Jacobians, which Exudyn does not have, and the energy of what it was not given."""
    return TREE_QUANTITIES - {"frame_jacobian_rate"} - ({"potential_energy"} if stores_energy(system) else set())
