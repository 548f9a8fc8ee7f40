"""Exudyn's bodies and finite elements moved by our speeds (github.com/jgerstm/EXUDYN; docs/theory/elements.md).

Every rigid body has Euler parameters of its own, every beam meshes of finite elements. Their coordinates are functions
x(q), stated by the harness (`mechanics.carried`); Exudyn gives their mass matrix and forces, and (2) turns these into
M and h. What a beam's mesh contributes is extrapolated over meshes, each of twice the elements of the one before.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

import symofros as sf
from validation.adapters.exudyn.meshes import Mesh, mesh
from validation.adapters.exudyn.solids import Nodal, Solids, inertial, solids
from validation.adapters.exudyn.system import VERSION, ExudynSystem
from validation.adapters.reach import armature, stores_energy
from validation.contract.conventions import times
from validation.contract.interface import States, Subject, Unsupported
from validation.contract.quantities import TREE_QUANTITIES
from validation.mechanics import carried
from validation.mechanics.assembly import Assembly, FrameSite, Mover, assemble
from validation.mechanics.carried import AllSpeeds, Carried
from validation.mechanics.elastic import ElasticBeam
from validation.mechanics.geometry import Array

NAME = "exudyn-beams"
# Meshes of a beam.
MESHES = 5
# Powers of the element length by which meshes err: (6), cubic elements of a uniform section; (7), all else.
CUBIC, LINEAR = (4, 6, 8, 10), (2, 4, 6, 8)
# States in one call, with beams and without.
MOST_STATES, MOST_RIGID_STATES = 100, 300
# Quantities that meshes enter.
MESHED = ("mass_matrix", "bias", "gravity", "kinetic_energy", "inverse_dynamics", "forward_dynamics", "multipliers")
# Tolerance of these, relative to the largest entry: of extrapolation, and of the spins of second order that our rotary
# inertia has (section 4), which are what the order of the difference is judged for.
EXTRAPOLATED, SECOND_ORDER_SPINS = 1e-8, 1e-6
# Terms of the states asked last; a check asks the same states for one quantity after the other.
_KEPT = 3


class Terms(NamedTuple):
    """M (N, n, n) and h (N, n) of all speeds, those of prescribed joints among them."""

    M: Array
    h: Array


@dataclass(frozen=True)
class Elements:
    """A beam of a description in Exudyn.

    Attributes:
        mover: Mover of its elastic coordinates.
        q: Elastic coordinates among all.
        v: Elastic speeds among all.
        beam: The beam as numbers.
        meshes: Meshes, the coarsest first.
        powers: Powers by which the cables err.
    """

    mover: Mover
    q: slice
    v: slice
    beam: ElasticBeam
    meshes: tuple[Mesh, ...]
    powers: tuple[int, ...]


def extrapolated(values: Sequence[Array], powers: Sequence[int]) -> Array:
    """The limit of values on meshes, each of twice the elements of the one before (Richardson).

    Args:
        values: Values, that of the coarsest mesh first.
        powers: Powers of the element length in the error, as many as the values less one.
    """
    row = list(values)
    for power in powers[: len(values) - 1]:
        factor = 2.0**power
        row = [(factor * fine - coarse) / (factor - 1.0) for coarse, fine in zip(row, row[1:], strict=False)]
    return row[-1]


@dataclass
class MappedEngine:
    """Exudyn's bodies and elements behind the `Engine` protocol.

    Attributes:
        assembly: Assembly of the description.
        solids: Rigid bodies.
        elements: Beams.
        armatures: Inertia added to each speed, in joint space (n,).
        sites: The subject's frames.
        first_motion: Index of the first input that prescribes a motion.
        capabilities: Quantities that it offers for this system.
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
    accuracy: Mapping[str, float]
    most_states: int
    name: str
    version: str = VERSION
    _kept: dict[tuple[bytes, ...], Terms] = field(default_factory=dict)

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
        """Of the weight of rigid bodies."""
        return self.solids.potential_energy(self._solid(self._all(states, moving=False)))

    def inverse_dynamics(self, states: States) -> Array:
        """M a + h - passive."""
        return times(self.mass_matrix(states), states.a) + self.bias(states) - states.passive

    def forward_dynamics(self, states: States) -> Array:
        """M^-1 (applied - h)."""
        net = states.applied - self.bias(states)
        return np.asarray(np.linalg.solve(self.mass_matrix(states), net[:, :, None])[:, :, 0])

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
        key = tuple(x.tobytes() for x in (states.q, states.v, states.u[:, self.first_motion :]))
        if key not in self._kept:
            if len(self._kept) == _KEPT:
                del self._kept[next(iter(self._kept))]
            self._kept[key] = self._evaluated(self._all(states, moving=False))
        return self._kept[key]

    def _evaluated(self, states: AllSpeeds) -> Terms:
        frames = self._frames(states)
        M, h = inertial(self.solids.system, Nodal.of(carried.joined(frames), states.v), states.v)
        M += np.diag(self.armatures)
        h += self.armatures * states.a
        for one in self.elements:
            root = carried.proximal(frames, one.mover, states)
            cables = [_cables(one, part, root, states) for part in one.meshes]
            turning = [_turning(one, part.turning, part.x, root, states) for part in one.meshes if part.turning]
            for parts, powers in ((cables, one.powers), (turning, LINEAR)):
                if parts:
                    M += extrapolated([part.M for part in parts], powers)
                    h += extrapolated([part.h for part in parts], powers)
        return Terms(M, h)


def _cables(one: Elements, part: Mesh, root: Carried, states: AllSpeeds) -> Terms:
    """Of mass and weight along the axis: nodes have the places and the slopes of our field."""
    q, v = states.q[:, one.q], states.v[:, one.v]
    place, J, a = carried.arrow(root, states, one.v, one.beam.axis(part.x, q, v))
    _, slopes, slopes_bend = carried.arrow(root, states, one.v, one.beam.tangent(part.x, q, v))
    count, _, _, n = J.shape
    J_x = np.stack([root.J + J, slopes], axis=2).reshape(count, -1, n)
    bend = np.stack([root.a + a, slopes_bend], axis=2).reshape(count, -1)
    forces = times(np.broadcast_to(part.M, (count, *part.M.shape)), bend) - part.weight
    return Terms(J_x.swapaxes(1, 2) @ (part.M @ J_x), np.einsum("nxi,nx->ni", J_x, forces))


def _turning(one: Elements, system: ExudynSystem, x: Array, root: Carried, states: AllSpeeds) -> Terms:
    """Of what turns; without rotary inertia sections turn about the axis of the root alone."""
    q, v = states.q[:, one.q], states.v[:, one.v]
    sections = one.beam.rotation(x, q, v, bending=one.beam.beam.rotary_inertia)
    triads = carried.led(root, states, one.v, one.beam.axis(x, q, v), sections)
    return Terms(*inertial(system, Nodal.of(triads, states.v, places=False), states.v))


def build(subject: Subject) -> MappedEngine | Unsupported:
    """Exudyn's bodies and elements of a description with beams."""
    return engine(subject, NAME)


def engine(subject: Subject, name: str) -> MappedEngine | Unsupported:
    """Exudyn's bodies and elements of a description.

    Args:
        subject: Subject, with or without beams.
        name: Name of the engine in tables.
    """
    system = subject.system
    assembly = assemble(system)
    obstacle = _obstacle(system, assembly)
    if obstacle is not None:
        return obstacle
    slots = carried.slots(assembly)
    elements = tuple(
        _elements(system, mover, slot, assembly.gravity)
        for mover, slot in zip(assembly.movers, slots, strict=True)
        if mover.kind == "elastic"
    )
    armatures = np.zeros(max(own.stop for _, own in slots))
    for mover, (_, own) in zip(assembly.movers, slots, strict=True):
        armatures[own] = armature(system, mover)
    return MappedEngine(
        assembly,
        solids(assembly),
        elements,
        armatures,
        tuple(assembly.frames[name] for name in subject.frames),
        len(system.inputs) + assembly.motors,
        offered(system),
        dict.fromkeys(MESHED, SECOND_ORDER_SPINS if _turns_sections(elements) else EXTRAPOLATED) if elements else {},
        MOST_STATES if elements else MOST_RIGID_STATES,
        name,
    )


def _elements(system: sf.System, mover: Mover, slot: tuple[slice, slice], gravity: Array) -> Elements:
    described = system.body(mover.body)
    assert isinstance(described, sf.Beam)
    beam = ElasticBeam(described, system.parameter_values())
    # The more functions, the shorter their waves.
    most = max(described.bend_y, described.bend_z, described.twist)
    coarsest = max(1, math.ceil(2 * (most - 1) / (len(beam.knots) - 1)))
    meshes = tuple(mesh(beam, coarsest * 2**k, gravity) for k in range(MESHES))
    uniform = not np.any(np.diff(beam.section("rhoA", meshes[-1].x)))
    return Elements(mover, *slot, beam, meshes, CUBIC if uniform else LINEAR)


def _turns_sections(elements: Sequence[Elements]) -> bool:
    return any(one.beam.beam.rotary_inertia for one in elements)


def _obstacle(system: sf.System, assembly: Assembly) -> Unsupported | None:
    for mover in assembly.movers:
        if mover.kind not in carried.KINDS:
            return Unsupported(f"joint '{mover.joint.name}': a motion by formulas")
    return None


def offered(system: sf.System) -> frozenset[str]:
    """All but the rates of Jacobians, which Exudyn does not have, and the energy of what it was not given."""
    return TREE_QUANTITIES - {"frame_jacobian_rate"} - ({"potential_energy"} if stores_energy(system) else set())
