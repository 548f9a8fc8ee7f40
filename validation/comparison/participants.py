"""The engines that take part in the check of one model, each with the model of ours that it is compared with."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import cast

import numpy as np

from ..adapters import Missing, Route, factory_of, rotors, route_of
from ..adapters.closed import ConstrainedEngine, condition, engaged, joined_frames
from ..adapters.compiled import SymofrosEngine
from ..contract.interface import Engine, EngineFactory, States, Subject, TreeEngine, Unsupported
from ..contract.quantities import MOTION_ENERGY, QUANTITIES, Quantity
from ..contract.raised import Raised, attempted
from ..mechanics.assembly import Assembly
from ..mechanics.geometry import Array
from .errors import Comparison, compute, raised
from .variants import ModelVariants

# What constraints are made of, for engines that know trees.
ANCHORED = frozenset({"frame_pose", "frame_velocity", "frame_acceleration", "frame_jacobian"})

EPS = 2.0**-52

Factories = Mapping[str, EngineFactory | Missing]


@dataclass
class Participant:
    """One engine in the check of one model.

    Attributes:
        engine: The engine's model of the subject.
        route: The way it was reached.
        model: Our model that it is compared with.
        states: States that it is asked at, with the forces of that model.
        seconds: Time that its answers took [s].
    """

    engine: Engine
    route: Route
    model: SymofrosEngine
    states: States
    seconds: float = field(default=0.0)

    @property
    def name(self) -> str:
        """Name of the engine in tables."""
        return self.engine.name

    @cached_property
    def condition(self) -> float:
        """Factor by which solving for v' amplifies rounding at the engine's states."""
        return worst_condition(self.model, self.states)

    def held(self, quantity: Quantity) -> Quantity:
        """A quantity with the tolerance that the engine is held to, where it is not exact."""
        accuracy: Mapping[str, float] = getattr(self.engine, "accuracy", {})
        return replace(quantity, tolerance=max(quantity.tolerance, accuracy.get(quantity.name, 0.0)))

    def value(self, quantity: Quantity, states: States) -> Array:
        """The engine's results for a quantity (N, ...), timed."""
        start = time.perf_counter()
        motion = quantity.name == MOTION_ENERGY.name
        result = sum_of_energies(self.engine, states) if motion else compute(self.engine, quantity, states)
        self.seconds += time.perf_counter() - start
        return result


def participants(
    assembly: Assembly, variants: ModelVariants, names: Sequence[str], factories: Factories
) -> Iterator[Participant | Comparison]:
    """Every engine that can represent a subject; a row of the table for each that can't, or whose adapter raises."""
    subject = variants.subject
    for name in names:
        route = route_of(name)
        if not route.applies_to(subject):
            continue
        engine = attempted(_built, route, factory_of(name, factories), subject, assembly)
        if isinstance(engine, Raised):
            yield raised(subject.label, name, "all", engine)
            continue
        if route.loops and not isinstance(engine, Unsupported) and not len(variants.assembled):
            engine = Unsupported("no random state leads to a posture that keeps the constraints")
        if isinstance(engine, Unsupported):
            yield Comparison(subject.label, name, "all", "unsupported", note=engine.reason)
            continue
        states = variants.states_for(route)
        affordable = states[: getattr(engine, "most_states", len(states))]
        yield Participant(engine, route, variants.model_for(route), affordable)


def _built(
    route: Route, factory: EngineFactory | Missing, subject: Subject, assembly: Assembly
) -> Engine | Unsupported:
    """The engine; one that knows trees gets rotors from a second model of its own, and constraints in NumPy."""
    if isinstance(factory, Missing):
        return Unsupported(factory.reason)
    loose = [item.name for item in subject.system.constraints if not engaged(subject.system, item.name)]
    if route.loops and loose:
        return Unsupported(
            f"constraint '{loose[0]}': released by its switch, which engines that close loops do not know"
        )
    if route.loops or not route.independent:
        return factory(subject)
    if rotors.has_rotors(subject.system):
        factory = partial(rotors.build, factory)
    engine = factory(subject)
    if isinstance(engine, Unsupported) or not subject.system.constraints:
        return engine
    if not ANCHORED <= engine.capabilities:
        return Unsupported("no kinematics of frames, which constraints are stated by")
    joined = joined_frames(assembly, subject.system)
    anchored = factory(replace(subject, frames=joined))
    # Every independent engine knows trees; the protocol of engines does not say so.
    return ConstrainedEngine(cast(TreeEngine, engine), cast(TreeEngine, anchored), subject, joined)


def sum_of_energies(engine: Engine, states: States) -> Array:
    """T + V (N,) [J]."""
    return compute(engine, QUANTITIES["kinetic_energy"], states) + compute(
        engine, QUANTITIES["potential_energy"], states
    )


def worst_condition(model: SymofrosEngine, states: States) -> float:
    """Factor by which solving for v' amplifies rounding: the largest condition number of M, and of multipliers.

    Infinite where M is not positive definite, or not by more than rounding: the sign of an eigenvalue that small is
    chance, and of v' no digit is determined.
    """
    M = compute(model, QUANTITIES["mass_matrix"], states)
    moments = np.linalg.eigvalsh(M)
    smallest, largest = moments[:, 0], moments[:, -1]
    definite = smallest > M.shape[-1] * EPS * largest
    worst = float(np.max(np.where(definite, largest / np.where(definite, smallest, 1.0), np.inf)))
    if model.model.nc and np.isfinite(worst):
        worst *= condition(M, model.constraint_jacobian(states))
    return worst
