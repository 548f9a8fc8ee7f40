"""A record as sections of the report: paragraphs, tables, figures."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..reporting.figures import Chart, Curve, Figure, Mark
from ..reporting.numbers import compact, formatted
from ..reporting.record import Section, Table, verdict
from .growth import Growth, growth
from .models import FUNCTIONS, REVERSE, TIMED_MODELS
from .record import Entry, Made, Record, Wait
from .targets import MAX_REVERSE, Verdict, reverse_costs

_GENERATORS = ("symofros", "casadi", "sympy")
_PEERS = ("pinocchio", "mujoco", "casadi", "sympy")
# What growth is drawn of.
_DRAWN = ("time [ns]", "operations", "generation [s]", "compilation [s]")
# What a simulation asks for at each step: ratios are drawn of it.
_RACED = ("dynamics", "forward_dynamics")
_KINDS = ("mul", "add", "div", "call")
COLORS = {"symofros": 0, "symofros, batch": 2, "pinocchio": 1, "mujoco": 5, "casadi": 6, "sympy": 7}

TARGETS_TEXT = """Ratios of medians, the peer's to ours, each of one race. A peer's best is the fastest of its builds
and ways, chosen by its median alone. Batches are column by column: the states are the fast axis (NumPy's Fortran
order), and arrays are read and written in place; beside them the same by rows. Targets of batches and of large trees
were set on a processor with vectors of eight doubles."""
_TARGETS = "model | function | ours | against | ratio | by rows | target | verdict | measured as"
_MAKING_TEXT = """Generation is from the description to C text, the processor's time; compilation is of that text alone,
by the build that runs fastest, by the clock, at whatever load the machine had then: it is done once and kept."""
_MAKING = """model | function | by | generation [s] | compilation [s] | C text [kB] | machine code [kB] |
    constants [kB]"""
_LIMITS_TEXT = """Operations are what one call executes; a sine or cosine counts as one. Distance is the measured time
over that of the same operations at this core's measured peak, {:.1f} GFlop/s in fused multiply-adds, and for batches
{:.0f} GFlop/s in vectors: 1 is the limit of code in which every multiplication has an addition to go with, and calls
cost far more than the one operation that they count. Memory is what a call reads and writes; its limit is the time it
takes at the {:.0f} GB/s of copies in the core's first cache."""
_LIMITS = """model | function | by | mul | add | div | calls | time [ns] | limit [ns] | distance | of batches |
    memory [B] | its limit [ns]"""
_GROWTH_TEXT = """Over chains of generic bodies in space, and over four-bars in a row, each closed with its neighbours.
An exponent is the slope on logarithmic axes, by least squares over sizes of seven and more: time = c n^exponent."""
_GROWTH = "function | n | quantity | by | sizes | at the largest | exponent"
_WAITS_TEXT = """Medians by the clock: whole processes from start to end, interpreter and imports in them; go2 on a
floating base. With an empty cache the C compiler runs, on all cores. Plain calls take arrays and return new ones; a
batch of 4096 states by rows is asked to take at most 1.4 times its C, whose time is the row below it."""
_WAITS = "what | robot | time | asked at most"
_NOTES = {
    "dynamics": """Ours is M + h + Q, in one function. Pinocchio's is crba, then nonLinearEffects; MuJoCo's shares its
    kinematics between both; CasADi's is one function, common subexpressions shared.""",
    "forward_dynamics": """Ours is by articulated bodies or by factors of M, whichever counts less; Pinocchio's is aba,
    CasADi's articulated bodies, MuJoCo's M + h, a sparse L D L^T and a solve.""",
    "inverse_dynamics_derivatives": "By q and v. CasADi's are made by its differentiation of Newton-Euler.",
    "forward_dynamics_derivatives": """By q and v; ours by u, too. CasADi's are -M^-1 times those of inverse dynamics at
    the acceleration, all in one graph.""",
    "inverse_dynamics_second_derivatives": """By q and q, v and v, q and v, a and q, as full tensors; Pinocchio's
    ComputeRNEASecondOrderDerivatives.""",
    "frame_jacobian": "Of the body that most joints carry, in world axes.",
    "step": "Our loop of sf.simulate, mj_step with contacts, constraints and sensors off; free motion.",
}
_REVERSE_TEXT = f"""The gradient of w . f by all inputs at once, w held: its time over that of f, medians, one state
after the other; at most {MAX_REVERSE:g} is asked. No engine has the like; CasADi's reverse mode, by q and v alone,
takes as many times ours as the last column says."""
_REVERSE = "model | nv | function | the function [ns] | its gradient [ns] | ratio | casadi / ours"
_TIMES = """model | nv | ours | batch, rows | columns | floats | Pinocchio, gcc | Pinocchio, best | MuJoCo | CasADi |
    SymPy"""
_RATIOS = "model | nv | Pinocchio | batch by rows | batch by columns | MuJoCo | CasADi | SymPy"


def sections(record: Record) -> list[Section]:
    """Sections on times, growth, waiting times, costs of generation, limits, and skipped measurements."""
    costs = (record.cost(model, function, by) for model in TIMED_MODELS for function in FUNCTIONS for by in _GENERATORS)
    made = [cost for cost in costs if cost is not None]
    making = (
        f"{cost.title} | {cost.task} | {cost.by} | {cost.generation:.3f} | {cost.compilation:.2f} | "
        f"{cost.text / 1e3:.1f} | {cost.code / 1e3:.1f} | {cost.constants / 1e3:.1f}"
        for cost in made
    )
    return [
        *(_function(record, name) for name in FUNCTIONS if name not in REVERSE),
        _reverse(record),
        _growth(record),
        _waits_section(record.waits),
        Section("What it costs to make", (_MAKING_TEXT, Table.of(_MAKING, making)), "making"),
        _limits(record, made),
        _skipped(record),
    ]


def targets_table(verdicts: Sequence[Verdict]) -> Table:
    """Each target and what was found."""
    rows = []
    for one in verdicts:
        target, variant = one.target, one.entry.variant if one.entry else ""
        peer = ", ".join(filter(None, (target.peer, target.family)))
        ratio = verdict(f"{one.ratio:.2f}", one.met) if one.entry else "-"
        reached = f"{ratio} | {formatted(one.by_rows, '.2f')} | {target.least:g} | {one.statement} | {variant}"
        rows.append(f"{target.title} | {target.task} | {target.how} | {peer} | {reached}")
    return Table.of(_TARGETS, rows)


def ratios(rows: Sequence[Entry]) -> Figure:
    """Figure of peers' times over ours against the number of speeds; a point a model."""
    charts = []
    for function in _RACED:
        own = [row for row in rows if row.function == function]
        curves = []
        for k, peer in enumerate(dict.fromkeys(row.peer for row in own)):
            x, y = zip(*sorted((row.nv, row.ratio) for row in own if row.peer == peer), strict=True)
            curves.append(Curve(peer, x, y, k, "points"))
        title = f"{FUNCTIONS[function]}: their time over ours, a point a model"
        axes, even = ("speeds of the model  [1]", "ratio of medians  [1]"), (Mark("as fast as we", 1.0),)
        charts += [Chart(title, *axes, tuple(curves), even, log="xy")] if curves else []
    return Figure("Each peer's fastest build over ours, state by state. Above the line ours is faster.", tuple(charts))


def _function(record: Record, function: str) -> Section:
    """Times of one function, and beside them, in a table of its own, the ratios: one alone fits a page."""
    times, ratios = [], []
    for model in TIMED_MODELS:
        best = [record.best(model, function, peer) for peer in _PEERS]
        ours = next(filter(None, best), None)
        if ours is not None:
            head = f"{TIMED_MODELS[model].title} | {ours.nv}"
            built = [record.best(model, function, "pinocchio", "gcc"), *best]
            spans = [ours.generated_time, ours.batch, ours.columns, ours.single]
            spans += [x.peer_time if x else None for x in built]
            times.append(" | ".join([head, *(formatted(span, compact) for span in spans)]))
            pinocchio, *others = (formatted(x.ratio if x else None, ".2f") for x in best)
            batches = (best[0].batch_ratio, best[0].columns_ratio) if best[0] else (None, None)
            ratios.append(" | ".join([head, pinocchio, *(formatted(x, ".1f") for x in batches), *others]))
    blocks = (
        *([_NOTES[function]] if function in _NOTES else ()),
        "Nanoseconds a state, minimum and median:",
        Table.of(_TIMES, times).without_empty(),
        "Ratios of medians, the peer's to ours:",
        Table.of(_RATIOS, ratios).without_empty(),
    )
    return Section(_title(function), blocks, function)


def _reverse(record: Record) -> Section:
    """Vector-Jacobian products beside their functions."""
    rows = []
    for one in reverse_costs(record):
        peer = record.best(one.model, one.function, "casadi")
        cells = [one.title, str(one.nv), FUNCTIONS[REVERSE[one.function]], f"{one.own:.0f}", f"{one.product:.0f}"]
        cells += [verdict(f"{one.ratio:.2f}", one.met), formatted(peer.ratio if peer else None, ".2f")]
        rows.append(" | ".join(cells))
    return Section("Reverse mode", (_REVERSE_TEXT, Table.of(_REVERSE, rows)), "reverse")


def _title(function: str) -> str:
    """A sentence's beginning, unless it begins with a symbol."""
    name = FUNCTIONS[function]
    return name if len(name.split()[0]) == 1 else name[0].upper() + name[1:]


def _limits(record: Record, made: Sequence[Made]) -> Section:
    """Section on costs against measured limits of the machine."""
    peaks = [record.machine.get(name, math.nan) / 1e9 for name in ("scalar_flops", "vector_flops", "copied_bytes")]
    flops, vector, copied = peaks
    rows = []
    for cost in made:
        raced = (x for x in record.entries if (x.model, x.function) == (cost.model, cost.function) and x.batch)
        batch = next((x.columns or x.batch for x in raced), None) if cost.by == "symofros" else None
        counts = " | ".join(str(cost.operations.get(kind, 0)) for kind in _KINDS)
        # A Jacobian of one joint takes no operations.
        limit = cost.total / flops or None
        far = f"{formatted(limit, compact)} | {formatted(limit and cost.time / limit, '.1f')}"
        batches = formatted(batch and limit and batch[1] / cost.total * vector, ".1f")
        copying = f"{cost.memory} | {cost.memory / copied:.2f}"
        task = f"{cost.title} | {cost.task} | {cost.by}"
        rows.append(f"{task} | {counts} | {compact(cost.time)} | {far} | {batches} | {copying}")
    return Section("How far from the machine's limit", (_LIMITS_TEXT.format(*peaks), Table.of(_LIMITS, rows)), "limits")


def _waits_section(waits: Sequence[Wait]) -> Section:
    rows = []
    for wait in waits:
        asked, taken = "-" if wait.asked is None else duration(wait.asked), duration(wait.seconds)
        taken = taken if wait.asked is None else verdict(taken, wait.met)
        rows.append(f"{wait.what} | {wait.model or '-'} | {taken} | {asked}")
    return Section("The first second", (_WAITS_TEXT, Table.of(_WAITS, rows)), "first-second")


def duration(seconds: float) -> str:
    """A duration as text: "0.50 s", "1.2 us"."""
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("us", 1e-6)):
        if seconds >= (0.1 * size if unit == "s" else size):
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-9:.3g} ns"


def _growth(record: Record) -> Section:
    curves = growth(record)
    drawn = dict.fromkeys((c.family, c.function) for c in curves)
    figures = [_growth_figure([c for c in curves if (c.family, c.function) == key], *key) for key in drawn]
    rows = (
        f"{FUNCTIONS[c.function]} | {c.family} | {c.quantity} | {c.who} | {c.n[0]} ... {c.n[-1]} | "
        f"{compact(c.values[-1])} | {c.exponent:.2f}"
        for c in curves
    )
    return Section("Growth", (_GROWTH_TEXT, Table.of(_GROWTH, rows), *figures), "growth")


def _growth_figure(curves: Sequence[Growth], family: str, function: str) -> Figure:
    said = f"""{_title(function)}: growth with the number of {family}. Lower is cheaper; a steeper line grows faster,
    and the legend gives its exponent. Where two lines cross, the cheaper side changes."""
    charts = []
    for quantity in _DRAWN:
        own = [c for c in curves if c.quantity == quantity]
        drawn = tuple(Curve(f"{c.who}, n^{c.exponent:.1f}", c.n, c.values, COLORS[c.who], "joined") for c in own)
        title, axis = quantity.partition(" [")[0].capitalize(), quantity if "[" in quantity else f"{quantity}  [1]"
        charts += [Chart(title, f"{family} n  [1]", axis, drawn, log="xy")] if drawn else []
    return Figure(said, tuple(charts))


def _skipped(record: Record) -> Section:
    merged: dict[tuple[str, str, str], list[str]] = {}
    for model, function, peer, why in (*record.failed, *record.skipped):
        key = TIMED_MODELS[model].title if model in TIMED_MODELS else model, peer, why.partition("\n")[0]
        merged.setdefault(key, []).append(FUNCTIONS.get(function, function))
    rows = ((model, peer, ", ".join(dict.fromkeys(names)), why) for (model, peer, why), names in merged.items())
    return Section("What was not timed", (Table.of("model | side | functions | why", rows),), "skipped")
