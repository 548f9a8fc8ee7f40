"""Cross-check one model: our C against every engine that can represent it, over the same states."""

from __future__ import annotations

import hashlib
import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property, partial
from typing import cast

import numpy as np

import symofros as sf
from validation.adapters import ROUTES, Missing, available, rotors
from validation.adapters import compiled as our_c
from validation.adapters.closed import ConstrainedEngine, condition, joined_frames, of_clear_rank
from validation.adapters.compiled import SymofrosEngine
from validation.comparison.errors import Comparison, Scales, compute, judge, scaled_errors, typical_scales
from validation.comparison.loops import of_unique_multipliers
from validation.comparison.motion import MOTIONS, Motion, fall, judge_drift
from validation.comparison.retained import judge_order, left_out
from validation.comparison.sides import Sides
from validation.contract.interface import Engine, EngineFactory, States, Subject, TreeEngine, Unsupported
from validation.contract.quantities import CONSTRAINED, FRAME_QUANTITIES, LOOPS, MOTION_ENERGY, QUANTITIES, Quantity
from validation.inputs.frames import chosen_frames
from validation.inputs.sampling import DEFAULT_STATES, sample
from validation.mechanics.assembly import Assembly, assemble
from validation.mechanics.geometry import Array

FORWARD = "forward_dynamics"
SOLVED = (FORWARD, "multipliers", "constraint_force", "frame_response")

EPS = 2.0**-52

Factories = dict[str, EngineFactory | Missing]

# A motor, friction or contact model with a corner in it makes any integrator lose its order, and says nothing of us.
_CORNERS = frozenset({"sign", "abs", "min", "max"})


@dataclass(frozen=True)
class Settings:
    """What a check is asked to do.

    Attributes:
        states: Random states a model.
        seed: Of the states.
        engines: Names of the engines to compare with; None: all.
        first: Number of the first state, where this is a part of a campaign. What does not depend on the number of
            states, free motions and orders of truncation, belongs to part 0.
    """

    states: int = DEFAULT_STATES
    seed: int = 0
    engines: tuple[str, ...] | None = None
    first: int = 0

    def routes(self) -> list[str]:
        """The engines asked for, in the order of reports."""
        return [name for name in ROUTES if self.engines is None or name in self.engines]


@dataclass(frozen=True)
class ModelResult:
    """Everything found about one model.

    Attributes:
        label: What the model is called in tables.
        comparisons: One a quantity and engine.
        hash: Of the description; empty if it could not be read.
        sizes: nq, nv, nu, bodies.
        frames: Where frame quantities were compared.
        notes: What reading the model dropped or changed.
        versions: Engine -> version.
        seconds: Stage or engine -> time it took.
    """

    label: str
    comparisons: tuple[Comparison, ...]
    hash: str = ""
    sizes: dict[str, int] = field(default_factory=dict)
    frames: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    versions: dict[str, str] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)

    @property
    def ok(self) -> bool:
        """Whether nothing disagrees or failed."""
        return all(comparison.ok for comparison in self.comparisons)


def failed(label: str, stage: str, reason: str) -> ModelResult:
    """The result of a model that could not be compared."""
    return ModelResult(label, (Comparison(label, "symofros", stage, "failed", note=reason),))


def check(subject: Subject, settings: Settings, factories: Factories | None = None) -> ModelResult:
    """Compare our C of a subject with every engine.

    Args:
        subject: The model.
        settings: States, seed, engines.
        factories: The engines to choose from; those that import here if not given.

    Raises:
        SymofrosError: Our own model can't be made.
    """
    return _Check(subject, settings, available() if factories is None else factories).run()


class _Check:
    def __init__(self, subject: Subject, settings: Settings, factories: Factories) -> None:
        self.settings = settings
        self.factories = factories
        self.assembly: Assembly = assemble(subject.system)
        self.subject = replace(subject, frames=subject.frames or chosen_frames(self.assembly))
        self.seconds: dict[str, float] = {}
        self.rows: list[Comparison] = []

    def run(self) -> ModelResult:
        obstacle = self._unsampled_motion()
        if obstacle:
            return failed(self.subject.label, "compile", obstacle)
        start = time.perf_counter()
        self.ours = our_c.build(self.subject)
        self.seconds["symofros"] = time.perf_counter() - start
        asked = self.settings
        sampled = sample(self.assembly, self.ours.model.nu, asked.states, asked.seed, asked.first)
        if self.subject.system.constraints:
            sampled = regular(self.ours, sampled)
        self.sides = Sides(self.subject, self.assembly, self.ours, sampled)
        self.states = self.sides.states
        self.scales = typical_scales(self.ours, self.states)
        self.condition = worst_condition(self.ours, self.states)
        engines = list(self._engines())
        if not self._can_be_solved():
            reason = "M is not positive definite in some state, so v' is not determined; are the inertias physical?"
            for name in (FORWARD, MOTION_ENERGY.name):
                self.rows.append(Comparison(self.subject.label, "symofros", name, "unsupported", note=reason))
        for quantity in self._quantities():
            self._compare(quantity, engines)
        if asked.first == 0:
            if self._can_be_solved() and not self.subject.system.constraints:
                self._fall(engines)
            self._retained()
        self._second_opinion()
        return self._result(engines)

    def _has_beams(self) -> bool:
        return any(isinstance(body, sf.Beam) for body in self.subject.system.bodies)

    def _unsampled_motion(self) -> str:
        """What keeps a system with a prescribed motion from being compared; that is not agreement."""
        driven = self.assembly.driven_joints
        if driven and not self._has_beams():
            return f"joint '{driven[0].name}': a prescribed motion, which no engine for rigid bodies can represent"
        for joint in driven:
            if joint.kind in ("ball", "free"):
                return f"joint '{joint.name}': a prescribed motion with a quaternion, which the states do not have"
        formulas = [item for item in self.subject.system.constraints if isinstance(item, sf.Nonholonomic)]
        if driven and formulas:
            return f"joint '{driven[0].name}': a prescribed motion beside a condition on speeds by formula"
        return ""

    def _engines(self) -> Iterator[Engine]:
        for name in self.settings.routes():
            route = ROUTES[name]
            if (route.reads and route.reads != self.subject.format) or (route.beams and not self._has_beams()):
                continue
            if route.loops and not self.subject.system.constraints:
                continue
            factory = self.factories[name]
            engine = Unsupported(factory.reason) if isinstance(factory, Missing) else self._build(name, factory)
            if isinstance(engine, Unsupported):
                self.rows.append(Comparison(self.subject.label, name, "all", "unsupported", note=engine.reason))
            else:
                self.seconds[name] = 0.0
                yield engine

    def _build(self, name: str, factory: EngineFactory) -> Engine | Unsupported:
        """The engine; one that knows trees gets rotors from a second model of its own, and constraints in NumPy."""
        independent = ROUTES[name].independent
        if ROUTES[name].loops:
            return self._closing(factory(self.subject))
        if independent and rotors.has_rotors(self.subject.system):
            factory = partial(rotors.build, factory)
        engine = factory(self.subject)
        if isinstance(engine, Unsupported) or not self.subject.system.constraints or not independent:
            return engine
        joined = joined_frames(self.assembly, self.subject.system)
        anchored = factory(replace(self.subject, frames=joined))
        # Every independent engine knows trees; the protocol of engines does not say so.
        return ConstrainedEngine(cast(TreeEngine, engine), cast(TreeEngine, anchored), self.subject, joined)

    def _closing(self, engine: Engine | Unsupported) -> Engine | Unsupported:
        """An engine that closes loops needs states where they are closed."""
        if isinstance(engine, Unsupported) or len(self.sides.assembled):
            return engine
        return Unsupported("no random state leads to a posture that keeps the constraints")

    def _quantities(self) -> list[Quantity]:
        left_out = (frozenset() if self.subject.frames else FRAME_QUANTITIES) | (
            frozenset() if self._can_be_solved() else {FORWARD}
        )
        if not self.subject.system.constraints:
            left_out |= CONSTRAINED | LOOPS
        return [q for q in QUANTITIES.values() if q.name not in left_out]

    def _can_be_solved(self) -> bool:
        """Whether M has an inverse in all states; a file's impossible inertias may leave it none."""
        return math.isfinite(self.condition)

    def _compare(self, quantity: Quantity, engines: Sequence[Engine]) -> None:
        sides: dict[tuple[int, bool, int], Array] = {}
        for engine in engines:
            if quantity.name not in engine.capabilities:
                continue
            side, states, loops = self.sides.of(engine), self.sides.states_of(engine), ROUTES[engine.name].loops
            if loops and quantity.name == "multipliers":
                states = of_unique_multipliers(side, states)
                if not len(states):
                    reason = "conditions repeat each other, so multipliers are not unique; compared: Gᵀ lam"
                    row = Comparison(self.subject.label, engine.name, quantity.name, "unsupported", note=reason)
                    self.rows.append(row)
                    continue
            key = (id(side), loops, len(states))
            if key not in sides:
                sides[key] = compute(side, quantity, states)
            row = self._judged(engine, quantity, sides[key], states, self.scales)
            if len(states) < len(self.states) and not row.note and not loops:
                row = replace(row, note=f"the first {len(states)} of {len(self.states)} states: each takes long")
            extra = {"condition": self._condition_of(engine)}
            self.rows.append(replace(row, extra=extra) if quantity.name == FORWARD else row)

    def _judged(self, engine: Engine, quantity: Quantity, ours: Array, states: States, scales: Scales) -> Comparison:
        start = time.perf_counter()
        reference = self._value(engine, quantity, states)
        self.seconds[engine.name] += time.perf_counter() - start
        quantity = replace(quantity, tolerance=max(quantity.tolerance, self.sides.tolerance(engine)))
        errors, sizes = scaled_errors(quantity, ours, reference, scales)
        row = judge(self.subject.label, engine.name, quantity, errors, sizes=sizes)
        condition = self._condition_of(engine)
        if quantity.name in SOLVED and not row.ok and EPS * condition > quantity.tolerance:
            # No solution in doubles is better than eps cond(M): where that is in the way, no more is asked for.
            note = f"condition {condition:.1e} allows no better"
            widened = replace(quantity, tolerance=EPS * condition)
            row = judge(self.subject.label, engine.name, widened, errors, note, sizes)
        return row

    def _condition_of(self, engine: Engine) -> float:
        """Over the states that the engine is asked at."""
        return self._closed_condition if ROUTES[engine.name].loops else self.condition

    @cached_property
    def _closed_condition(self) -> float:
        return worst_condition(self.ours, self.sides.assembled)

    @staticmethod
    def _value(engine: Engine, quantity: Quantity, states: States) -> Array:
        if quantity is not MOTION_ENERGY:
            return compute(engine, quantity, states)
        return sum_of_energies(engine, states)

    def _fall(self, engines: Sequence[Engine]) -> None:
        """A free motion from some of the random states: our drift, and the others' energies on the way."""
        start = time.perf_counter()
        first = slice(-MOTIONS, None)  # The last states: the first ones are special.
        weightless = our_c.build_weightless(self.subject)
        motion = fall(self.ours.model, self.states.q[first], self.states.v[first], weightless)
        self.seconds["free motion"] = time.perf_counter() - start
        self.rows.append(self._drift(motion))
        scales = replace(self.scales, energy=motion.scale)
        for engine in engines:
            if {"kinetic_energy", "potential_energy"} <= engine.capabilities:
                ours = sum_of_energies(self.sides.of(engine), motion.states)
                self.rows.append(self._judged(engine, MOTION_ENERGY, ours, motion.states, scales))

    def _drift(self, motion: Motion) -> Comparison:
        for order in left_out(self.subject.system):
            reason = f"beams of {order.replace('_', ' ')} conserve energy only up to the terms they leave out"
            return Comparison(self.subject.label, "symofros", "energy_drift", "unsupported", note=reason)
        joints = [described.joint for described in self.assembly.joints]
        used = sorted({kind for joint in joints for formula in joint.effort for kind in kinds(formula)} & _CORNERS)
        bent = sorted({corner for joint in joints for item in joint.elements if (corner := _corner(item))})
        if used or bent:
            where = f"an effort uses {', '.join(used)}" if used else f"a joint has {', '.join(bent)}"
            reason = f"{where}: no integrator keeps its order across a corner"
            return Comparison(self.subject.label, "symofros", "energy_drift", "unsupported", note=reason)
        return judge_drift(self.subject.label, motion)

    def _retained(self) -> None:
        """What ties a model whose beams leave terms out to the one that engines for beams are compared with."""
        for order in left_out(self.subject.system)[:1]:
            everything = self.sides.everything
            row = judge_order(self.subject.label, order, self.assembly, self.ours, everything, self.states)
            self.rows.append(row)

    def _second_opinion(self) -> None:
        """Agreement with nobody is no agreement."""
        independent = {name for name in self.settings.routes() if ROUTES[name].independent}
        compared = {row.engine for row in self.rows if row.status in ("agree", "disagree")}
        if independent and not independent & compared:
            reason = f"none of {', '.join(sorted(independent))} could be asked; see why above"
            self.rows.append(Comparison(self.subject.label, "any", "all", "failed", note=reason))

    def _result(self, engines: Sequence[Engine]) -> ModelResult:
        model, system = self.ours.model, self.subject.system
        return ModelResult(
            self.subject.label,
            tuple(self.rows),
            description_hash(system),
            {"nq": model.nq, "nv": model.nv, "nu": model.nu, "bodies": len(system.bodies)},
            self.subject.frames,
            system.notes,
            {engine.name: engine.version for engine in engines},
            self.seconds,
        )


def _corner(element: object) -> str:
    """What bends a joint element's force: a corner or, in dry friction, one that is rounded within a step."""
    if isinstance(element, sf.Damper):
        return "a quadratic damper" if element.quadratic != 0.0 else ""
    return {sf.Stop: "a stop", sf.Friction: "dry friction"}.get(type(element), "")


def sum_of_energies(engine: Engine, states: States) -> Array:
    """T + V (N,) [J]."""
    return compute(engine, QUANTITIES["kinetic_energy"], states) + compute(
        engine, QUANTITIES["potential_energy"], states
    )


def regular(engine: SymofrosEngine, states: States) -> States:
    """The states where constraints have a Jacobian of clear rank: a disc that lies flat has no lowest point."""
    sound = of_clear_rank(compute(engine, QUANTITIES["mass_matrix"], states), engine.constraint_jacobian(states))
    return States(*(getattr(states, item.name)[sound] for item in fields(States)))


def worst_condition(engine: SymofrosEngine, states: States) -> float:
    """By how much solving for v' amplifies rounding: the largest condition number of M, and of multipliers."""
    M = compute(engine, QUANTITIES["mass_matrix"], states)
    moments = np.linalg.eigvalsh(M)
    smallest, largest = moments[:, 0], moments[:, -1]
    worst = float(np.max(np.where(smallest > 0.0, largest / np.where(smallest > 0.0, smallest, 1.0), np.inf)))
    if engine.model.nc and np.isfinite(worst):
        worst *= condition(M, engine.constraint_jacobian(states))
    return worst


def kinds(formula: sf.Expression | float) -> frozenset[str]:
    """The operations a formula uses."""
    if not isinstance(formula, sf.Expression):
        return frozenset()
    return frozenset({formula.kind}).union(*(kinds(arg) for arg in formula.args))


def description_hash(system: sf.System) -> str:
    """Identity of a description: its dataclasses print every field in order; where it came from does not count."""
    return hashlib.sha256(repr(replace(system, notes=(), origin={})).encode()).hexdigest()[:16]
