"""A record as sections of the report: paragraphs, tables, figures."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from validation.reporting.figures import Chart, Curve, Figure, Mark
from validation.reporting.record import Block, Cell, Section, Table
from validation.timing.growth import Growth, growth
from validation.timing.models import FUNCTIONS, TIMED_MODELS
from validation.timing.record import Entry, Made, Record
from validation.timing.targets import Verdict, verdicts

_GENERATORS = ("symofros", "casadi", "sympy")
_PEERS = {"pinocchio": "Pinocchio", "mujoco": "MuJoCo", "casadi": "CasADi", "sympy": "SymPy"}
# What growth is drawn of.
_DRAWN = ("time [ns]", "operations", "generation [s]", "compilation [s]")
# What a simulation asks for at each step: ratios are drawn of it.
_RACED = ("dynamics", "forward_dynamics")
_KINDS = ("mul", "add", "div", "call")
COLORS = {"symofros": 0, "symofros, batch": 2, "pinocchio": 1, "mujoco": 5, "casadi": 6, "sympy": 7}

TARGETS_TEXT = (
    "Ratios of medians, the peer's to ours, each of one race. A peer's best is the fastest of its builds and ways, "
    "chosen by its median alone. Batches are column by column: the states are the fast axis (NumPy's Fortran order), "
    "and arrays are read and written in place; beside them the same by rows."
)
_TARGETS = """model = {target.title}; function = {target.task}; ours = {target.how}; against = peer(); #ratio = ratio();
    #by rows = {by_rows:.2f}; #target = {target.least:g}; verdict = {statement}; measured as = variant()"""
_MADE = "model = {title}; function = {task}; by"
_MAKING_TEXT = (
    "Generation is from the description to C text, the processor's time; compilation is of that text alone, by the "
    "build that runs fastest, by the clock, at whatever load the machine had then: it is done once and kept."
)
_MAKING = f"""{_MADE}; #generation [s] = {{generation:.3f}}; #compilation [s] = {{compilation:.2f}};
    #C text [kB] = {{text:1e-3*.1f}}; #machine code [kB] = {{code:1e-3*.1f}}; 
    #constants [kB] = {{constants:1e-3*.1f}}"""
_LIMITS_TEXT = (
    "Operations are what one call executes; a sine or cosine counts as one. Distance is the measured time over "
    "that of the same operations at this core's measured peak, {:.1f} GFlop/s in fused multiply-adds, and for batches "
    "{:.0f} GFlop/s in vectors: 1 is the limit of code in which every multiplication has an addition to go with, and "
    "calls cost far more than the one operation that they count. Memory is what a call reads and writes; its limit is "
    "the time it takes at the {:.0f} GB/s of copies in the core's first cache."
)
_LIMITS = f"""{_MADE}; #mul = {{mul}}; #add = {{add}}; #div = {{div}}; #calls = {{call}}; #time [ns] = {{time:compact}};
    #limit [ns] = {{limit:compact}}; #distance = {{distance:.1f}}; #of batches = {{batches:.1f}};
    #memory [B] = {{memory}}; #its limit [ns] = {{copying:.2f}}"""
_GROWTH_TEXT = (
    "Over chains of generic bodies in space, and over four-bars in a row, each closed with its neighbours. An exponent "
    "is the slope on logarithmic axes, by least squares over sizes of seven and more: time = c n^exponent."
)
_GROWTH = """function = {task}; n = {family}; quantity; by = {who}; sizes = {n[0]} ... {largest};
    #at the largest = {last:compact}; #exponent = {exponent:.2f}"""
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
_TIMES = f"""model; #nv; #ours = {{generated_time:compact}}; #batch, rows = {{batch:compact}};
    #columns = {{columns:compact}}; #floats = {{single:compact}};
    #Pinocchio, gcc = {{gcc:compact}}; #Pinocchio, best = {{pinocchio:compact}};
    {"; ".join(f"#{name} = {{{peer}:compact}}" for peer, name in _PEERS.items() if peer != "pinocchio")}"""
_RATIOS = f"""model; #nv; #Pinocchio = {{pinocchio ratio:.2f}}; #batch by rows = {{batch_ratio:.1f}};
    #batch by columns = {{columns_ratio:.1f}};
    {"; ".join(f"#{name} = {{{peer} ratio:.2f}}" for peer, name in _PEERS.items() if peer != "pinocchio")}"""


def sections(record: Record) -> list[Section]:
    """Times of each function, growth, costs, limits, and what is missing."""
    costs = (record.cost(model, function, by) for model in TIMED_MODELS for function in FUNCTIONS for by in _GENERATORS)
    made = [cost for cost in costs if cost is not None]
    return [
        *(_function(record, name) for name in FUNCTIONS),
        _growth(record),
        Section("What it costs to make", (_MAKING_TEXT, Table.of(made, _MAKING)), "making"),
        _limits(record, made),
        _skipped(record),
    ]


def targets_table(record: Record) -> Table:
    """Each target and what was found."""

    def peer(verdict: Verdict) -> str:
        return ", ".join(filter(None, (verdict.target.peer, verdict.target.family)))

    def ratio(verdict: Verdict) -> str | Cell:
        return Cell(f"{verdict.ratio:.2f}", verdict.met) if verdict.entry else "-"

    def variant(verdict: Verdict) -> str:
        return verdict.entry.variant if verdict.entry else ""

    return Table.of(verdicts(record), _TARGETS, peer=peer, ratio=ratio, variant=variant)


def ratios(rows: Sequence[Entry]) -> Figure:
    """Their time over ours, over the size of the model; a point a model."""
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


def _limits(record: Record, made: Sequence[Made]) -> Section:
    """Costs against what the machine could do at its best."""
    peaks = [record.machine.get(name, math.nan) / 1e9 for name in ("scalar_flops", "vector_flops", "copied_bytes")]
    flops, vector, copied = peaks
    rows = []
    for cost in made:
        alike = (x for x in record.entries if (x.model, x.function) == (cost.model, cost.function) and x.batch)
        batch = next((x.columns or x.batch for x in alike), None) if cost.by == "symofros" else None
        # A Jacobian of one joint takes no operations.
        limit, kinds = cost.total / flops or None, {kind: cost.operations.get(kind, 0) for kind in _KINDS}
        far = {"distance": limit and cost.time / limit, "batches": batch and limit and batch[1] / cost.total * vector}
        named = {"title": cost.title, "task": cost.task, "limit": limit, "copying": cost.memory / copied}
        rows.append({**vars(cost), **kinds, **named, **far})
    return Section("How far from the machine's limit", (_LIMITS_TEXT.format(*peaks), Table.of(rows, _LIMITS)), "limits")


def _growth(record: Record) -> Section:
    curves = growth(record)
    drawn = dict.fromkeys((c.family, c.function) for c in curves)
    figures = [_growth_figure([c for c in curves if (c.family, c.function) == key], *key) for key in drawn]
    rows = [{**vars(c), "task": FUNCTIONS[c.function], "largest": c.n[-1], "last": c.values[-1]} for c in curves]
    return Section("Growth", (_GROWTH_TEXT, Table.of(rows, _GROWTH), *figures), "growth")


def _growth_figure(curves: Sequence[Growth], family: str, function: str) -> Figure:
    charts = [_chart(quantity, family, [c for c in curves if c.quantity == quantity]) for quantity in _DRAWN]
    said = (
        f"{_title(function)}: growth with the number of {family}. Lower is cheaper; a steeper line grows faster, and "
        "the legend gives its exponent. Where two lines cross, the cheaper side changes."
    )
    return Figure(said, tuple(chart for chart in charts if chart.curves))


def _chart(quantity: str, family: str, curves: Sequence[Growth]) -> Chart:
    drawn = tuple(Curve(f"{c.who}, n^{c.exponent:.1f}", c.n, c.values, COLORS[c.who], "joined") for c in curves)
    axis = quantity if "[" in quantity else f"{quantity}  [1]"
    return Chart(quantity.partition(" [")[0].capitalize(), f"{family} n  [1]", axis, drawn, log="xy")


def _skipped(record: Record) -> Section:
    merged: dict[tuple[str, str, str], list[str]] = {}
    for model, function, peer, why in (*record.failed, *record.skipped):
        key = TIMED_MODELS[model].title if model in TIMED_MODELS else model, peer, why.partition("\n")[0]
        merged.setdefault(key, []).append(FUNCTIONS.get(function, function))
    rows = ((*key, ", ".join(dict.fromkeys(names))) for key, names in merged.items())
    table = Table.of(rows, "model = {0}; side = {1}; functions = {3}; why = {2}")
    return Section("What was not timed", (table,), "skipped")
