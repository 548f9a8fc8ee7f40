"""One of our beams in Exudyn: what its meshes add to M and h, and their elastic forces (docs/theory/elements.md)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

import symofros as sf

from ...contract.conventions import times
from ...mechanics import carried
from ...mechanics.assembly import Mover
from ...mechanics.carried import AllSpeeds, Carried
from ...mechanics.elastic import ElasticBeam
from ...mechanics.extrapolation import Refined
from ...mechanics.geometry import Array
from ...mechanics.rod import PRE_STRAINS, StrainRod
from .meshes import Mesh, mesh
from .solids import Nodal, inertial
from .system import ExudynSystem

# Meshes of a beam.
MESHES = 5
# Powers of the element length by which meshes err: (6), cubic elements of a uniform section; (7), all else.
CUBIC, LINEAR = (4, 6, 8, 10), (2, 4, 6, 8)
# Coordinates of a node that turns.
_NODAL = 7
# Beams as numbers, by their theory.
_NUMBERS: dict[str, type[ElasticBeam] | type[StrainRod]] = {"second_order": ElasticBeam, "strain": StrainRod}
# Stations at which a section is looked at to find whether it varies.
_SAMPLES = 33


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
        mass_powers: Powers by which the cables' mass errs.
        strain_powers: Powers by which the cables' strain errs.
    """

    mover: Mover
    q: slice
    v: slice
    beam: ElasticBeam | StrainRod
    meshes: tuple[Mesh, ...]
    mass_powers: tuple[int, ...]
    strain_powers: tuple[int, ...]

    @property
    def name(self) -> str:
        """The beam's."""
        return self.mover.body

    @property
    def described(self) -> sf.Beam:
        """The beam as described."""
        return self.beam.beam

    def inertia(self, root: Carried, states: AllSpeeds) -> Iterator[tuple[Refined, Refined]]:
        """M (N, n, n) and h (N, n) of what has mass, and of what turns.

        Args:
            root: Frame of the beam's root (K = 1).
            states: The states.
        """
        cables = [self._cables(part, root, states) for part in self.meshes]
        yield self._refined("mass", self.mass_powers, cables)
        turning = [self._turning(part.turning, part.x, root, states) for part in self.meshes if part.turning]
        if turning:
            yield self._refined("rotary inertia", LINEAR, turning)

    def strain(self, q: Array) -> list[Refined]:
        """Elastic forces (N, n) of the clamped beam: of sections that turn; of cables, where it bends in one plane.

        None of a rod that is curved or twisted without stress, which Exudyn's elements here are not.
        """
        if any(getattr(self.described, label) != 0.0 for label in PRE_STRAINS):
            return []
        forces = [self._turned(part.strained, part.x, q) for part in self.meshes]
        refined = [Refined(f"strain of sections of '{self.name}'", LINEAR, forces)]
        bent = [self._bent(part.bent, part.x, q) for part in self.meshes if part.bent]
        title = f"strain of cables of '{self.name}'"
        return [*refined, Refined(title, self.strain_powers, bent)] if bent else refined

    def damping(self, v: Array) -> Refined:
        """Forces (N, n) of the clamped, straight beam's damping at elastic speeds."""
        delay = self.beam.number(self.beam.beam.damping)
        forces = []
        for part in self.meshes:
            nodal = self._clamped(part.x, 0.0 * v[:1])
            K = nodal.J[0].T @ part.strained.stiffness(nodal.x[0]) @ nodal.J[0]
            forces.append(-delay * v @ K)
        return Refined(f"damping of '{self.name}'", LINEAR, forces)

    @property
    def is_rod(self) -> bool:
        """Whether it is geometrically exact, so that its elastic forces are the elements' own."""
        return isinstance(self.beam, StrainRod)

    def _refined(self, name: str, powers: tuple[int, ...], terms: list[Terms]) -> tuple[Refined, Refined]:
        title = f"{name} of '{self.name}'"
        return Refined(title, powers, [one.M for one in terms]), Refined(title, powers, [one.h for one in terms])

    def _cables(self, part: Mesh, root: Carried, states: AllSpeeds) -> Terms:
        """M and h of mass and weight along the axis: nodes have the places and the slopes of our field."""
        q, v = states.q[:, self.q], states.v[:, self.v]
        _, J, a = carried.arrow(root, states, self.v, self.beam.axis(part.x, q, v))
        _, slopes, slopes_bend = carried.arrow(root, states, self.v, self.beam.tangent(part.x, q, v))
        count, _, _, n = J.shape
        J_x = np.stack([root.J + J, slopes], axis=2).reshape(count, -1, n)
        bend = np.stack([root.a + a, slopes_bend], axis=2).reshape(count, -1)
        forces = times(np.broadcast_to(part.M, (count, *part.M.shape)), bend) - part.weight
        return Terms(J_x.swapaxes(1, 2) @ (part.M @ J_x), np.einsum("nxi,nx->ni", J_x, forces))

    def _turning(self, system: ExudynSystem, x: Array, root: Carried, states: AllSpeeds) -> Terms:
        """M and h of the sections' rotation; without rotary inertia about one axis alone, the root's or a rod's own."""
        q, v = states.q[:, self.q], states.v[:, self.v]
        if isinstance(self.beam, StrainRod):
            sections = self.beam.rotation(x, q, v)
        else:
            sections = self.beam.rotation(x, q, v, bending=self.beam.beam.rotary_inertia)
        triads = carried.led(root, states, self.v, self.beam.axis(x, q, v), sections)
        return Terms(*inertial(system, Nodal.of(triads, states.v, places=False), states.v))

    def _clamped(self, x: Array, q: Array) -> Nodal:
        """Sections of the beam at rest, its root in the world."""
        still = 0.0 * q
        states = AllSpeeds(q, still, still)
        place, turn = self.beam.axis(x, q, still), self.beam.rotation(x, q, still)
        triads = carried.led(carried.ground(states), states, slice(None), place, turn)
        nodal = Nodal.of(triads, still, places=self.is_rod)
        if self.is_rod:
            # Places of its nodes count as well, from those of the mesh.
            nodal.x[:, ::_NODAL] -= x
        return nodal

    def _turned(self, system: ExudynSystem, x: Array, q: Array) -> Array:
        nodal = self._clamped(x, q)
        return _forces(system, nodal.x, nodal.J)

    def _bent(self, system: ExudynSystem, x: Array, q: Array) -> Array:
        count, still = len(q), 0.0 * q
        places, slopes = self.beam.axis(x, q, still), self.beam.tangent(x, q, still)
        moved = np.stack([places.value - x[:, None] * (1.0, 0.0, 0.0), slopes.value - (1.0, 0.0, 0.0)], axis=2)
        J = np.stack([places.partial, slopes.partial], axis=2)
        return _forces(system, moved.reshape(count, -1), J.reshape(count, -1, q.shape[1]))


def _forces(system: ExudynSystem, x: Array, J: Array) -> Array:
    """J^T f at rest (N, n)."""
    return np.array([one.T @ system.at(at, 0.0 * at)[1] for at, one in zip(x, J, strict=True)])


def elements(system: sf.System, mover: Mover, slot: tuple[slice, slice], gravity: Array) -> Elements:
    """Exudyn's elements of a beam.

    Args:
        system: The description.
        mover: Mover of the beam's elastic coordinates.
        slot: Where these and their speeds are among all.
        gravity: Acceleration of gravity in the world (3,) [m/s^2].
    """
    described = system.body(mover.body)
    assert isinstance(described, sf.Beam)
    beam = _NUMBERS[described.theory](described, system.parameter_values())
    between = np.linspace(0.0, beam.length, _SAMPLES)
    tapered = {name for name in ("rhoA", "EI_y", "EI_z") if np.any(np.diff(beam.section(name, between)))}
    # The more functions, the shorter their waves; a taper leaves errors of a lower power.
    most = max(described.counts)
    coarsest = max(1, math.ceil(2 * (most - 1) / (len(beam.knots) - 1))) * (2 if "rhoA" in tapered else 1)
    meshes = tuple(mesh(beam, coarsest * 2**k, gravity) for k in range(MESHES))
    stiff = LINEAR if tapered - {"rhoA"} else CUBIC
    return Elements(mover, *slot, beam, meshes, LINEAR if "rhoA" in tapered else CUBIC, stiff)
