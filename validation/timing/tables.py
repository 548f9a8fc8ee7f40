"""A record as sections of the report: paragraphs, tables, figures."""

from __future__ import annotations

import math
from collections.abc import Sequence

from validation.reporting.figures import Chart, Curve, Figure
from validation.reporting.record import Cell, Section, Table
from validation.timing.growth import Growth, growth
from validation.timing.models import FUNCTIONS, TIMED_MODELS
from validation.timing.record import Entry, Made, Record
from validation.timing.targets import Verdict, verdicts

_GENERATORS = ("symofros", "casadi", "sympy")
# What growth is drawn of.
_DRAWN = ("time [ns]", "operations", "generation [s]", "compilation [s]")
COLORS = {"symofros": 0, "symofros, batch": 2, "pinocchio": 1, "mujoco": 5, "casadi": 6, "sympy": 7}


def sections(record: Record) -> list[Section]:
    """All that have something to show."""
    made = [
        _targets(record),
        *(_function(record, name) for name in FUNCTIONS),
        _growth(record),
        _making(record),
        _limits(record),
        _skipped(record),
    ]
    return [section for section in made if section.shows]


def targets_table(record: Record) -> Table:
    """Each target and what was found."""
    head = ("model", "function", "ours", "against", "#ratio", "#by rows", "#target", "verdict", "measured as")
    return Table(head, tuple(_target(verdict) for verdict in verdicts(record)))


def _targets(record: Record) -> Section:
    text = (
        "Ratios of medians, the peer's to ours, each of one race. A peer's best is the fastest of its builds and ways, "
        "chosen by its median alone. Batches are column by column: the states are the fast axis (NumPy's Fortran "
        "order), and arrays are read and written in place; beside them the same by rows."
    )
    return Section("Targets", (text, targets_table(record)), "targets")


def _target(verdict: Verdict) -> tuple[str | Cell, ...]:
    target, entry = verdict.target, verdict.entry
    return (
        TIMED_MODELS[target.model].title,
        FUNCTIONS[target.function],
        {"scalar": "state by state", "columns": "batch by columns"}[target.how],
        f"{target.peer}, {target.family}" if target.family else target.peer,
        Cell(f"{verdict.ratio:.2f}", verdict.met) if entry else "-",
        "" if verdict.by_rows is None else f"{verdict.by_rows:.2f}",
        f"{target.least:g}",
        verdict.statement,
        entry.variant if entry else "",
    )


def _function(record: Record, function: str) -> Section:
    """Times of one function, and beside them, in a table of its own, the ratios: one alone fits a page."""
    times, ratios = [], []
    for model, timed in TIMED_MODELS.items():
        best = {peer: record.best(model, function, peer) for peer in ("pinocchio", "mujoco", "casadi", "sympy")}
        known = [entry for entry in best.values() if entry is not None]
        if not known:
            continue
        first, pinocchio = known[0], best["pinocchio"]
        gcc = record.best(model, function, "pinocchio", "gcc")
        generated_time = (_pair(x) for x in (first.generated_time, first.batch, first.columns, first.single))
        head = (timed.title, str(first.nv))
        times.append((*head, *generated_time, *(_peer_time(x) for x in (gcc, *best.values()))))
        others = (_ratio(best[peer]) for peer in ("mujoco", "casadi", "sympy"))
        ratios.append((*head, _ratio(pinocchio), *_in_batches(pinocchio), *others))
    notes = (_NOTES[function],) if function in _NOTES else ()
    engines = ("#Pinocchio, gcc", "#Pinocchio, best", "#MuJoCo", "#CasADi", "#SymPy")
    blocks = (
        *notes,
        "Nanoseconds a state, minimum and median:",
        Table(("model", "#nv", "#ours", "#batch, rows", "#columns", "#floats", *engines), tuple(times)).without_empty(),
        "Ratios of medians, the peer's to ours:",
        Table(
            ("model", "#nv", "#Pinocchio", "#batch by rows", "#batch by columns", "#MuJoCo", "#CasADi", "#SymPy"),
            tuple(ratios),
        ).without_empty(),
    )
    return Section(_title(function), blocks, function)


def _title(function: str) -> str:
    """A sentence's beginning, unless it begins with a symbol."""
    name = FUNCTIONS[function]
    return name if len(name.split()[0]) == 1 else name[0].upper() + name[1:]


_NOTES = {
    "dynamics": "Ours is M + h + Q, in one function. Pinocchio's is crba, then nonLinearEffects; MuJoCo's shares its "
    "kinematics between both; CasADi's is one function, common subexpressions shared.",
    "forward_dynamics": "Ours is by articulated bodies or by factors of M, whichever counts less; Pinocchio's is "
    "aba, CasADi's articulated bodies, MuJoCo's M + h, a sparse L D L^T and a solve.",
    "inverse_dynamics_derivatives": "By q and v. CasADi's are made by its differentiation of Newton-Euler.",
    "forward_dynamics_derivatives": "By q and v; ours by u, too. CasADi's are -M^-1 times those of inverse dynamics at "
    "the acceleration, all in one graph.",
    "frame_jacobian": "Of the body that most joints carry, in world axes.",
    "step": "Our loop of sf.simulate, mj_step with contacts, constraints and sensors off; free motion.",
}


def _pair(times: tuple[float, float] | None) -> str:
    return "-" if times is None else ", ".join(_short(x) for x in times)


def _peer_time(entry: Entry | None) -> str:
    return "-" if entry is None else _pair(entry.peer_time)


def _ratio(entry: Entry | None) -> str:
    return "-" if entry is None else f"{entry.ratio:.2f}"


def _in_batches(entry: Entry | None) -> list[str]:
    ratios = (None, None) if entry is None else (entry.batch_ratio, entry.columns_ratio)
    return ["-" if ratio is None else f"{ratio:.1f}" for ratio in ratios]


def _short(x: float) -> str:
    return f"{x:.1f}" if x < 100 else f"{x:.0f}"


def _all_costs(record: Record) -> list[Made]:
    """Costs of the fastest build of each side."""
    costs = [record.cost(model, function, by) for model in TIMED_MODELS for function in FUNCTIONS for by in _GENERATORS]
    return [cost for cost in costs if cost is not None]


def _named(cost: Made) -> tuple[str, str, str]:
    return TIMED_MODELS[cost.model].title, FUNCTIONS[cost.function], cost.by


def _making(record: Record) -> Section:
    text = (
        "Generation is from the description to C text, the processor's time; compilation is of that text alone, by the "
        "build that runs fastest, by the clock, at whatever load the machine had then: it is done once and kept."
    )
    sizes = ("#C text [kB]", "#machine code [kB]", "#constants [kB]")
    head = ("model", "function", "by", "#generation [s]", "#compilation [s]", *sizes)
    rows = tuple(
        (
            *_named(cost),
            f"{cost.generation:.3f}",
            f"{cost.compilation:.2f}",
            *(f"{x / 1e3:.1f}" for x in (cost.text, cost.code, cost.constants)),
        )
        for cost in _all_costs(record)
    )
    return Section("What it costs to make", (text, Table(head, rows)), "making")


def _limits(record: Record) -> Section:
    flops, vector = record.machine.get("scalar_flops", math.nan), record.machine.get("vector_flops", math.nan)
    copied = record.machine.get("copied_bytes", math.nan)
    text = (
        "Operations are what one call executes; a sine or cosine counts as one. Distance is the measured time over "
        f"that of the same operations at this core's measured peak, {flops / 1e9:.1f} GFlop/s in fused multiply-adds, "
        f"and for batches {vector / 1e9:.0f} GFlop/s in vectors: 1 is the limit of code in which every multiplication "
        "has an addition to go with, and calls cost far more than the one operation that they count. Memory is what a "
        f"call reads and writes; its limit is the time it takes at the {copied / 1e9:.0f} GB/s of copies in the "
        "core's first cache."
    )
    counts = ("#mul", "#add", "#div", "#calls")
    times = ("#time [ns]", "#limit [ns]", "#distance", "#of batches", "#memory [B]", "#its limit [ns]")
    rows = tuple(_limit(record, cost, flops, vector, copied) for cost in _all_costs(record))
    table = Table(("model", "function", "by", *counts, *times), rows)
    return Section("How far from the machine's limit", (text, table), "limits")


def _limit(record: Record, cost: Made, flops: float, vector: float, copied: float) -> tuple[str, ...]:
    limit = 1e9 * cost.total / flops
    alike = [x for x in record.entries if (x.model, x.function) == (cost.model, cost.function)]
    batch = next((x.columns or x.batch for x in alike if x.batch), None)
    in_batch = f"{batch[1] / (1e9 * cost.total / vector):.1f}" if batch and cost.by == "symofros" else "-"
    return (
        *_named(cost),
        *(str(cost.operations.get(kind, 0)) for kind in ("mul", "add", "div", "call")),
        _short(cost.time),
        _short(limit),
        f"{cost.time / limit:.1f}" if limit else "-",  # A Jacobian of one joint takes no operations.
        in_batch,
        str(cost.memory),
        f"{1e9 * cost.memory / copied:.2f}",
    )


def _growth(record: Record) -> Section:
    curves = growth(record)
    rows = tuple(
        (
            FUNCTIONS[c.function],
            c.quantity,
            c.who,
            f"{c.n[0]} ... {c.n[-1]}",
            f"{c.values[-1]:.0f}" if c.values[-1] >= 100 else f"{c.values[-1]:.3g}",
            f"{c.exponent:.2f}",
        )
        for c in curves
    )
    text = (
        "Over chains of generic bodies in space. The exponent is the slope on logarithmic axes, by least squares "
        "over seven joints and more: time = c n^exponent."
    )
    figures = [_growth_figure(curves, function) for function in dict.fromkeys(c.function for c in curves)]
    head = ("function", "quantity", "by", "joints", "#at the longest", "#exponent")
    return Section("Growth", (text, Table(head, rows), *figures), "growth")


def _growth_figure(curves: Sequence[Growth], function: str) -> Figure:
    charts = [_chart([c for c in curves if (c.function, c.quantity) == (function, quantity)]) for quantity in _DRAWN]
    said = (
        f"{_title(function)}: growth with the number of joints. Lower is cheaper; a steeper line grows faster, and the "
        "legend gives its exponent. Where two lines cross, the cheaper side changes."
    )
    return Figure(said, tuple(chart for chart in charts if chart.curves))


def _chart(curves: Sequence[Growth]) -> Chart:
    drawn = tuple(Curve(f"{c.who}, n^{c.exponent:.1f}", c.n, c.values, COLORS[c.who], "joined") for c in curves)
    quantity = curves[0].quantity if curves else ""
    axis = quantity if "[" in quantity else f"{quantity}  [1]"
    return Chart(quantity.partition(" [")[0].capitalize(), "joints n  [1]", axis, drawn, log="xy")


def _skipped(record: Record) -> Section:
    merged: dict[tuple[str, str, str], list[str]] = {}
    for model, function, peer, why in (*record.failed, *record.skipped):
        key = model, peer, why.splitlines()[0] if why else ""
        merged.setdefault(key, []).append(FUNCTIONS.get(function, function))
    rows = tuple(
        (TIMED_MODELS[model].title if model in TIMED_MODELS else model, peer, ", ".join(dict.fromkeys(names)), why)
        for (model, peer, why), names in merged.items()
    )
    return Section("What was not timed", (Table(("model", "side", "functions", "why"), rows),), "skipped")
