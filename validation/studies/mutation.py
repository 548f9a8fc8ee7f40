"""Can the harness fail? Single faults are planted in generated programs; the cross-check must catch each that matters.

A fault is *caught* if some output differs from an independent engine's by more than the cross-check's tolerance, over
the same kind of states. A fault that is not caught is *silent* if the program with it computes the same outputs to
many digits, so that there is nothing to catch. It is *too small* if it changes every output by less than the
tolerance: a robot's file may hold an inertia of which a millionth is less than rounding is allowed to be. Anything else
has *survived*: the harness should have seen it, and did not.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated, Any

import mpmath
import numpy as np
import typer

import symofros as sf
from symofros.tools import Function, evaluate_edges, evaluate_precisely

from .. import references
from ..adapters import ROUTES, Missing, description
from ..adapters.interpreted import build as interpreted
from ..comparison.errors import Scales, compute, state_errors, typical_scales
from ..comparison.variants import with_forces
from ..contract.interface import Engine, States, Subject, Unsupported
from ..contract.quantities import FORCES_STATED, FRAME_QUANTITIES, QUANTITIES, Quantity
from ..inputs.cases import standard_set
from ..inputs.frames import chosen_frames
from ..inputs.sampling import sample
from ..mechanics.geometry import Array
from ..reporting.command import Run
from ..reporting.numbers import counted
from ..reporting.record import Bullets, Data, Fact, Report, Section, Table, Topic, verdict
from .faults import Fault, FaultSimulator, faults_at

STATES = 60
# Outputs that agree to this many of DIGITS digits at random points are equal.
DIGITS, EQUAL = 60, 40
PROOF_POINTS = 2
# Models that an independent engine can represent whole, small and large, fixed and floating.
MODELS = tuple(
    "pendulum double_pendulum cart_pole open_chain_5r space_arm rx90 chain7 mss ur5 panda solo12 bolt".split()
)
PER_MODEL = 700
FATES = ("planted", "caught", "silent", "too_small")


@dataclass(frozen=True)
class MutationScore:
    """What became of the faults planted in one model.

    Attributes:
        model: Its label.
        engine: Whose results were the reference.
        planted: Faults by kind; likewise those caught, silent and too small.
        survivors: Faults that should have been caught, with the largest relative change they made.
        largest_small: The largest relative change among those that are too small.
    """

    model: str
    engine: str
    planted: Counter[str] = field(default_factory=Counter)
    caught: Counter[str] = field(default_factory=Counter)
    silent: Counter[str] = field(default_factory=Counter)
    too_small: Counter[str] = field(default_factory=Counter)
    largest_small: float = 0.0
    survivors: tuple[tuple[Fault, float], ...] = ()

    @property
    def ok(self) -> bool:
        """Whether every fault that matters was caught."""
        return not self.survivors and sum(self.planted.values()) > 0


def mutate(label: str, system: sf.System, count: int, seed: int = 0) -> MutationScore:
    """Plant faults in one model.

    Args:
        label: For the report.
        system: The model.
        count: How many faults, drawn from all that are possible.
        seed: Seed of the draw and of the states.

    Raises:
        ValueError: No independent engine can represent the model.
    """
    harness = _Harness(Subject(label, system), seed)
    return harness.run(count)


class _Harness:
    def __init__(self, subject: Subject, seed: int) -> None:
        assembly = subject.assembly
        # One frame at a tip stands for all: faults in others would be the same faults.
        self.subject = replace(subject, frames=chosen_frames(assembly)[:1])
        self.rng = np.random.default_rng(seed)
        ours = interpreted(self.subject)
        self.states = with_forces(ours, sample(assembly, ours.model.nu, STATES, seed))
        self.scales: Scales = typical_scales(ours, self.states)
        self.engine = _independent(self.subject)
        results = self._results()
        # What nobody can judge is not part of the test: a fault there would neither be caught nor be silent.
        self.program = sf.program_of(subject.system, results, self.subject.frames)
        self.simulator = FaultSimulator(self.program, self._inputs(self.states, ours.model))
        self.reference = {function: results[function.name] for function in self.program.functions}

    def _results(self) -> dict[str, tuple[Quantity, Array]]:
        """Results per function: forces from the description's own formulas, all else from the engine."""
        forces = description.build(self.subject)
        results = {}
        for quantity in QUANTITIES.values():
            source = forces if quantity.name in FORCES_STATED else self.engine
            offered = not isinstance(source, Unsupported) and quantity.name in source.capabilities
            if offered and not quantity.at_rest:
                assert not isinstance(source, Unsupported)
                results[quantity.name] = (quantity, compute(source, quantity, self.states))
        return results

    def _inputs(self, states: States, model: sf.Model) -> dict[str, Array]:
        par = np.array([list(model.parameters.values())]).reshape(1, -1)
        groups = {"q": states.q, "v": states.v, "a": states.a, "u": states.u, "par": par}
        groups |= {"t": np.zeros((len(states), 1)), "lam": np.zeros((len(states), model.nc))}
        init = evaluate_edges(self.program, self.program.init, groups, {}) if self.program.init else []
        pre = np.array([float(np.asarray(x).ravel()[0]) for x in init])
        return {**groups, "pre": np.broadcast_to(pre, (len(states), len(init)))}

    def run(self, count: int) -> MutationScore:
        graph, sizes = self.program.graph, self.program.sizes
        everything = [fault for node in self.simulator.nodes for fault in faults_at(graph, node, sizes, self.rng)]
        chosen = self.rng.permutation(len(everything))[:count]
        score = MutationScore(self.subject.label, self.engine.name)
        survivors: list[tuple[Fault, float]] = []
        largest_small = 0.0
        sound = {f: _as_compared(f, self.simulator.outputs(f)) for f in self.program.functions}
        references = {f: reference for f, (_, reference) in self.reference.items()}
        for index in chosen:
            fault = everything[index]
            score.planted[fault.kind] += 1
            if not self._against(fault, references)[1]:
                score.caught[fault.kind] += 1
                continue
            change, is_small = self._against(fault, sound)
            if self._is_silent(fault):
                score.silent[fault.kind] += 1
            elif is_small:
                score.too_small[fault.kind] += 1
                largest_small = max(largest_small, change)
            else:
                survivors.append((fault, change))
        return replace(score, survivors=tuple(survivors), largest_small=largest_small)

    def _against(self, fault: Fault, references: Mapping[Function, Array]) -> tuple[float, bool]:
        """The largest relative difference of a faulty program's outputs, and whether all are within tolerance."""
        touched, outputs = self.simulator.affected(fault)
        worst, within = 0.0, True
        for function in touched:
            quantity, value = self.reference[function][0], _as_compared(function, outputs(function))
            errors = state_errors(quantity, value, references[function], self.scales)
            largest = float(np.max(np.where(np.isfinite(errors), errors, np.inf)))
            worst, within = max(worst, largest), within and largest <= quantity.tolerance
        return worst, within

    def _is_silent(self, fault: Fault) -> bool:
        """Whether the mutant computes the same to many digits, at points where doubles play no part."""
        mutant = self.simulator.mutant(fault)
        touched, _ = self.simulator.affected(fault)
        for point in range(PROOF_POINTS):
            inputs = self._exact_inputs(point)
            for function in touched:
                sound = evaluate_precisely(self.program, function, inputs, DIGITS)
                faulty = evaluate_precisely(mutant, function, inputs, DIGITS)
                if not _equal(sound, faulty):
                    return False
        return True

    def _exact_inputs(self, point: int) -> Mapping[str, list[mpmath.mpf]]:
        return {
            name: [mpmath.mpf(float(x)) for x in values[-1 - point if len(values) > 1 else 0]]
            for name, values in self.simulator.inputs.items()
        }


def _as_compared(function: Function, outputs: list[Array]) -> Array:
    """A function's outputs as the engines return them: a pose as twelve numbers, frames stacked."""
    if function.name == "frame_pose":
        p, R = outputs
        return np.concatenate([p, R.reshape(len(R), 9)], axis=1)[:, None]
    return outputs[0][:, None] if function.name in FRAME_QUANTITIES else outputs[0]


def _equal(sound: list[list[mpmath.mpf]], faulty: list[list[mpmath.mpf]]) -> bool:
    def close(one: list[mpmath.mpf], other: list[mpmath.mpf]) -> bool:
        scale = max((abs(x) for x in one), default=mpmath.mpf(1)) or mpmath.mpf(1)
        return all(abs(x - y) <= scale * mpmath.mpf(10) ** -EQUAL for x, y in zip(one, other, strict=True))

    with mpmath.workdps(DIGITS):
        return all(map(close, sound, faulty))


def _independent(subject: Subject) -> Engine:
    """The first independent engine that can represent a model."""
    reasons = []
    for name, route in ROUTES.items():
        if not route.independent or route.reads:
            continue
        factory = route.load()
        if isinstance(factory, Missing):
            continue
        engine = factory(subject)
        if not isinstance(engine, Unsupported):
            return engine
        reasons.append(f"{name}: {engine.reason}")
    raise ValueError(f"model '{subject.label}': no independent engine for it ({'; '.join(reasons)})")


def measure(
    run: Run,
    faults: Annotated[int, typer.Option(min=1, help="Faults a model, at most.")] = PER_MODEL,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the choice of faults and of the states.")] = 0,
) -> Data:
    """Plant single faults in generated programs; the cross-check must catch every one that matters."""
    cases = {case.label: case for case in standard_set()}
    scores = []
    run.expect(len(MODELS), "planting faults")
    for name in MODELS:
        system = cases[name].load().system if name in cases else references.MODELS[name]
        scores.append(mutate(name, system, faults, seed))
        run.advance()
    return as_data(scores) | {"faults_per_model": faults, "seed": seed}


def as_data(scores: Sequence[MutationScore]) -> dict[str, Any]:
    """The scores as plain data."""
    rows = [
        {
            "model": score.model,
            "engine": score.engine,
            **{fate: getattr(score, fate).total() for fate in FATES},
            "largest_too_small": score.largest_small,
            "survived": [{"kind": f.kind, "node": f.node, "error": error} for f, error in score.survivors],
        }
        for score in scores
    ]
    totals = {fate: sum((getattr(score, fate) for score in scores), Counter[str]()) for fate in FATES}
    kinds = sorted({kind for total in totals.values() for kind in total})
    return {
        "ok": all(score.ok for score in scores),
        "planted": totals["planted"].total(),
        "models": rows,
        "kinds": {kind: {fate: total[kind] for fate, total in totals.items()} for kind in kinds},
    }


_TEXT = """A fault replaces one operation of the generated program. It is caught if any output then differs from the
independent engine's by more than the cross-check's own tolerance over 60 random states. {} are silent: the program with
the fault computes the same outputs to 40 digits, so there is nothing to catch. {} are too small: they change no output
by more than its tolerance (largest change {:.1e}, which only forward dynamics tolerates)."""
_COUNTS = "{planted} | {caught} | {silent} | {too_small}"


def compose(data: Data) -> Report:
    """The report of its JSON."""
    models = data["models"]
    alive = [(row["model"], fault) for row in models for fault in row["survived"]]
    silent, small = (sum(row[fate] for row in models) for fate in ("silent", "too_small"))
    matter = data["planted"] - silent - small
    caught = matter - len(alive)
    text = _TEXT.format(silent, small, max((row.get("largest_too_small", 0.0) for row in models), default=0.0))
    listed = tuple(f"{model}: {f['kind']} at node {f['node']}: {f['error']:.1e}" for model, f in alive[:99])
    by_model = (
        f"{row['model']} | {row['engine']} | {_COUNTS.format_map(row)} | "
        f"{verdict(len(row['survived']), not row['survived'])}"
        for row in models
    )
    kinds = (f"{kind} | {_COUNTS.format_map(row)}" for kind, row in data["kinds"].items())
    counts = "planted | caught | silent | too small"
    return Report(
        "Mutation test of the cross-check",
        f"{caught} of {matter} faults that matter are caught ({100.0 * caught / max(1, matter):.6g} %), "
        f"in {counted(len(models), 'model')}.",
        bool(data["ok"]),
        (text,),
        (
            Section("By model", (Table.of(f"model | reference | {counts} | survived", by_model),)),
            Section("By kind of fault", (Table.of(f"kind of fault | {counts}", kinds),)),
            Section("What survived", (Bullets(listed),)),
        ),
        facts=(
            Fact(str(data["planted"]), "single faults planted"),
            Fact(str(len(alive)), "survived; none may", not alive),
            Fact(str(silent + small), "change nothing, or less than a tolerance"),
        ),
    )


TOPIC = Topic("mutation", "Correctness", "Would the cross-check see a fault?", compose, measure)
