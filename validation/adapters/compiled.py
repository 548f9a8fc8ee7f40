"""SYMOFROS' generated C: what the others are compared with."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

import symofros as sf
from symofros.tools import DEFAULT_FLAGS, Evaluators

from ..contract.conventions import times
from ..contract.interface import States, Subject
from ..contract.quantities import CONSTRAINED, FRAME_QUANTITIES, LOOPS, MJCF_ROUTE, QUANTITIES, SECOND_ROUTE
from ..mechanics.geometry import Array
from .reach import stores_energy

NAME = "symofros"

_FUNCTIONS = tuple(name for name in QUANTITIES if name not in {"gravity", "multipliers", *LOOPS})

# Flags for variants of a description, which no user asked for: beams with all their terms, a file's every digit, no
# weight. Their C is evaluated a thousand times; to optimise it takes five times as long as to compile it. The
# description as it stands is compiled as users get it.
UNOPTIMISED = tuple("-O0" if flag.startswith("-O") else flag for flag in DEFAULT_FLAGS)

# Sections an interval beyond the number of functions, with which rods err by less than 1e-8 of M and h at the states
# that are drawn.
MORE_SECTIONS = 5


@dataclass(frozen=True)
class SymofrosEngine:
    """A `symofros.Model` behind the `Engine` protocol; our conventions are its own.

    Attributes:
        name: "symofros"; "vectors" and "interpreted" are other ways to the same equations.
        model: Compiled model.
        frames: The subject's frames.
    """

    name: str
    model: sf.Model
    frames: tuple[str, ...] = ()
    capabilities: frozenset[str] = frozenset(QUANTITIES)
    version: str = sf.__version__

    def mass_matrix(self, states: States) -> Array:
        """M."""
        return self.model.mass_matrix(states.q, u=states.u)

    def bias(self, states: States) -> Array:
        """The bias h."""
        return self.model.bias(states.q, states.v, u=states.u)

    def generalized_force(self, states: States) -> Array:
        """Q."""
        return self.model.generalized_force(states.q, states.v, states.u)

    def kinetic_energy(self, states: States) -> Array:
        """T."""
        return self.model.kinetic_energy(states.q, states.v, u=states.u)

    def potential_energy(self, states: States) -> Array:
        """V."""
        return self.model.potential_energy(states.q, u=states.u)

    def inverse_dynamics(self, states: States) -> Array:
        """M a + h - Q(q, v, 0), with the model's own Q."""
        return self.model.inverse_dynamics(states.q, states.v, states.a, u=states.u)

    def joint_wrenches(self, states: States) -> Array:
        """Wrenches of the joints; where loops are closed, those of the tree cut open."""
        lam = np.zeros(self.model.nc)
        return self.model.joint_wrenches(states.q, states.v, states.a, states.u, lam)

    def forward_dynamics(self, states: States) -> Array:
        """M^-1 (Q - h), with the model's own Q."""
        return self.model.forward_dynamics(states.q, states.v, states.u)

    def multipliers(self, states: States) -> Array:
        """Multipliers of the constraints."""
        return self.model.constrained_dynamics(states.q, states.v, states.u)[1]

    def constraint(self, states: States) -> Array:
        """Residuals of the constraints."""
        return self.model.constraint(states.q, u=states.u)

    def constraint_jacobian(self, states: States) -> Array:
        """G."""
        return self.model.constraint_jacobian(states.q, u=states.u)

    def constraint_bias(self, states: States) -> Array:
        """Right-hand side c of G v' = c."""
        return self.model.constraint_bias(states.q, states.v, u=states.u)

    def constraint_force(self, states: States) -> Array:
        """What constraints do to the speeds, which is unique where multipliers are not."""
        return times(self.constraint_jacobian(states).swapaxes(-1, -2), self.multipliers(states))

    def closure_gap(self, states: States) -> Array:
        """The largest |phi|."""
        return np.asarray(np.abs(self.constraint(states)).max(axis=1))

    def _frames(self, one: Callable[[str], Array]) -> Array:
        return np.stack([one(frame) for frame in self.frames], axis=1)

    def frame_pose(self, states: States) -> Array:
        """Position, then rotation row by row."""

        def one(frame: str) -> Array:
            p, R = self.model.frame_pose(frame, states.q, u=states.u)
            return np.concatenate([p, R.reshape(-1, 9)], axis=1)

        return self._frames(one)

    def frame_velocity(self, states: States) -> Array:
        """Linear, angular."""
        return self._frames(lambda frame: self.model.frame_velocity(frame, states.q, states.v, u=states.u))

    def frame_acceleration(self, states: States) -> Array:
        """Linear, angular."""
        return self._frames(
            lambda frame: self.model.frame_acceleration(frame, states.q, states.v, states.a, u=states.u)
        )

    def frame_response(self, states: States) -> Array:
        """The acceleration that the forces produce."""
        return self.frame_acceleration(replace(states, a=self.forward_dynamics(states)))

    def frame_jacobian(self, states: States) -> Array:
        """Jacobians of the frames' velocities (N, F, 6, nv)."""
        return self._frames(lambda frame: self.model.frame_jacobian(frame, states.q, u=states.u))

    def frame_jacobian_rate(self, states: States) -> Array:
        """Time derivatives of the frame Jacobians (N, F, 6, nv)."""
        return self._frames(lambda frame: self.model.frame_jacobian_rate(frame, states.q, states.v, u=states.u))


def build(subject: Subject, flags: tuple[str, ...] | None = None) -> SymofrosEngine:
    """Generate, compile and load everything that is compared, in one C file, evaluated state by state.

    Args:
        subject: The subject.
        flags: Flags of the C compiler in place of those that users get.

    Raises:
        DescriptionError: The system can't be a mechanism.
    """
    return SymofrosEngine(NAME, evaluators(subject, flags).by_states, subject.frames)


# The subjects of one check: as described, every term of its beams kept, without their rotary inertia, with rotors.
_LATEST: deque[tuple[Subject, Evaluators]] = deque(maxlen=4)


def evaluators(subject: Subject, flags: tuple[str, ...] | None = None) -> Evaluators:
    """The ways to evaluate one program of just the functions and frames that are compared; the latest are kept.

    Args:
        subject: The subject.
        flags: Flags of the C compiler, where they are the first to be asked for.
    """
    for known, made in _LATEST:
        if known is subject:
            return made
    _LATEST.append((subject, Evaluators(subject.system, replace(options(subject), flags=flags))))
    return _LATEST[-1][1]


def build_verbatim(subject: Subject) -> SymofrosEngine:
    """The same of the file's every digit, for engines that read the file themselves.

    Raises:
        DescriptionError: The system can't be a mechanism.
    """
    compared = MJCF_ROUTE if subject.format == "mjcf" else SECOND_ROUTE
    functions = tuple(name for name in _FUNCTIONS if name in compared)
    frames = subject.frames if FRAME_QUANTITIES & compared else ()
    model = sf.compile(subject.verbatim, sf.Options(functions, frames, flags=UNOPTIMISED, batch="loop"))
    return SymofrosEngine(NAME, model, frames)


def untruncated(system: sf.System) -> sf.System:
    """The system with every term of its beams kept (`retain = "all"`); equal to it if they are kept already.

    Geometrically exact rods keep every term.
    """
    bodies = [
        replace(body, retain="all") if isinstance(body, sf.Beam) and not body.elastic.is_exact else body
        for body in system.bodies
    ]
    return replace(system, bodies=tuple(bodies))


def without_rotary(system: sf.System) -> sf.System:
    """The untruncated system, the sections of its beams without rotary inertia but that of twist.

    Rods, whose sections turn exactly, keep theirs; they have as many sections as rods without the error of these.
    """
    bodies = tuple(_of_elements(body) if isinstance(body, sf.Beam) else body for body in untruncated(system).bodies)
    return replace(system, bodies=bodies)


def _of_elements(beam: sf.Beam) -> sf.Beam:
    if beam.elastic.is_exact:
        return replace(beam, sections=max(beam.sections, max(beam.counts) + MORE_SECTIONS))
    return replace(beam, rotary_inertia=False)


def build_weightless(subject: Subject) -> sf.Model | None:
    """The potential energy of everything but the weight; None where nothing else has any.

    Raises:
        DescriptionError: The system can't be a mechanism.
    """
    if not stores_energy(subject.system):
        return None
    weightless = replace(subject.system, gravity=(0.0, 0.0, 0.0))
    return sf.compile(weightless, sf.Options(("potential_energy",), flags=UNOPTIMISED, batch="loop"))


def options(subject: Subject) -> sf.Options:
    """Just the functions and frames that are compared."""
    absent = (frozenset() if subject.frames else FRAME_QUANTITIES) | (
        frozenset() if subject.system.constraints else CONSTRAINED
    )
    if any("massless_tip" in body.waive for body in subject.system.bodies) and subject.assembly.moves_no_mass:
        absent |= {"forward_dynamics"}
    functions = tuple(f for f in _FUNCTIONS if f not in absent)
    return sf.Options(functions=functions, frames=subject.frames)
