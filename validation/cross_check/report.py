"""The report of the cross-check."""

from __future__ import annotations

from validation.adapters import ROUTES, differences
from validation.check import ModelResult
from validation.comparison.elements import ROWS as ELEMENT_ROWS
from validation.comparison.errors import Comparison
from validation.contract.quantities import MOTION_ENERGY, QUANTITIES, ROUNDING, SMALL, SOLVE
from validation.cross_check import tables
from validation.cross_check.figures import error_against_condition, error_distributions
from validation.cross_check.measure import measure
from validation.cross_check.record import Record
from validation.procedures.catalogue import ENGINE as FORMULAS
from validation.reporting.figures import Figure
from validation.reporting.numbers import counted, digits
from validation.reporting.record import Block, Bullets, Cell, Data, Fact, Fold, Report, Section, Table, Text, Topic

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
_PROCEDURES = (
    "Steps of every method are repeated by SciPy's coefficients, matrix exponentials and general solvers; what chooses "
    "them, records, events, projection, assembly, equilibria, modes, derivatives, inverse kinematics, batches and "
    "diagrams are compared with their definitions, central differences and closed forms, on a few small models."
)
_NO_SAY = "These engines have no say on these models; nobody else's comparison is weakened."
_SPEED = (
    "Times of our functions in batches of 4096 states, as multiples of the time that a fixed program takes for as many "
    "rows in the same run: what `--baseline` compares. The noise is the range between the quartiles of 25 turns."
)
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
_FAILED = "model = {0}; against = {1}; what = {2} ? 3"
_DRIFT = """model; #drift at the full step = {extra[drift_coarse]:digits};
    #at half the step = {extra[drift_fine]:digits};
    #ratio = ratio(); #allowed = {tolerance:digits} ? ok"""
_POWERS = """model; what = {words}; #power = power(); #at the finer scale = {error:digits};
    #allowed = {tolerance:digits} ? ok; where = {note}"""
_CELLS = "model; what = {quantity}; #error = {error:digits} ? ok; #allowed = {tolerance:digits}"
_SPEEDS = "model; function; #yardsticks = {ratio:.3g}; #noise = {noise:.1%}; #ns a state = {nanoseconds:.3g}"
_CONVENTIONS = "engine = {0}; what = {1}; SYMOFROS = {2}; the engine = {3}"
_QUANTITIES = "quantity = {name}; symbol; unit; #tolerance = {tolerance:digits}; reason = reason()"
_ALL = (*QUANTITIES.values(), MOTION_ENERGY)
_REASONS = {SOLVE: "rounding amplified by cond(M)"}


def compose(data: Data) -> Report:
    """The report of its JSON."""
    record = Record.of(data)
    engines = [name for name in ROUTES if any(row.engine == name for row in record.compared)]
    baseline, worse = _against_baseline(data), len(data.get("baseline", {}).get("regressions", ()))
    failed = tables.failures(record)
    decisions = tables.opinions(record)
    verdicts = [(row[0], row[-1]) for row in decisions.rows]
    wrong = ", ".join(f"{name} ({cell.text})" for name, cell in verdicts if isinstance(cell, Cell) and not cell.ok)
    return Report(
        "Cross-check of the generated code",
        tables.headline(record) + (f" {counted(worse, 'cell')} worse than the baseline." if worse else ""),
        record.ok and not worse,
        (f"{record.states} states a model, seed {record.seed}.",),
        (
            Section("What disagrees or failed", (Table.of(((*row, False) for row in failed), _FAILED),)),
            baseline,
            *_closeness(record, engines),
            *_own(record),
            Section("How fast", (_SPEED, Table.of(record.speeds, _SPEEDS)), page_only=True),
            Section(
                "What an engine could not represent",
                (_NO_SAY, Table.of(tables.unsupported(record), "engine = {1}; models = {0}; reason = {2}")),
            ),
            _method(),
            Section("Models", tuple(map(_model, record.models)), page_only=True),
        ),
        facts=tuple(_facts(record, engines)),
        digest=(*_digest(record), *baseline.blocks),
        unfinished=record.unfinished,
        refused=record.refused,
        decisions=(_DECISION.format(wrong or f"none of {len(verdicts)}"), decisions) if verdicts else (),
        missed=tuple(f"{model}, {engine}: {text}" for model, engine, text in failed),
    )


def _against_baseline(data: Data) -> Section:
    """What is worse than in the stored run; empty without one."""
    stored = data.get("baseline")
    if stored is None:
        return Section("Against the baseline", ())
    revision = f", revision {stored['revision'][:12]}" if stored["revision"] else ""
    worse = [{"ok": False, **row} for row in stored["regressions"]]
    verdict = f"{counted(len(worse), 'cell')} worse" if worse else "nothing is worse"
    said = Text(f"Against {stored['file']} ({stored['date']}{revision}): {verdict}.", "bad" if worse else "plain")
    table = Table.of(worse, "model; engine; what = {quantity}; change = {kind}: {text} ? ok")
    blocks = (said, *([table] if worse else ()), *([Bullets(tuple(stored["notes"]))] if stored["notes"] else ()))
    return Section("Against the baseline", blocks, ok=not worse)


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
        row = tables.worst(row for row in record.compared if row.quantity in names)
        if row is not None:
            condition = f", cond(M) {digits(row.extra['condition'])}" if "condition" in row.extra else ""
            said = f"{label}: {row.words} of {row.model}, {row.engine}{condition}; tolerance {digits(row.tolerance)}"
            facts.append(Fact(digits(row.error), said, row.ok))
    return facts


def _closeness(record: Record, engines: list[str]) -> tuple[Section, ...]:
    """Distributions of errors, the worst of each model, and errors against the condition number."""
    alone = (Fold(f"Against {name} alone", (tables.by_engine(record, name),), page_only=True) for name in engines)
    condition = Figure(_CONDITION, error_against_condition(record))
    return (
        Section("How close", (Figure(_CLOSE, error_distributions(record.distributions)),), page_only=True),
        Section("Model by model", (_BY_MODEL, tables.by_model(record), *alone)),
        Section("Forward dynamics and the condition of M", (condition,), page_only=True),
    )


def _own(record: Record) -> tuple[Section, ...]:
    """Rates at which our energy drifts, and at which finite elements converge."""

    def ratio(row: Comparison) -> str:
        coarse, fine = row.extra["drift_coarse"], row.extra["drift_fine"]
        return f"{coarse / fine:.1f}" if fine else ""

    def power(row: Comparison) -> str:
        return f"{row.extra['power']:.2f}" if "power" in row.extra else ""

    drifts = Table.of((row for row in record.compared if row.quantity == "energy_drift"), _DRIFT, ratio=ratio)
    procedures = Table.of((row for row in record.compared if row.engine == FORMULAS), _CELLS)
    powers = Table.of((row for row in record.compared if row.quantity in ELEMENT_ROWS), _POWERS, power=power)
    return (
        Section("Energy along a free motion", (_ENERGY, drifts), page_only=True),
        Section("Beams against finite elements", (_ELEMENTS, powers), page_only=True),
        Section("What is done with the equations", (_PROCEDURES, procedures), page_only=True),
    )


def _method() -> Section:
    usual = "rounding of sums of some hundred products, and a margin"
    quantities = Table.of(_ALL, _QUANTITIES, reason=lambda quantity: _REASONS.get(quantity.tolerance, usual))
    conventions = Fold(
        "Conventions that differ between engines, and are converted", (Table.of(differences(), _CONVENTIONS),)
    )
    return Section("How it is measured", (_METHOD, quantities, conventions), page_only=True)


def _model(model: ModelResult) -> Fold:
    sizes = ", ".join(f"{name} {number}" for name, number in model.sizes.items())
    spent = Text(", ".join(f"{stage} {seconds:.2f} s" for stage, seconds in model.seconds.items()), "soft")
    frames = (f"Frames compared: {', '.join(model.frames)}",) if model.frames else ()
    return Fold(f"{model.label} {sizes} {model.hash}".strip(), (*frames, Bullets(tuple(model.notes)), spent))


def _digest(record: Record) -> list[Block]:
    """For a terminal of any width: a line a model, or where there are few, a line an engine."""
    each = len(record.models) <= _DETAILED
    of = "engine" if each else "model"
    said = f"Worst comparison of each {of}: error relative to the largest entry, of its tolerance"
    blocks: list[Block] = [said, tables.nearest(record, each)] if record.models else []
    blocks += [Text(f"not compared: {models}, {who}: {why}", "soft") for models, who, why in tables.unsupported(record)]
    return blocks + [Text(f"{model}, {who}: {text}", "bad") for model, who, text in tables.failures(record)]


QUESTION = "Do our C and independent engines agree?"
TOPIC = Topic("check", "Correctness", QUESTION, compose, measure, (), ("ok", "comparisons", "unsupported"))
