"""Whom an engine is compared with: the same description, as that engine knows it."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

import symofros as sf
from validation.adapters import ROUTES
from validation.adapters import compiled as our_c
from validation.adapters.compiled import SymofrosEngine
from validation.comparison.loops import assembled_states
from validation.contract.interface import Engine, States, Subject
from validation.mechanics.assembly import Assembly

# A user's own shape functions are interpolated by ours; the second derivative of the interpolant, which the strain
# takes, keeps ten digits of the formula's.
INTERPOLATED = 1e-10


class Sides:
    """Our models of one subject, each with the states under its own forces.

    Args:
        subject: What is compared.
        assembly: The same as numbers.
        ours: Our model of it as it stands.
        states: Without forces.
    """

    def __init__(self, subject: Subject, assembly: Assembly, ours: SymofrosEngine, states: States) -> None:
        self.subject, self.ours = subject, ours
        self._efforts = len(subject.system.inputs) + assembly.motors
        self.states = with_forces(ours, states, self._efforts)

    def of(self, engine: Engine) -> SymofrosEngine:
        """One that reads the file itself knows nothing of what we made exact; one for beams keeps every term."""
        if ROUTES[engine.name].beams:
            return self.everything
        return self.verbatim if ROUTES[engine.name].reads else self.ours

    def states_of(self, engine: Engine) -> States:
        """The states with the forces of that side; as many as the engine computes in reasonable time."""
        if ROUTES[engine.name].loops:
            return self.assembled[: getattr(engine, "most_states", len(self.assembled))]
        states = self._everything_states if self.of(engine) is self.everything else self.states
        return states[: getattr(engine, "most_states", len(states))]

    @cached_property
    def assembled(self) -> States:
        """States that keep the constraints, with their forces."""
        return with_forces(self.ours, assembled_states(self.subject.system, self.states), self._efforts)

    def tolerance(self, engine: Engine) -> float:
        """What no agreement can be closer than; zero for engines that take the same numbers as we do."""
        return INTERPOLATED if ROUTES[engine.name].beams and has_formulas(self.subject.system) else 0.0

    @cached_property
    def verbatim(self) -> SymofrosEngine:
        """Our model of the file's every digit."""
        same = self.subject.verbatim == self.subject.system
        return self.ours if same else our_c.build_verbatim(self.subject)

    @cached_property
    def everything(self) -> SymofrosEngine:
        """Our model with every term of its beams kept."""
        system = our_c.keeping_all(self.subject.system)
        same = system == self.subject.system
        return self.ours if same else our_c.build(replace(self.subject, system=system))

    @cached_property
    def _everything_states(self) -> States:
        if self.everything is self.ours:
            return self.states
        return with_forces(self.everything, self.states, self._efforts)


def with_forces(engine: SymofrosEngine, states: States, efforts: int | None = None) -> States:
    """The states with our Q(q, v, u) and Q(q, v, 0): engines take forces, not formulas.

    Args:
        engine: Whose Q.
        states: Any.
        efforts: How many of the inputs are forces, which the passive Q goes without; None: all.
    """
    q, v, u = states.q, states.v, states.u
    force = engine.model.generalized_force
    motions = np.arange(u.shape[1]) >= (u.shape[1] if efforts is None else efforts)
    return replace(states, applied=force(q, v, u), passive=force(q, v, np.where(motions, u, 0.0)))


def has_formulas(system: sf.System) -> bool:
    """Whether a beam's shape functions are formulas of the user."""
    beams = [body for body in system.bodies if isinstance(body, sf.Beam)]
    shapes = [shape for beam in beams for _, own in beam.shapes for shape in own]
    return any(not isinstance(shape, sf.Samples) for shape in shapes)
