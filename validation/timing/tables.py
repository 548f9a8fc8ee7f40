"""A record as sections of the report: paragraphs, tables, figures."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from validation.reporting.figures import Chart, Curve, Figure
from validation.reporting.numbers import compact
from validation.reporting.record import Block, Cell, Column, Section, Table
from validation.timing.growth import Growth, growth
from validation.timing.models import FUNCTIONS, TIMED_MODELS
from validation.timing.record import Made, Record
from validation.timing.targets import verdicts

_GENERATORS = ("symofros", "casadi", "sympy")
_PEERS = {"pinocchio": "Pinocchio", "mujoco": "MuJoCo", "casadi": "CasADi", "sympy": "SymPy"}
# What growth is drawn of.
_DRAWN = ("time [ns]", "operations", "generation [s]", "compilation [s]")
COLORS = {"symofros": 0, "symofros, batch": 2, "pinocchio": 1, "mujoco": 5, "casadi": 6, "sympy": 7}


def sections(record: Record) -> list[Section]:
    """All that have something to show."""
    made = [
        Section("Targets", (_TARGETS_TEXT, targets_table(record)), "targets"),
        *(_function(record, name) for name in FUNCTIONS),
        _growth(record),
        Section("What it costs to make", (_MAKING_TEXT, Table.of(_costs(record), _MAKING)), "making"),
        _limits(record),
        _skipped(record),
    ]
    return [section for section in made if section.shows]


_TARGETS_TEXT = (
    "Ratios of medians, the peer's to ours, each of one race. A peer's best is the fastest of its builds and ways, "
    "chosen by its median alone. Batches are column by column: the states are the fast axis (NumPy's Fortran order), "
    "and arrays are read and written in place; beside them the same by rows."
)
_TARGETS: dict[str, Column] = {
    "model": lambda v: TIMED_MODELS[v.target.model].title,
    "function": lambda v: FUNCTIONS[v.target.function],
    "ours": lambda v: {"scalar": "state by state", "columns": "batch by columns"}[v.target.how],
    "against": lambda v: ", ".join(filter(None, (v.target.peer, v.target.family))),
    "#ratio": lambda v: Cell(f"{v.ratio:.2f}", v.met) if v.entry else "-",
    "#by rows": lambda v: "" if v.by_rows is None else f"{v.by_rows:.2f}",
    "#target": lambda v: f"{v.target.least:g}",
    "verdict": lambda v: v.statement,
    "measured as": lambda v: v.entry.variant if v.entry else "",
}


def targets_table(record: Record) -> Table:
    """Each target and what was found."""
    return Table.of(verdicts(record), _TARGETS)


_TIMES: dict[str, Column] = {
    "model": "{model}",
    "#nv": "{nv}",
    "#ours": "{generated_time:compact}",
    "#batch, rows": "{batch:compact}",
    "#columns": "{columns:compact}",
    "#floats": "{single:compact}",
    "#Pinocchio, gcc": "{gcc:compact}",
    "#Pinocchio, best": "{pinocchio:compact}",
    **{f"#{name}": f"{{{peer}:compact}}" for peer, name in _PEERS.items() if peer != "pinocchio"},
}
_RATIOS: dict[str, Column] = {
    "model": "{model}",
    "#nv": "{nv}",
    "#Pinocchio": "{pinocchio ratio:.2f}",
    "#batch by rows": "{batch_ratio:.1f}",
    "#batch by columns": "{columns_ratio:.1f}",
    **{f"#{name}": f"{{{peer} ratio:.2f}}" for peer, name in _PEERS.items() if peer != "pinocchio"},
}
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


def _function(record: Record, function: str) -> Section:
    """Times of one function, and beside them, in a table of its own, the ratios: one alone fits a page."""
    rows = [row for model in TIMED_MODELS if (row := _races(record, model, function))]
    blocks: tuple[Block, ...] = (
        *filter(None, (_NOTES.get(function),)),
        "Nanoseconds a state, minimum and median:",
        Table.of(rows, _TIMES).without_empty(),
        "Ratios of medians, the peer's to ours:",
        Table.of(rows, _RATIOS).without_empty(),
    )
    return Section(_title(function), blocks, function)


def _races(record: Record, model: str, function: str) -> dict[str, Any]:
    """The best race of each peer in one function of one model; nothing where there is none."""
    best = {peer: record.best(model, function, peer) for peer in _PEERS}
    first = next(filter(None, best.values()), None)
    if first is None:
        return {}
    best["gcc"] = record.best(model, function, "pinocchio", "gcc")
    row: dict[str, Any] = {"model": TIMED_MODELS[model].title, "nv": first.nv}
    row |= {name: getattr(first, name) for name in ("generated_time", "batch", "columns", "single")}
    row |= {name: getattr(best["pinocchio"], name, None) for name in ("batch_ratio", "columns_ratio")}
    for peer, entry in best.items():
        row |= {peer: getattr(entry, "peer_time", None), f"{peer} ratio": getattr(entry, "ratio", None)}
    return row


def _title(function: str) -> str:
    """A sentence's beginning, unless it begins with a symbol."""
    name = FUNCTIONS[function]
    return name if len(name.split()[0]) == 1 else name[0].upper() + name[1:]


def _costs(record: Record) -> list[Made]:
    """Costs of the fastest build of each side."""
    costs = (record.cost(model, function, by) for model in TIMED_MODELS for function in FUNCTIONS for by in _GENERATORS)
    return [cost for cost in costs if cost is not None]


_MAKING_TEXT = (
    "Generation is from the description to C text, the processor's time; compilation is of that text alone, by the "
    "build that runs fastest, by the clock, at whatever load the machine had then: it is done once and kept."
)
_COST: dict[str, Column] = {
    "model": lambda cost: TIMED_MODELS[cost.model].title,
    "function": lambda cost: FUNCTIONS[cost.function],
    "by": "{by}",
}
_MAKING = {
    **_COST,
    "#generation [s]": "{generation:.3f}",
    "#compilation [s]": "{compilation:.2f}",
    "#C text [kB]": "{text:1e-3*.1f}",
    "#machine code [kB]": "{code:1e-3*.1f}",
    "#constants [kB]": "{constants:1e-3*.1f}",
}


def _limits(record: Record) -> Section:
    flops, vector, copied = (
        record.machine.get(name, math.nan) for name in ("scalar_flops", "vector_flops", "copied_bytes")
    )
    text = (
        "Operations are what one call executes; a sine or cosine counts as one. Distance is the measured time over "
        f"that of the same operations at this core's measured peak, {flops / 1e9:.1f} GFlop/s in fused multiply-adds, "
        f"and for batches {vector / 1e9:.0f} GFlop/s in vectors: 1 is the limit of code in which every multiplication "
        "has an addition to go with, and calls cost far more than the one operation that they count. Memory is what a "
        f"call reads and writes; its limit is the time it takes at the {copied / 1e9:.0f} GB/s of copies in the "
        "core's first cache."
    )

    def distance(cost: Made) -> str:
        # A Jacobian of one joint takes no operations.
        return f"{cost.time / (1e9 * cost.total / flops):.1f}" if cost.total else "-"

    def distance_of_batches(cost: Made) -> str:
        alike = (x for x in record.entries if (x.model, x.function) == (cost.model, cost.function) and x.batch)
        time = next((x.columns or x.batch for x in alike), None) if cost.by == "symofros" else None
        return f"{time[1] / (1e9 * cost.total / vector):.1f}" if time else "-"

    columns: dict[str, Column] = {
        **_COST,
        **{f"#{title}": _operations(title.rstrip("s")) for title in ("mul", "add", "div", "calls")},
        "#time [ns]": "{time:compact}",
        "#limit [ns]": lambda cost: compact(1e9 * cost.total / flops),
        "#distance": distance,
        "#of batches": distance_of_batches,
        "#memory [B]": "{memory}",
        "#its limit [ns]": lambda cost: f"{1e9 * cost.memory / copied:.2f}",
    }
    return Section("How far from the machine's limit", (text, Table.of(_costs(record), columns)), "limits")


def _operations(kind: str) -> Column:
    return lambda cost: str(cost.operations.get(kind, 0))


_GROWTH_TEXT = (
    "Over chains of generic bodies in space. The exponent is the slope on logarithmic axes, by least squares over "
    "seven joints and more: time = c n^exponent."
)
_GROWTH: dict[str, Column] = {
    "function": lambda curve: FUNCTIONS[curve.function],
    "quantity": "{quantity}",
    "by": "{who}",
    "joints": lambda curve: f"{curve.n[0]} ... {curve.n[-1]}",
    "#at the longest": lambda curve: format(curve.values[-1], ".0f" if curve.values[-1] >= 100 else ".3g"),
    "#exponent": "{exponent:.2f}",
}


def _growth(record: Record) -> Section:
    found = growth(record)
    figures = [_growth_figure(found, function) for function in dict.fromkeys(c.function for c in found)]
    return Section("Growth", (_GROWTH_TEXT, Table.of(found, _GROWTH), *figures), "growth")


def _growth_figure(found: Sequence[Growth], function: str) -> Figure:
    charts = [_chart(q, [c for c in found if (c.function, c.quantity) == (function, q)]) for q in _DRAWN]
    said = (
        f"{_title(function)}: growth with the number of joints. Lower is cheaper; a steeper line grows faster, and the "
        "legend gives its exponent. Where two lines cross, the cheaper side changes."
    )
    return Figure(said, tuple(chart for chart in charts if chart.curves))


def _chart(quantity: str, found: Sequence[Growth]) -> Chart:
    drawn = tuple(Curve(f"{c.who}, n^{c.exponent:.1f}", c.n, c.values, COLORS[c.who], "joined") for c in found)
    axis = quantity if "[" in quantity else f"{quantity}  [1]"
    return Chart(quantity.partition(" [")[0].capitalize(), "joints n  [1]", axis, drawn, log="xy")


def _skipped(record: Record) -> Section:
    merged: dict[tuple[str, str, str], list[str]] = {}
    for model, function, peer, why in (*record.failed, *record.skipped):
        key = TIMED_MODELS[model].title if model in TIMED_MODELS else model, peer, why.partition("\n")[0]
        merged.setdefault(key, []).append(FUNCTIONS.get(function, function))
    rows = tuple((model, peer, ", ".join(dict.fromkeys(names)), why) for (model, peer, why), names in merged.items())
    return Section("What was not timed", (Table(("model", "side", "functions", "why"), rows),), "skipped")
