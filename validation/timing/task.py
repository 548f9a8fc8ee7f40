"""One model's states, the same for every side, and what a side is to a race."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

import symofros as sf

from ..comparison.loops import MOST, assembled_states
from ..contract.interface import States
from ..inputs.sampling import sample
from ..mechanics.assembly import Assembly, assemble
from ..mechanics.geometry import Array
from .models import TIMED_MODELS
from .record import Cost

STATES = 1000
# Of the integrators: short, so that a motion of STATES steps stays near its start, and both sides' ends comparable [s].
STEP = 1e-5
# Beside a posture of many loops: how far its coordinates are moved before it is closed again [rad, m]; how many times
# that is done, times speeds.
NEAR, SEARCHED = 0.3, 2000
# By how much constraints may amplify rounding: rows of n loops do so by n^2, and solutions are compared to 1e-9.
WORST_CONDITION = 1e6
# That state of the sample where a motion starts: after the special ones.
START = 10


@dataclass(frozen=True)
class Loop:
    """One function of one model by one side, ready to be timed.

    Attributes:
        function: Name of the function.
        variant: Build and algorithm; "" where there is one.
        run: So many rounds over all states, results left behind.
        results: Results in the conventions of symofros (n, size).
        cost: Cost of making it, for generated code.
    """

    function: str
    variant: str
    run: Callable[[int], None]
    results: Callable[[], Array]
    cost: Cost | None = None


@dataclass(frozen=True)
class Task:
    """One model.

    Attributes:
        label: Name on the command line.
        system: The description.
        assembly: The same as numbers.
        states: States with u, and in `applied` the forces that u makes.
        body: The moving body whose Jacobian is timed: the one that most joints carry.
    """

    label: str
    system: sf.System
    assembly: Assembly
    states: States
    body: int

    @property
    def frame(self) -> str:
        """The frame of that body."""
        return self.assembly.movers[self.body].body


def task(label: str, count: int = STATES) -> Task:
    """A model with its states."""
    system = TIMED_MODELS[label].load()
    assembly = assemble(system)
    states = sample(assembly, assembly.motors + len(system.inputs), count)
    if system.constraints:
        closed = assembled_states(system, _beside(system, TIMED_MODELS[label].closed, states), WORST_CONDITION)
        again = np.arange(count) % len(closed)  # Assembly is a search: some postures in turn.
        states = replace(states, **{name: getattr(closed, name)[again] for name in ("q", "v", "a", "u")})
    tau = np.zeros((count, assembly.nv))
    at = len(system.inputs)
    for described in assembly.free_joints:
        if described.joint.actuated:
            size = described.v.stop - described.v.start
            tau[:, described.v] = states.u[:, at : at + size]
            at += size
    states = replace(states, applied=tau)
    depths: list[int] = []
    for mover in assembly.movers:
        depths.append(1 + (depths[mover.parent] if mover.parent >= 0 else 0))
    return Task(label, system, assembly, states, int(np.argmax(depths)))


def _beside(system: sf.System, closed: Mapping[str, float] | None, states: States) -> States:
    """The first states, fewer the larger the mechanism, with postures beside a closed one; all if none is stated."""
    if closed is None:
        return states
    model = sf.compile(system, sf.Options(("constraint",), backend="interpreter"))
    first = states[START : START + min(MOST, max(4, SEARCHED // model.nv))]
    rest = np.array([closed[name] for name in model.names.q])
    steps = NEAR * first.v / np.abs(first.v).max(axis=1, keepdims=True)
    return replace(first, q=np.array([model.integrate(rest, step) for step in steps]))


def flat(*parts: Array) -> Array:
    """Results of one function, side by side (n, size)."""
    return np.concatenate([part.reshape(len(part), -1) for part in parts], axis=1)
