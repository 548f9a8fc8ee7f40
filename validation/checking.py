"""Cross-check one model: our C against every engine that can represent it, over the same states."""

from __future__ import annotations

import hashlib
import math
import time
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from importlib import import_module
from typing import Literal, cast

import symofros as sf

from . import references
from .adapters import ROUTES, compiled, in_order, route_of
from .adapters.charted import ChartedEngine
from .comparison.elements import judge_elements
from .comparison.errors import NOBODY, Comparison, Scales, compute, judge, raised, scaled_errors, typical_scales
from .comparison.loops import with_unique_multipliers
from .comparison.motion import MOTIONS, FreeMotion, fall, judge_drift, smoothness_obstacle
from .comparison.participants import EPS, Factories, Participant, participants, sum_of_energies, worst_condition
from .comparison.regular import (
    JACOBIAN,
    RegularStates,
    judge_omissions,
    judge_undefined,
    regular_states,
    unsampled_motion,
)
from .comparison.relations import Related, judge_relations
from .comparison.retained import judge_order, omitted_orders
from .comparison.variants import ModelVariants
from .contract.interface import NotOffered, States, Subject
from .contract.quantities import CONSTRAINED, FRAME_QUANTITIES, LOOPS, MOTION_ENERGY, QUANTITIES, Quantity
from .contract.raised import Raised, attempted, not_installed, words
from .inputs.frames import chosen_frames
from .inputs.sampling import DEFAULT_STATES, sample, special_states
from .mechanics.assembly import Assembly
from .mechanics.geometry import Array

FORWARD = "forward_dynamics"
# Quantities that come from solving a linear system, so that its condition limits their agreement.
SOLVED = (FORWARD, "multipliers", "constraint_force", "frame_response")


@dataclass(frozen=True)
class Settings:
    """What a check is asked to do.

    Attributes:
        states: Number of random states a model.
        seed: Seed of the states.
        engines: Names of the engines to compare with; None: all. None and no names at all ask our own questions, too:
            relations, derivatives, procedures.
        first: Number of the first state, where this is a part of a campaign. What does not depend on the number of
            states, free motions and orders of truncation, belongs to part 0.
    """

    states: int = DEFAULT_STATES
    seed: int = 0
    engines: tuple[str, ...] | None = None
    first: int = 0
    full: bool = False

    def routes(self) -> list[str]:
        """The engines asked for, in the order of reports."""
        return in_order(ROUTES if self.engines is None else self.engines)


@dataclass(frozen=True)
class ModelResult:
    """Outcome of the check of one model.

    Attributes:
        label: Name of the model in tables.
        comparisons: Comparisons, one a quantity and engine.
        hash: Hash of the description; empty if it could not be read.
        sizes: nq, nv, nu, bodies.
        frames: Frames at which frame quantities were compared.
        notes: Remarks on what reading the model dropped or changed.
        versions: Engine -> version.
        seconds: Stage or engine -> time it took [s].
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

    @property
    def compared(self) -> list[Comparison]:
        """The comparisons with a verdict on numbers."""
        return [row for row in self.comparisons if row.status in ("agree", "disagree")]


@dataclass(frozen=True)
class _Bench:
    """What all comparisons of one model share.

    Attributes:
        subject: The subject, its frames chosen.
        assembly: The same as numbers.
        settings: States, seed, engines.
        regular: The random states, sorted by what constraints can be compared at them.
        variants: Our models of the subject.
        engines: The engines that take part.
        scales: Typical sizes of M and T.
        condition: Factor by which solving for v' amplifies rounding; infinite where M is not positive definite by more
            than rounding.
        seconds: Stage -> time it took [s].
    """

    subject: Subject
    assembly: Assembly
    settings: Settings
    regular: RegularStates
    variants: ModelVariants
    engines: tuple[Participant, ...]
    scales: Scales
    condition: float
    seconds: dict[str, float]

    @property
    def label(self) -> str:
        """Name of the model in tables."""
        return self.subject.label

    @property
    def solvable(self) -> bool:
        """Whether M has an inverse in all states; a file's impossible inertias may leave it none."""
        return math.isfinite(self.condition)


def failed(label: str, stage: str, reason: str) -> ModelResult:
    """The result of a model that could not be compared."""
    return ModelResult(label, (Comparison(label, "symofros", stage, "failed", note=reason),))


def broken(label: str, error: BaseException) -> ModelResult:
    """The result of a model whose check raised an unexpected exception."""
    return failed(label, "check", words(error))


def absent(label: str, stage: str, error: BaseException) -> ModelResult | None:
    """The result of a model that needs a package which is not installed; None where the error says something else."""
    missing = not_installed(error)
    return ModelResult(label, (Comparison(label, "symofros", stage, "unsupported", note=missing),)) if missing else None


def check(subject: Subject, settings: Settings, factories: Factories | None = None) -> ModelResult:
    """Compare our C of a subject with every engine; factories of engines, by name, take the place of the adapters' own.

    Raises:
        SymofrosError: Our own model can't be made.
    """
    assembly = subject.assembly
    left_out = [*_events_left_out(subject.label, subject.system)]
    subject = replace(subject, system=_without_events(subject.system), frames=subject.frames or chosen_frames(assembly))
    obstacle = unsampled_motion(subject.system, assembly)
    if obstacle:
        return failed(subject.label, "compile", obstacle)
    start = time.perf_counter()
    model = compiled.build(subject)
    seconds = {"symofros": time.perf_counter() - start}
    sampled = sample(assembly, model.model.nu, settings.states, settings.seed, settings.first)
    if subject.system.constraints:
        regular = regular_states(model, sampled, special_states(settings.states, settings.first))
    else:
        regular = RegularStates(sampled, sampled[:0])
    omissions = judge_omissions(subject.label, regular)
    if not len(regular.states) and omissions is not None:
        return ModelResult(subject.label, (omissions,), description_hash(subject.system), seconds=seconds)
    variants = ModelVariants(subject, assembly, model, regular.states)
    answers = list(participants(assembly, variants, settings.routes(), factories or {}))
    engines = tuple(answer for answer in answers if isinstance(answer, Participant))
    scales, condition = typical_scales(model, variants.states), worst_condition(model, variants.states)
    bench = _Bench(subject, assembly, settings, regular, variants, engines, scales, condition, seconds)
    rows = [answer for answer in answers if isinstance(answer, Comparison)]
    rows += [omissions] if omissions is not None else []
    rows += [*left_out, *_comparisons(bench)]
    rows += _unconfirmed(bench, rows)
    return _result(bench, rows)


def _without_events(system: sf.System) -> sf.System:
    """The system as engines are asked about it: at states, and over motions in which nothing switches."""
    return replace(system, events={}) if system.events else system


def _events_left_out(label: str, system: sf.System) -> Iterator[Comparison]:
    if system.events:
        note = f"{', '.join(system.events)}: motions are compared without them, and without what they do"
        yield Comparison(label, "symofros", "events", "unsupported", note=note)


def _comparisons(bench: _Bench) -> Iterator[Comparison]:
    """All rows of one model's table but those of engines that can't represent it."""
    if not bench.solvable:
        reason = "M is not positive definite by more than rounding in some state, so v' is not determined;"
        reason += " are the inertias physical?"
        for name in (FORWARD, MOTION_ENERGY.name):
            yield Comparison(bench.label, "symofros", name, "unsupported", note=reason)
    for quantity in _quantities(bench):
        yield from _compared(bench, quantity)
    if bench.settings.first == 0:
        if bench.solvable and not bench.subject.system.constraints:
            yield from _free_motion(bench)
        for order in omitted_orders(bench.subject.system)[:1]:
            models = bench.variants.as_described, bench.variants.untruncated
            yield judge_order(bench.label, order, bench.assembly, *models, bench.variants.states)
        for one in bench.engines:
            rows = attempted(lambda one: list(judge_elements(one, bench.assembly, bench.variants)), one)
            yield from [raised(bench.label, one.name, "elements", rows)] if isinstance(rows, Raised) else rows
        if not bench.settings.engines:
            yield from _relations(bench)
            stated = references.MODELS.get(bench.label)
            if stated is not None and _without_events(stated) == bench.subject.system:
                yield from _by_formulas(bench, "procedures", bench.variants.states)


def _relations(bench: _Bench) -> Iterator[Comparison]:
    """What our program owes to those of other descriptions of the same mechanism, and derivatives to it."""
    start, variants = time.perf_counter(), bench.variants
    named = {one.name: one.engine for one in bench.engines if not one.route.independent}
    vectors = cast(compiled.SymofrosEngine | None, named.get("vectors"))
    closed = variants.assembled if bench.subject.system.constraints else variants.states
    yield from judge_relations(
        Related(
            bench.subject,
            bench.assembly,
            variants.as_described,
            closed if len(closed) else variants.states,
            bench.scales,
            bench.condition,
            variants.states,
            vectors,
            bench.settings.full,
        )
    )
    bench.seconds["relations"] = time.perf_counter() - start
    if not len(closed):
        yield Comparison(bench.label, "symofros", "derivatives", "unsupported", note="no state keeps the constraints")
    elif bench.solvable:
        yield from _by_formulas(bench, "derivatives", closed)


def _by_formulas(bench: _Bench, what: Literal["derivatives", "procedures"], closed: States) -> Iterator[Comparison]:
    """Comparisons with formulas: derivatives of every model; of reference models procedures, such as integrators."""
    start = time.perf_counter()
    label, system, assembly = bench.label, bench.subject.system, bench.assembly
    # SciPy's integrators take half a second to import, which other models do without.
    try:
        if what == "derivatives":
            module = import_module(".procedures.equations.derivatives", __package__)
            asked = module.Asked(label, system, assembly, closed, bench.condition, bench.settings.full)
            # What reads a file of its own states no derivatives that another route would not.
            engines = [one.engine for one in bench.engines if not one.route.reads]
            yield from module.judge_derivatives(asked, [one for one in engines if isinstance(one, ChartedEngine)])
        else:
            yield from import_module(".procedures.catalogue", __package__).judge_procedures(label, system, assembly)
    except ModuleNotFoundError as error:
        note = f"{error}; pip install 'symofros[validation]'"
        yield Comparison(label, "symofros", what, "unsupported", note=note)
    bench.seconds[what] = time.perf_counter() - start


def _quantities(bench: _Bench) -> list[Quantity]:
    absent = frozenset() if bench.subject.frames else FRAME_QUANTITIES
    if not bench.solvable:
        absent |= {*SOLVED}
    if not bench.subject.system.constraints:
        absent |= CONSTRAINED | LOOPS
    return [quantity for quantity in QUANTITIES.values() if quantity.name not in absent]


def _compared(bench: _Bench, quantity: Quantity) -> Iterator[Comparison]:
    """One quantity by every engine that offers it."""
    our_values: dict[tuple[int, bool, int], Array | Raised] = {}
    for one in bench.engines:
        if quantity.name not in one.engine.capabilities:
            continue
        states = one.states
        if one.route.loops and quantity.name == "multipliers":
            states = with_unique_multipliers(one.model, states)
            if not len(states):
                reason = "conditions repeat each other, so multipliers are not unique; compared: Gᵀ lam"
                yield Comparison(bench.label, one.name, quantity.name, "unsupported", note=reason)
                continue
        key = (id(one.model), one.route.loops, len(states))
        if key not in our_values:
            our_values[key] = attempted(compute, one.model, quantity, states)
            if isinstance(fault := our_values[key], Raised):
                yield raised(bench.label, "symofros", quantity.name, fault)
        ours = our_values[key]
        if not isinstance(ours, Raised):
            row = attempted(_compared_with, bench, one, quantity, ours, states)
            yield raised(bench.label, one.name, quantity.name, row) if isinstance(row, Raised) else row


def _compared_with(bench: _Bench, one: Participant, quantity: Quantity, ours: Array, states: States) -> Comparison:
    """One quantity by one engine."""
    try:
        row = _judged(bench, one, quantity, ours, states, bench.scales)
    except NotOffered as refusal:
        return Comparison(bench.label, one.name, quantity.name, "unsupported", note=str(refusal))
    if len(states) < len(bench.variants.states) and not row.note and not one.route.loops:
        asked = len(bench.variants.states)
        row = replace(row, note=f"the first {len(states)} of {asked} states: each takes long")
    if quantity.name == JACOBIAN.name:
        row = judge_undefined(bench.label, one.engine, bench.regular.undefined) or row
    return replace(row, extra={"condition": _condition(bench, one)}) if quantity.name == FORWARD else row


def _judged(
    bench: _Bench, one: Participant, quantity: Quantity, ours: Array, states: States, scales: Scales
) -> Comparison:
    errors, sizes = scaled_errors(quantity, ours, one.value(quantity, states), scales)
    quantity = one.held(quantity)
    row = judge(bench.label, one.name, quantity, errors, sizes=sizes)
    condition = _condition(bench, one)
    if quantity.name in SOLVED and not row.ok and EPS * condition > quantity.tolerance:
        # No solution in doubles is better than eps cond(M): where that is in the way, no more is asked for.
        note = f"condition {condition:.1e} allows no better"
        widened = replace(quantity, tolerance=EPS * condition)
        row = judge(bench.label, one.name, widened, errors, note, sizes)
    return row


def _condition(bench: _Bench, one: Participant) -> float:
    """The condition over the states that the engine is asked at."""
    return one.condition if one.route.loops else bench.condition


def _free_motion(bench: _Bench) -> Iterator[Comparison]:
    """A free motion from some of the random states: our drift, and the others' energies on the way."""
    start = time.perf_counter()
    last = slice(-MOTIONS, None)  # The first states are special.
    weightless = compiled.build_weightless(bench.subject)
    states = bench.variants.states
    motion = fall(bench.variants.as_described.model, states.q[last], states.v[last], weightless)
    bench.seconds["free motion"] = time.perf_counter() - start
    yield _drift(bench, motion)
    scales = replace(bench.scales, energy=motion.scale)
    for one in bench.engines:
        if {"kinetic_energy", "potential_energy"} <= one.engine.capabilities:
            row = attempted(_energies, bench, one, motion, scales)
            yield raised(bench.label, one.name, MOTION_ENERGY.name, row) if isinstance(row, Raised) else row


def _energies(bench: _Bench, one: Participant, motion: FreeMotion, scales: Scales) -> Comparison:
    """The energy along a free motion by one engine."""
    return _judged(bench, one, MOTION_ENERGY, sum_of_energies(one.model, motion.states), motion.states, scales)


def _drift(bench: _Bench, motion: FreeMotion) -> Comparison:
    reason = ""
    for order in omitted_orders(bench.subject.system)[:1]:
        reason = f"beams of {order.replace('_', ' ')} conserve energy only up to the terms they leave out"
    reason = reason or smoothness_obstacle([described.joint for described in bench.assembly.joints])
    if reason:
        return Comparison(bench.label, "symofros", "energy_drift", "unsupported", note=reason)
    return judge_drift(bench.label, motion)


def _unconfirmed(bench: _Bench, rows: list[Comparison]) -> Iterator[Comparison]:
    """A failure if no independent engine was compared: agreement with nobody confirms nothing."""
    independent = {name for name in bench.settings.routes() if route_of(name).independent}
    compared = {row.engine for row in rows if row.status in ("agree", "disagree")}
    if independent and not independent & compared:
        reason = f"none of {', '.join(sorted(independent))} could be asked"
        yield Comparison(bench.label, NOBODY, "all", "failed", note=reason)


def _result(bench: _Bench, rows: list[Comparison]) -> ModelResult:
    model, system = bench.variants.as_described.model, bench.subject.system
    return ModelResult(
        bench.label,
        tuple(rows),
        description_hash(system),
        {"nq": model.nq, "nv": model.nv, "nu": model.nu, "bodies": len(system.bodies)},
        bench.subject.frames,
        system.notes,
        {one.name: one.engine.version for one in bench.engines},
        bench.seconds | {one.name: one.seconds for one in bench.engines},
    )


def description_hash(system: sf.System) -> str:
    """Identity of a description: its dataclasses print every field in order; where it came from does not count."""
    return hashlib.sha256(repr(replace(system, notes=(), origin={})).encode()).hexdigest()[:16]
