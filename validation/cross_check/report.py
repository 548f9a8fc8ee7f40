"""The cross-check: what it asks of which models, and the report."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

import symofros as sf
from symofros.tools import write_atomically
from validation.adapters import ROUTES, differences
from validation.check import ModelResult, Settings
from validation.comparison.elements import ROWS as ELEMENT_ROWS
from validation.contract.quantities import MOTION_ENERGY, QUANTITIES, ROUNDING, SMALL, SOLVE
from validation.cross_check.baseline import Baseline, BaselineError, Regression, machine_of, slowest
from validation.cross_check.figures import error_against_condition, error_distributions, errors_by_engine
from validation.cross_check.junit import to_junit
from validation.cross_check.record import Record, as_data
from validation.cross_check.speed import Speed, YardstickError
from validation.cross_check.speed import measure as measure_speed
from validation.cross_check.tables import (
    BRIEF,
    by_engine,
    by_model,
    failures,
    headline,
    opinions,
    unsupported,
    worst,
    worst_by_model,
)
from validation.inputs.cases import Case, named, standard_set
from validation.inputs.sampling import DEFAULT_STATES
from validation.reporting.command import Run, known
from validation.reporting.figures import Figure
from validation.reporting.numbers import counted, digits
from validation.reporting.record import (
    Block,
    Bullets,
    Cell,
    Column,
    Data,
    Fact,
    Fold,
    Report,
    Section,
    Table,
    Text,
    Topic,
)
from validation.worker_pool import run as run_cases

# Times that speeds are taken again where they seem lower than in a stored run.
_AGAIN = 2
# Up to so many models, each engine has a line of its own on a terminal.
_DETAILED = 2

_DECISION = (
    "**Which engine disagrees with our C:** {}. One that disagrees where all others agree with our C is the suspect "
    "itself; where several disagree, our C is."
)
_CLOSE = (
    "Each row is a quantity, each curve an engine that our C is compared with, over all states of all models. What "
    "lies left of the red bar agrees: see how far left the curves stay, near the rounding of a double (2.2e-16). "
    "“Exact” is the share of states where every digit is the same. Finite elements (exudyn-beams) are extrapolated "
    "over meshes, and allowed 1e-8, in forward dynamics 1e-6."
)
_BY_MODEL = (
    "The largest error over all states and all engines, relative to the largest entry of the other engine's "
    "result. The redder, the more of the tolerance is used. “drift” is our own energy drift in free motion, see "
    "below."
)
_CONDITION = (
    "Solving M dv/dt = Q − h amplifies rounding by up to cond(M), which is large for a heavy robot with light "
    "fingers. Points at or below the dashed line are as good as doubles allow; that is why this one quantity has a "
    "wider tolerance."
)
_ENERGY = (
    "Four motions of each model under gravity without inputs, by a fourth-order method. The engines' energies "
    "along the way are compared in the table above (“motion”). Our own energy, less the work done, drifts by "
    "what the integrator loses: half the step should leave a sixteenth of it, until rounding rules."
)
_ELEMENTS = (
    "What Exudyn's elements tell beside M and h, and the derived powers (docs/theory/elements.md): meshes converge "
    "with the fourth power of the element length, lumped terms with the second; elastic forces differ from ours by "
    "the third power of the deflection, rotary inertia by the second."
)
_NO_SAY = "These engines have no say on these models; nobody else's comparison is weakened."
_FAILED: dict[str, Column] = {"model": "{0}", "against": "{1}", "what": lambda row: Cell(row[2], False)}
_POWERS: dict[str, Column] = {
    "model": "{model}",
    "what": lambda row: row.quantity.replace("_", " "),
    "#power": lambda row: f"{row.extra['power']:.2f}" if "power" in row.extra else "",
    "#at the finer scale": lambda row: digits(row.error),
    "#allowed": lambda row: Cell(digits(row.tolerance), row.ok),
    "where": "{note}",
}
_UNSUPPORTED: dict[str, Column] = {"engine": "{1}", "models": "{0}", "reason": "{2}"}
_SPEED = (
    "Times of our functions in batches of 4096 states, as multiples of the time that a fixed program takes for as many "
    "rows in the same run: what `--baseline` compares. The noise is the range between the quartiles of 25 turns."
)
_SPEEDS: dict[str, Column] = {
    "model": "{model}",
    "function": "{function}",
    "#yardsticks": "{ratio:.3g}",
    "#noise": "{noise:.1%}",
    "#ns a state": "{nanoseconds:.3g}",
}
_REGRESSIONS: dict[str, Column] = {
    "model": "{model}",
    "engine": "{engine}",
    "what": "{quantity}",
    "change": lambda row: Cell(f"{row['kind']}: {row['text']}", False),
}
_DRIFT: dict[str, Column] = {
    "model": "{model}",
    "#drift at the full step": lambda row: digits(row.extra["drift_coarse"]),
    "#at half the step": lambda row: digits(row.extra["drift_fine"]),
    "#ratio": lambda row: _ratio(row.extra["drift_coarse"], row.extra["drift_fine"]),
    "#allowed": lambda row: Cell(digits(row.tolerance), row.ok),
}

# Models checked at the same time.
WORKERS = min(os.cpu_count() or 1, 4)


def measure(
    run: Run,
    models: Annotated[
        list[str] | None,
        typer.Argument(help="URDF, MJCF or YAML files, or names of the standard set; none: all of it."),
    ] = None,
    floating_base: Annotated[
        bool, typer.Option("--floating-base", help="Put a free joint under the root of URDF files.")
    ] = False,
    states: Annotated[int, typer.Option(min=1, help="Random states a model.")] = DEFAULT_STATES,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the random states.")] = 0,
    engine: Annotated[
        list[str] | None, typer.Option("--engine", help=f"Only this engine; repeatable. {', '.join(ROUTES)}.")
    ] = None,
    junit: Annotated[Path | None, typer.Option(help="Also write a JUnit file.")] = None,
    workers: Annotated[int, typer.Option(min=1, help="Models checked at the same time.")] = WORKERS,
    speed: Annotated[bool, typer.Option("--speed", help="Also time our functions, against a fixed program.")] = False,
    baseline: Annotated[
        Path | None, typer.Option(help="A stored check.json: fail where this run is less accurate or slower.")
    ] = None,
) -> Data:
    """Compare our C of each MODEL with every engine that can represent it."""
    known(engine, ROUTES, "--engine", "engine")
    settings = Settings(states, seed, tuple(engine) if engine else None)
    stored = _baseline(baseline, settings)
    try:
        cases = named(models, floating_base) if models else standard_set()
    except (LookupError, FileNotFoundError) as error:
        raise typer.BadParameter(str(error.args[0]), param_hint="MODEL") from None
    first = ", ".join(case.label for case in sorted(cases, key=lambda case: -case.weight)[:workers])
    run.expect(len(cases), f"cross-checking {first}")
    results: dict[str, ModelResult] = {}

    def done(result: ModelResult) -> None:
        results[result.label] = result
        count = len(result.compared)
        run.advance(
            f"{result.label}: {f'{count} agree' if result.ok else 'DISAGREES'}, {sum(result.seconds.values()):.1f} s"
        )

    with contextlib.suppress(KeyboardInterrupt):  # What was finished is reported.
        run_cases(cases, settings, workers, done)
    finished = [results[case.label] for case in cases if case.label in results]
    unfinished = [case.label for case in cases if case.label not in results]
    # The report of the standard set is not replaced by one of some models or engines, unless that is asked for.
    run.writes = run.asked or not (models or engine)
    compiled = [case for case in cases if case.label in results and results[case.label].sizes]
    wanted = (speed or (stored is not None and bool(stored.record.speeds))) and not unfinished
    speeds = _speeds(run, compiled, stored) if wanted else []
    data = as_data(settings, finished, run.seconds, unfinished, speeds)
    regressions: list[Regression] = []
    if stored is not None:
        regressions, notes = stored.judge(Record.of(data), machine_of(data))
        origin = {"file": stored.name, "revision": stored.revision, "date": stored.date, "notes": notes}
        data |= {"ok": data["ok"] and not regressions, "baseline": origin}
        data["baseline"]["regressions"] = [asdict(worse) for worse in regressions]
    if junit is not None:
        junit.parent.mkdir(parents=True, exist_ok=True)
        write_atomically(junit, to_junit(finished, run.seconds, regressions))
    return data


def _baseline(path: Path | None, settings: Settings) -> Baseline | None:
    """The stored run, before anything is computed in vain."""
    if path is None:
        return None
    try:
        stored = Baseline.read(path)
        stored.require(settings.states, settings.seed)
    except BaselineError as error:
        raise typer.BadParameter(str(error), param_hint="--baseline") from None
    return stored


def _speeds(run: Run, cases: Sequence[Case], stored: Baseline | None) -> list[Speed]:
    """Speeds, one model after the other; what looks slower than in the stored run is timed again, and its best kept."""
    before = {} if stored is None else {(row.model, row.function): row for row in stored.record.speeds}
    run.expect(len(cases), "timing")
    speeds: list[Speed] = []
    for case in cases:
        try:
            subject = case.load()
            timed = measure_speed(subject)
            for _ in range(_AGAIN):
                if not any(_is_slower(before.get((row.model, row.function)), row) for row in timed):
                    break
                timed = [
                    min(pair, key=lambda row: row.ratio) for pair in zip(timed, measure_speed(subject), strict=True)
                ]
            speeds += timed
        except (YardstickError, sf.SymofrosError) as error:
            run.say(f"{case.label}: not timed: {error}", bad=True)
        run.advance(case.label)
    return speeds


def _is_slower(stored: Speed | None, fresh: Speed) -> bool:
    return stored is not None and fresh.ratio > slowest(stored, fresh)


def compose(data: Data) -> Report:
    """The report of its JSON."""
    record = Record.of(data)
    engines = [name for name in ROUTES if any(row.engine == name for row in record.compared)]
    drawings = tuple(filter(None, (error_distributions(record.distributions),)))
    conditions = tuple(filter(None, (error_against_condition(record),)))
    drifts = Table.of((row for row in record.compared if row.quantity == "energy_drift"), _DRIFT)
    powers = Table.of((row for row in record.compared if row.quantity in ELEMENT_ROWS), _POWERS)
    alone = (Fold(f"Against {name} alone", (by_engine(record, engines=(name,)),), page_only=True) for name in engines)
    regressions = data.get("baseline", {}).get("regressions", ())
    sections = [
        Section("What disagrees or failed", (Table.of(failures(record), _FAILED),)),
        _against_baseline(data),
        Section("How close", (Figure(_CLOSE, drawings),), page_only=True),
        Section("Model by model", (_BY_MODEL, by_model(record), *alone)),
        Section("Forward dynamics and the condition of M", (Figure(_CONDITION, conditions),), page_only=True),
        Section("Energy along a free motion", (_ENERGY, drifts), page_only=True),
        Section("Beams against finite elements", (_ELEMENTS, powers), page_only=True),
        Section("How fast", (_SPEED, Table.of(record.speeds, _SPEEDS)), page_only=True),
        Section("What an engine could not represent", (_NO_SAY, Table.of(unsupported(record), _UNSUPPORTED))),
        _method(),
        Section("Models", tuple(map(_model, record.models)), page_only=True),
    ]
    return Report(
        "Cross-check of the generated code",
        headline(record) + (f" {counted(len(regressions), 'cell')} worse than the baseline." if regressions else ""),
        record.ok and not regressions,
        (f"{record.states} states a model, seed {record.seed}.",),
        tuple(section for section in sections if section.shows),
        facts=tuple(_facts(record, engines)),
        highlights=(errors_by_engine(record),) if engines else (),
        digest=(*_digest(record), *_against_baseline(data).blocks),
        narrow=(*_narrow(record), *_against_baseline(data).blocks),
        unfinished=record.unfinished,
        refused=record.refused,
        decisions=_decisions(record) if engines else (),
        missed=tuple(f"{model}, {engine}: {text}" for model, engine, text in failures(record)),
    )


def _against_baseline(data: Data) -> Section:
    """What is worse than in the stored run; empty without one."""
    stored = data.get("baseline")
    if stored is None:
        return Section("Against the baseline", ())
    revision = f", revision {stored['revision'][:12]}" if stored["revision"] else ""
    verdict = (
        "nothing is worse" if not stored["regressions"] else f"{counted(len(stored['regressions']), 'cell')} worse"
    )
    said = f"Against {stored['file']} ({stored['date']}{revision}): {verdict}."
    blocks: list[Block] = [Text(said, "bad" if stored["regressions"] else "plain")]
    blocks += [Table.of(stored["regressions"], _REGRESSIONS)] if stored["regressions"] else []
    blocks += [Bullets(tuple(stored["notes"]))] if stored["notes"] else []
    return Section("Against the baseline", tuple(blocks), ok=not stored["regressions"])


def _decisions(record: Record) -> tuple[Block, ...]:
    table = opinions(record)
    verdicts = {str(row[0]): row[-1] for row in table.rows}
    wrong = [f"{name} ({v.text})" for name, v in verdicts.items() if isinstance(v, Cell) and v.ok is False]
    return _DECISION.format(", ".join(wrong) or f"none of {len(table.rows)}"), table


def _facts(record: Record, engines: list[str]) -> list[Fact]:
    independent = sum(ROUTES[name].independent for name in engines)
    speeds = [model.sizes["nv"] for model in record.models if "nv" in model.sizes]
    span = f", {min(speeds)} to {max(speeds)} speeds" if speeds else ""
    facts = [
        Fact(str(len(record.models)), f"models{span}, {record.states} states each"),
        Fact(str(independent), f"independent opinions, and {len(engines) - independent} of our own"),
    ]
    rounded = {q.name for q in _ALL if q.tolerance == ROUNDING}
    for label, names in ("largest relative error", rounded), ("in forward dynamics", {"forward_dynamics"}):
        row = worst(row for row in record.compared if row.quantity in names)
        if row is not None:
            place = f"{row.quantity.replace('_', ' ')} of {row.model}, {row.engine}"
            condition = f", cond(M) {digits(row.extra['condition'])}" if "condition" in row.extra else ""
            said = f"{label}: {place}{condition}; tolerance {digits(row.tolerance)}"
            facts.append(Fact(digits(row.error), said, row.ok))
    return facts


def _ratio(coarse: float, fine: float) -> str:
    return f"{coarse / fine:.1f}" if fine else ""


_ALL = (*QUANTITIES.values(), MOTION_ENERGY)
_METHOD = (
    "The error of a state is the largest difference of any entry, divided by the largest entry of the other engine's "
    f"result in that state. Where that result happens to be small, it is divided by {SMALL} of what the quantity "
    "typically is on this model, because rounding errors are those of the terms that are summed. Random states cover "
    "the whole manifold of q, whatever the joint limits; the first few are special: neutral, at rest, many turns, half "
    "turns, negated quaternions, fast. pinocchio and mujoco are built from our description, body by body, by code that "
    "shares nothing with the generator; pinocchio-urdf and mujoco-urdf read the robot's file themselves, every digit "
    "as it stands; vectors is our C several states at a time, interpreted our NumPy evaluation of the same equations; "
    "description is the stated formulas of the joint efforts."
)
_REASONS = {SOLVE: "rounding amplified by cond(M)"}
_QUANTITIES: dict[str, Column] = {
    "quantity": "{name}",
    "symbol": "{symbol}",
    "unit": "{unit}",
    "#tolerance": lambda q: digits(q.tolerance),
    "reason": lambda q: _REASONS.get(q.tolerance, "rounding of sums of some hundred products, and a margin"),
}
_CONVENTIONS: dict[str, Column] = {"engine": "{0}", "what": "{1}", "SYMOFROS": "{2}", "the engine": "{3}"}


def _method() -> Section:
    conventions = Table.of(differences(), _CONVENTIONS)
    folded = Fold("Conventions that differ between engines, and are converted", (conventions,))
    return Section("How it is measured", (_METHOD, Table.of(_ALL, _QUANTITIES), folded), page_only=True)


def _model(model: ModelResult) -> Fold:
    blocks: list[Block] = [f"Frames compared: {', '.join(model.frames)}"] if model.frames else []
    blocks += [Bullets(model.notes)] if model.notes else []
    blocks.append(Text(", ".join(f"{stage} {seconds:.2f} s" for stage, seconds in model.seconds.items()), "soft"))
    sizes = ", ".join(f"{name} {number}" for name, number in model.sizes.items())
    return Fold(f"{model.label} {sizes} {model.hash}".strip(), tuple(blocks))


def _narrow(record: Record) -> list[Block]:
    """A short line a model for terminals that have no room for every quantity."""
    refusals = counted(len(unsupported(record)), "reason")
    return [
        "Worst comparison of each model: error relative to the largest entry, of its tolerance",
        worst_by_model(record),
        *(Text(f"{model}, {engine}: {text}", "bad") for model, engine, text in failures(record)),
        *([f"{refusals} why an engine had no say: in the report, or a wider terminal"] if unsupported(record) else []),
    ]


def _digest(record: Record) -> list[Block]:
    detailed = len(record.models) <= _DETAILED
    which = "" if detailed else " and engines"
    blocks: list[Block] = []
    if record.models:
        blocks.append(f"Largest error over all states{which}, relative to the largest entry")
        blocks.append(by_engine(record, BRIEF) if detailed else by_model(record, BRIEF))
    blocks += [Text(f"not compared: {model}, {engine}: {text}", "soft") for model, engine, text in unsupported(record)]
    blocks += [Text(f"{model}, {engine}: {text}", "bad") for model, engine, text in failures(record)]
    return blocks


QUESTION = "Do our C and independent engines agree?"
TOPIC = Topic("check", "Correctness", QUESTION, compose, measure, (), ("ok", "comparisons", "unsupported"))
