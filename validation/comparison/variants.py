"""Our models of one subject: each engine is compared with the one that states the same problem as it solves."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from ..adapters import Route, compiled, interpreted
from ..adapters.compiled import SymofrosEngine
from ..contract.interface import States, Subject
from ..mechanics.assembly import Assembly
from .loops import assembled_states


class ModelVariants:
    """Our models of one subject and the states that each is evaluated at, made when they are first asked for.

    Args:
        subject: The subject of the check.
        assembly: The same as numbers.
        model: Our model of the description as it stands.
        states: States without forces.

    Attributes:
        as_described: The model given.
        states: States with its forces (N).
    """

    def __init__(self, subject: Subject, assembly: Assembly, model: SymofrosEngine, states: States) -> None:
        self.subject, self.as_described = subject, model
        self._efforts = len(subject.system.inputs) + assembly.motors
        self.states = with_forces(model, states, self._efforts)

    def model_for(self, route: Route) -> SymofrosEngine:
        """The variant that the engine of a route is compared with."""
        model: SymofrosEngine = getattr(self, route.variant)
        return model

    def states_for(self, route: Route) -> States:
        """The states that the engine of a route is asked at, with the forces of the variant it is compared with."""
        if route.loops:
            return self.assembled
        if not route.beams:
            return self.states
        exact = self.model_for(route) is not self.untruncated
        return self._without_rotary_states if exact else self._untruncated_states

    @cached_property
    def assembled(self) -> States:
        """States that satisfy the constraints, with their forces."""
        return with_forces(self.as_described, assembled_states(self.subject.system, self.states), self._efforts)

    @cached_property
    def verbatim(self) -> SymofrosEngine:
        """Our model of the file's every digit, for engines that read the file themselves."""
        same = self.subject.verbatim == self.subject.system
        return self.as_described if same else compiled.build_verbatim(self.subject)

    @cached_property
    def untruncated(self) -> SymofrosEngine:
        """Our model with every term of its beams, for engines that keep them all."""
        system = compiled.untruncated(self.subject.system)
        same = system == self.subject.system
        if same:
            return self.as_described
        return compiled.build(replace(self.subject, system=system), compiled.UNOPTIMISED)

    @cached_property
    def without_rotary(self) -> SymofrosEngine:
        """The untruncated model without rotary inertia, for engines whose sections turn exactly.

        Rods have more sections than stated, and come by the interpreter: C of so many takes long to compile.
        """
        system = compiled.without_rotary(self.subject.system)
        if system == compiled.untruncated(self.subject.system):
            return self.untruncated
        subject = replace(self.subject, system=system)
        finer = any(beam.elastic.is_exact for beam in system.beams)
        return interpreted.build(subject) if finer else compiled.build(subject, compiled.UNOPTIMISED)

    @cached_property
    def _without_rotary_states(self) -> States:
        # Rotary inertia makes no forces of Q; loads along a rod do by its sections, of which this variant has more.
        return with_forces(self.without_rotary, self.states, self._efforts)

    @cached_property
    def _untruncated_states(self) -> States:
        if self.untruncated is self.as_described:
            return self.states
        return with_forces(self.untruncated, self.states, self._efforts)


def with_forces(model: SymofrosEngine, states: States, efforts: int | None = None) -> States:
    """The states with Q(q, v, u) and Q(q, v, 0) of a model: engines take forces, not formulas.

    Args:
        model: The model that states Q.
        states: States, with any forces.
        efforts: Number of inputs that are forces, which are zero in the passive Q; None: all.
    """
    q, v, u = states.q, states.v, states.u
    force = model.model.generalized_force
    motions = np.arange(u.shape[1]) >= (u.shape[1] if efforts is None else efforts)
    return replace(states, applied=force(q, v, u), passive=force(q, v, np.where(motions, u, 0.0)))
