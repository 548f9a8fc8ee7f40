"""The report of the cross-check."""

from __future__ import annotations

import re

from ..adapters import differences
from ..checking import ModelResult
from ..comparison.elements import ROWS as ELEMENT_ROWS
from ..comparison.errors import NOBODY
from ..comparison.relations import ENGINE as RELATIONS
from ..contract.quantities import ROUNDING, SMALL, SOLVE
from ..procedures import ENGINE as FORMULAS
from ..reporting.figures import Figure
from ..reporting.numbers import counted, digits
from ..reporting.record import MISSED, Block, Bullets, Data, Fact, Report, Section, Table, Text, Topic, verdict
from . import tables
from .figures import error_against_condition, error_distributions
from .measure import measure
from .record import Record, is_independent

# Beginnings of the parts of a problem, which is written on one line.
_PARTS = re.compile("; (?=found: |rule: |remedy: )")
# Up to so many models, each engine has a line of its own on a terminal.
_DETAILED = 2

_DECISION = "**Which engine disagrees with our C:** {}."
_SUSPECT = (
    "One that disagrees where all others agree with our C is the suspect itself; where several disagree, our C is."
)
_CLOSE = """Each row is a quantity, each curve an engine that our C is compared with, over all states of all models.
What lies left of the red bar agrees: see how far left the curves stay, near the rounding of a double (2.2e-16).
“Exact” is the share of states where every digit is the same. Finite elements (exudyn-beams) are extrapolated over
meshes, and allowed 1e-8, in forward dynamics 1e-6."""
_BY_MODEL = """The largest error over all states and all engines, relative to the largest entry of the other engine's
result. The redder, the more of the tolerance is used. “drift” is our own energy drift in free motion, see below."""
_CONDITION = """Solving M dv/dt = Q − h amplifies rounding by up to cond(M), which is large for a heavy robot with light
fingers. Points at or below the dashed line are as good as doubles allow; that is why this one quantity has a wider
tolerance."""
_ENERGY = """Four motions of each model under gravity without inputs, by a fourth-order method. The engines' energies
along the way are compared in the table above (“motion”). Our own energy, less the work done, drifts by what the
integrator loses: half the step should leave a sixteenth of it, until rounding rules."""
_ELEMENTS = """What Exudyn's elements tell beside M and h, and the derived powers (docs/theory/elements.md): meshes
converge with the fourth power of the element length, lumped terms with the second; elastic forces differ from ours by
the third power of the deflection, rotary inertia by the second."""
_PROCEDURES = """Steps of every method are repeated by SciPy's coefficients, matrix exponentials and general solvers;
what chooses them, records, events, projection, assembly, equilibria, modes, derivatives, inverse kinematics, batches
and diagrams are compared with their definitions, central differences and closed forms, on a few small models."""
_RELATIONS = """What our program of a description says at some states, against what those of other descriptions of the
same mechanism say: in another place, another order, of more bodies, under other names, in other units, read from files
that it was written to. No engine is asked, and no reference. Bounds are those of engines; what is asked again, and the
last states of a batch, must be the same to the bit."""
_NOT_COMPARED = "These engines have no say on these models; nobody else's comparison is weakened."
_SPEED = """Times of our functions in batches of 4096 states, as multiples of the time that a fixed program takes for as
many rows in the same run: what `--baseline` compares. The noise is the range between the quartiles of 25 turns."""
_METHOD = f"""The error of a state is the largest difference of any entry, divided by the largest entry of the other
engine's result in that state. Where that result happens to be small, it is divided by {SMALL} of what the quantity
typically is on this model, because rounding errors are those of the terms that are summed. Random states cover the
whole manifold of q, whatever the joint limits; the first few are special: neutral, at rest, many turns, half turns,
negated quaternions, fast. pinocchio and mujoco are built from our description, body by body, by code that shares
nothing with the generator; pinocchio-urdf and mujoco-urdf read the robot's file themselves, every digit as it stands;
vectors is our C several states at a time, interpreted our NumPy evaluation of the same equations; description is the
stated formulas of the joint efforts."""
_CONVENTIONS = "Conventions that differ between engines, and are converted"
_REASONS = {SOLVE: "rounding amplified by cond(M)"}
_USUAL = "rounding of sums of some hundred products, and a margin"


def compose(data: Data) -> Report:
    """The report of its JSON."""
    record = Record.of(data)
    engines = record.engines
    baseline, worse = _against_baseline(data), len(data.get("baseline", {}).get("regressions", ()))
    failed, opinions = tables.failures(record), [tables.opinion(record, name) for name in engines]
    wrong = ", ".join(f"{name} ({said.removeprefix(MISSED)})" for name, *_, said in opinions if said != "agrees")
    disagreeing = _DECISION.format(wrong or f"none of {len(opinions)}")
    decided = disagreeing, Table.of(tables.OPINION, opinions), Text(_SUSPECT, "soft")
    marked = ((model, engine, verdict(text, False)) for model, engine, text in failed)
    apart = ((engine, models, reason) for models, engine, reason in tables.unsupported(record))
    speeds = (
        (row.model, row.function, f"{row.ratio:.3g}", f"{row.noise:.1%}", f"{row.nanoseconds:.3g}")
        for row in record.speeds
    )
    return Report(
        "Cross-check of the generated code",
        tables.headline(record) + (f" {counted(worse, 'cell')} worse than the baseline." if worse else ""),
        record.ok and not worse,
        (f"{record.states} states a model, seed {record.seed}.",),
        (
            Section("What disagrees or failed", (Table.of("model | against | what", marked),)),
            Section("Against the baseline", baseline, ok=not worse),
            *_closeness(record, engines),
            *_own(record),
            Section(
                "How fast",
                (_SPEED, Table.of("model | function | yardsticks | noise | ns a state", speeds)),
                "speed",
                page_only=True,
            ),
            Section(
                "What an engine could not represent",
                (_NOT_COMPARED, Table.of("engine | models | reason", apart)),
                "gaps",
            ),
            _method(),
            Section("Models", tuple(map(_model, record.models)), "each", page_only=True),
        ),
        facts=tuple(_facts(record, engines)),
        digest=(*_digest(record), *baseline),
        unfinished=record.unfinished,
        refused=record.refused,
        decisions=decided if opinions else (),
        missed=tuple(f"{model}, {engine}: {text}" for model, engine, text in failed),
    )


def _against_baseline(data: Data) -> tuple[Block, ...]:
    """Blocks on regressions against the stored run; none if there is no stored run."""
    stored = data.get("baseline")
    if stored is None:
        return ()
    revision = f", revision {stored['revision'][:12]}" if stored["revision"] else ""
    worse = stored["regressions"]
    result = f"{counted(len(worse), 'cell')} worse" if worse else "nothing is worse"
    said = Text(f"Against {stored['file']} ({stored['date']}{revision}): {result}.", "bad" if worse else "plain")
    rows = (
        (row["model"], row["engine"], row["quantity"], verdict(f"{row['kind']}: {row['text']}", False)) for row in worse
    )
    table = (Table.of("model | engine | what | change", rows),) if worse else ()
    return (said, *table, *((Bullets(tuple(stored["notes"])),) if stored["notes"] else ()))


def _facts(record: Record, engines: list[str]) -> list[Fact]:
    independent = sum(map(is_independent, engines))
    speeds = [model.sizes["nv"] for model in record.models if "nv" in model.sizes]
    span = f", {min(speeds)} to {max(speeds)} speeds" if speeds else ""
    own = len(record.compared) - record.independent
    facts = [
        Fact(str(len(record.models)), f"models{span}, {record.states} states each"),
        Fact(str(record.independent), f"comparisons with independent engines; {own} with our own code and formulas"),
        Fact(str(independent), f"independent opinions, and {len(engines) - independent} of our own"),
    ]
    rounding = {q.name for q in tables.COMPARED if q.tolerance == ROUNDING}
    for label, names in ("largest relative error", rounding), ("in forward dynamics", {"forward_dynamics"}):
        row = tables.worst(row for row in record.compared if row.quantity in names)
        if row is not None:
            condition = f", cond(M) {digits(row.extra['condition'])}" if "condition" in row.extra else ""
            said = f"{label}: {row.title} of {row.model}, {row.engine}{condition}; tolerance {digits(row.tolerance)}"
            facts.append(Fact(digits(row.error), said, row.ok))
    return facts


def _closeness(record: Record, engines: list[str]) -> tuple[Section, ...]:
    """Distributions of errors, the worst of each model, and errors against the condition number."""
    alone = (Section(f"Against {name} alone", (tables.by_engine(record, name),), page_only=True) for name in engines)
    condition = Figure(_CONDITION, error_against_condition(record))
    return (
        Section("How close", (Figure(_CLOSE, error_distributions(record.distributions)),), "close", page_only=True),
        Section("Model by model", (_BY_MODEL, tables.by_model(record), *alone), "models"),
        Section("Forward dynamics and the condition of M", (condition,), "condition", page_only=True),
    )


def _own(record: Record) -> tuple[Section, ...]:
    """Sections on energy drift, convergence of finite elements, and procedures on the equations."""
    drifts, powers, procedures, related = [], [], [], []
    for row in record.compared:
        extra, limit = row.extra, verdict(digits(row.tolerance), row.ok)
        if row.quantity == "energy_drift":
            coarse, fine = extra["drift_coarse"], extra["drift_fine"]
            drifts.append((row.model, digits(coarse), digits(fine), f"{coarse / fine:.1f}" if fine else "", limit))
        elif row.quantity in ELEMENT_ROWS:
            rate = f"{extra['power']:.2f}" if "power" in extra else ""
            powers.append((row.model, row.title, rate, digits(row.error), limit, row.note))
        elif row.engine == FORMULAS:
            error = verdict(digits(row.error), row.ok)
            procedures.append((row.model, row.quantity, error, digits(row.tolerance)))
        elif row.engine == RELATIONS:
            related.append(
                (row.model, row.quantity, verdict(digits(row.error), row.ok), digits(row.tolerance), row.note)
            )
    drift = Table.of("model | drift at the full step | at half the step | ratio | allowed", drifts)
    power = Table.of("model | what | power | at the finer scale | allowed | where", powers)
    procedure = Table.of("model | what | error | allowed", procedures)
    relation = Table.of("model | relation | error | allowed | where", related)
    return (
        Section("Energy along a free motion", (_ENERGY, drift), "energy", page_only=True),
        Section("Beams against finite elements", (_ELEMENTS, power), "elements", page_only=True),
        Section("Other descriptions of the same mechanism", (_RELATIONS, relation), "relations", page_only=True),
        Section("What is done with the equations", (_PROCEDURES, procedure), "procedures", page_only=True),
    )


def _method() -> Section:
    rows = ((q.name, q.symbol, q.unit, digits(q.tolerance), _REASONS.get(q.tolerance, _USUAL)) for q in tables.COMPARED)
    quantities = Table.of("quantity | symbol | unit | tolerance | reason", rows)
    conventions = Section(_CONVENTIONS, (Table.of("engine | what | SYMOFROS | the engine", differences()),))
    return Section("How it is measured", (_METHOD, quantities, conventions), "method", page_only=True)


def _model(model: ModelResult) -> Section:
    sizes = ", ".join(f"{name} {number}" for name, number in model.sizes.items())
    spent = Text(", ".join(f"{stage} {seconds:.2f} s" for stage, seconds in model.seconds.items()), "soft")
    notes = (Bullets(tuple(model.notes)),) if model.notes else ()
    frames = (f"Frames compared: {', '.join(model.frames)}",) if model.frames else ()
    return Section(f"{model.label} {sizes} {model.hash}".strip(), (*frames, *notes, spent))


def _digest(record: Record) -> list[Block]:
    """Summary for a terminal of any width: a line a model, or, of few, a line an engine and what it left out."""
    each = len(record.models) <= _DETAILED
    of = "engine" if each else "model"
    said = f"Worst comparison of each {of}: error relative to the largest entry, of its tolerance"
    blocks: list[Block] = [said, tables.nearest(record, each)] if record.compared else []
    summary = "" if each else tables.left_out(record)
    apart = (f"not compared: {models}, {who}: {why}" for models, who, why in tables.unsupported(record, not each))
    blocks += [Text(text, "soft") for text in (summary, *apart, tables.not_installed(record)) if text]
    for model, who, text in tables.failures(record):
        what, *more = _PARTS.split(text)
        where = model if who == NOBODY else f"{model}, {who}"
        blocks += [Text(f"{where}: {what}", "bad"), *((Bullets(tuple(more)),) if more else ())]
    return blocks


QUESTION = "Do our C and independent engines agree?"
TOPIC = Topic(
    "check", "Correctness", QUESTION, compose, measure, "", ("ok", "independent", "comparisons", "unsupported")
)
