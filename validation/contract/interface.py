"""What an engine is to the harness: a thing that turns a batch of states into the quantities of one system.

Everything crosses this border in SYMOFROS conventions (`symofros/NOTATION.md`); `conventions` does the turning.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cached_property
from pathlib import Path
from typing import Literal, Protocol

import numpy as np

import symofros as sf

from ..mechanics.assembly import Assembly, assemble
from ..mechanics.geometry import Array
from ..mechanics.modes import without_modes
from .conventions import times

# Of files that engines read themselves; "" for none.
Format = Literal["", "urdf", "mjcf"]


@dataclass(frozen=True)
class Unsupported:
    """A system that an engine can't represent, or a quantity that it can't compute; returned, never raised.

    Attributes:
        reason: Names the thing that is in the way, for people: the engine's words, or ours where it offers nothing of
            the kind.
        offered: Whether the engine offers such a thing at all: False for a function or a kind that it doesn't have.
    """

    reason: str
    offered: bool = True


@dataclass(frozen=True)
class States:
    """A batch of N states, the same for every engine.

    Attributes:
        q: Coordinates (N, nq).
        v: Speeds (N, nv).
        a: Rates of the speeds (N, nv).
        u: Inputs (N, nu).
        applied: Q(q, v, u) (N, nv), what forward dynamics gets: engines know no formulas of efforts.
        passive: Q(q, v, 0) (N, nv), what inverse dynamics subtracts.
    """

    q: Array
    v: Array
    a: Array
    u: Array
    applied: Array
    passive: Array

    def __len__(self) -> int:
        """The number of states."""
        return len(self.q)

    def __getitem__(self, chosen: slice) -> States:
        """Some of the states."""
        return States(*(getattr(self, item.name)[chosen] for item in fields(self)))

    def at_rest(self) -> States:
        """The same configurations with v = 0."""
        return replace(self, v=self.v * 0.0)


class Engine(Protocol):
    """One engine's model of one system: a method for each of its capabilities, N states in, N results out.

    Frame quantities are those of the F frames of the subject that the engine was built from, and stack
    (linear; angular).
    """

    @property
    def name(self) -> str:
        """Name of the engine as tables show it."""

    @property
    def version(self) -> str:
        """Version of the engine's package."""

    @property
    def capabilities(self) -> frozenset[str]:
        """The quantities it offers (`quantities`); nobody else's comparison shrinks to them."""


class TreeEngine(Engine, Protocol):
    """An engine for rigid trees: everything but the forces, which only the description states."""

    def mass_matrix(self, states: States) -> Array:
        """M (N, nv, nv)."""

    def bias(self, states: States) -> Array:
        """Coriolis, centrifugal and gravity forces h (N, nv)."""

    def kinetic_energy(self, states: States) -> Array:
        """T (N,) [J]."""

    def potential_energy(self, states: States) -> Array:
        """V (N,) [J], zero where every mass centre is at the world's origin."""

    def inverse_dynamics(self, states: States) -> Array:
        """M a + h - passive (N, nv)."""

    def forward_dynamics(self, states: States) -> Array:
        """M^-1 (applied - h) (N, nv)."""

    def frame_pose(self, states: States) -> Array:
        """p_WF and the rows of R_WF (N, F, 12)."""

    def frame_velocity(self, states: States) -> Array:
        """Velocity of each frame, (linear; angular), of its origin and in world axes (N, F, 6)."""

    def frame_acceleration(self, states: States) -> Array:
        """The time derivative of frame_velocity (N, F, 6)."""

    def frame_jacobian(self, states: States) -> Array:
        """frame_velocity = J v (N, F, 6, nv)."""

    def frame_jacobian_rate(self, states: States) -> Array:
        """dJ/dt (N, F, 6, nv)."""


class NotOffered(ValueError):
    """An engine does not have a function for the system at hand; the message says why."""


class SolvedEngine:
    """An engine that answers M and h alone: energy and dynamics follow from them by NumPy."""

    def mass_matrix(self, states: States) -> Array:
        """M (N, nv, nv)."""
        raise NotImplementedError

    def bias(self, states: States) -> Array:
        """Coriolis, centrifugal and gravity forces h (N, nv)."""
        raise NotImplementedError

    def kinetic_energy(self, states: States) -> Array:
        """v^T M v / 2."""
        return np.asarray(np.einsum("ni,nij,nj->n", states.v, self.mass_matrix(states), states.v) / 2.0)

    def inverse_dynamics(self, states: States) -> Array:
        """M a + h - passive."""
        return times(self.mass_matrix(states), states.a) + self.bias(states) - states.passive

    def forward_dynamics(self, states: States) -> Array:
        """M^-1 (applied - h)."""
        net = states.applied - self.bias(states)
        return np.asarray(np.linalg.solve(self.mass_matrix(states), net[:, :, None])[:, :, 0])


@dataclass(frozen=True)
class UrdfSource:
    """The file that a system was read from, for engines that read it themselves.

    Attributes:
        text: Content of the file, undecoded: its first line says how it is encoded.
        verbatim: Our reading of it with every digit as it stands; reading it normally makes exact what was meant so.
        floating_base: Whether reading it put a free joint under its root.
    """

    text: bytes
    verbatim: sf.System
    floating_base: bool = False


@dataclass(frozen=True)
class MjcfSource:
    """The MJCF file that a system was read from; reading it has shown that it names no file outside of its folder.

    Attributes:
        path: Path of the main file.
        verbatim: Our reading of it with every digit as it stands.
    """

    path: Path
    verbatim: sf.System


@dataclass(frozen=True)
class Subject:
    """What an engine is built from.

    Attributes:
        label: Name of the model in tables.
        system: The description.
        frames: The frames that frame quantities are compared at; none: the harness chooses.
        urdf: URDF file of the model, if it came from one.
        mjcf: MJCF file of the model, if it came from one.
    """

    label: str
    system: sf.System
    frames: tuple[str, ...] = ()
    urdf: UrdfSource | None = None
    mjcf: MjcfSource | None = None

    def __post_init__(self) -> None:
        """Friction that sticks is compared as smooth, rigid contacts as open: modes are of runs."""
        object.__setattr__(self, "system", without_modes(self.system))

    @property
    def format(self) -> Format:
        """Format of the file that engines can read themselves."""
        return "urdf" if self.urdf is not None else "mjcf" if self.mjcf is not None else ""

    @cached_property
    def assembly(self) -> Assembly:
        """The system as numbers, which all engines' models are built from."""
        return assemble(self.system)

    @property
    def verbatim(self) -> sf.System:
        """The system with every digit of its file as it stands."""
        source = self.urdf or self.mjcf
        return self.system if source is None else source.verbatim


class EngineFactory(Protocol):
    """Builds an engine's model of a subject."""

    def __call__(self, subject: Subject) -> Engine | Unsupported:
        """The engine, or why it can't represent the subject."""
