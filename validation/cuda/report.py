"""Kernels of some models on a graphics processor, or what they would take of one: the command and its report.

Rates are beside the bound by the memory, differences from C, and MuJoCo Warp is beside rollouts.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Any

import typer

import symofros as sf
from symofros.tools import present

from ..reporting.charts import logarithmic, style
from ..reporting.command import Quick, Run, known
from ..reporting.figures import Curve, Drawing, Figure
from ..reporting.numbers import counted, digits, times
from ..reporting.plain import plain, restored
from ..reporting.questions import failure_texts
from ..reporting.record import Data, Fact, Report, Section, Table, Text, Topic, verdict
from ..timing.models import Labelled
from . import kernels as measured
from . import warp
from .kernels import copied, kernels_of, rollout_rows, usages
from .record import PEER, TOLERANCES, KernelRow, PeerRow, Record, RolloutRow
from .states import STEP, STEPS, Subject

MODELS = ("panda", "ur5", "talos")
FUNCTIONS = (
    "dynamics",
    "mass_matrix",
    "bias",
    "forward_dynamics",
    "inverse_dynamics",
    "forward_dynamics_derivatives",
    "inverse_dynamics_derivatives",
)
# Kernels of derivatives of a humanoid take minutes to compile.
_LARGE = {"talos": ("dynamics", "mass_matrix", "bias", "forward_dynamics", "inverse_dynamics")}
# States that are compared with C's.
_STATES = 512
# Without a graphics processor kernels are compiled for this one.
_ARCHITECTURE = "sm_90"
_MODEL = f"Only this model; repeatable. {', '.join(MODELS)}."


def run_model(label: str, functions: tuple[str, ...], record: Record, run: Run) -> None:
    """Add rows of our kernels for a model to a record, and rollouts where a GPU is present."""
    device = present()
    subject = Subject.of(label, _STATES)
    kernels = kernels_of(subject, functions)
    run.expect(len(kernels), label)
    found = usages(kernels, record.architecture, os.cpu_count() or 1)
    for kernel, usage in zip(kernels, found, strict=True):
        run.advance(kernel.title)
        try:
            record.kernels.append(measured.row(kernel, usage, device))
        except sf.SymofrosError as error:
            record.failed.append((label, kernel.title, str(error)))
    if device is not None:
        run.advance(f"{label}: rollouts", steps=0)
        record.rollouts.extend(rollout_rows(subject, device))


def run_peer(label: str, record: Record, run: Run) -> None:
    """Add MuJoCo Warp's rows for a model to a record."""
    run.expect(len(warp.FUNCTIONS), f"{label}: {PEER} compiles its kernels")
    for peer in warp.rows(Subject.of(label, _STATES)):
        record.peers.append(peer)
        run.advance(f"{label}: {PEER}, {peer.task}")


def measure(
    run: Run,
    models: Annotated[list[str] | None, typer.Option("--model", help=_MODEL)] = None,
    quick: Quick = False,
) -> Data:
    """Check and time kernels on a graphics processor, beside C and MuJoCo Warp; without one: registers and spills."""
    labels = known(models, MODELS, "--model", "model")
    if quick:
        labels = labels[:1]
    device = present()
    # Without a graphics processor the report of a machine that has one stays.
    run.writes = run.asked or (device is not None and not models)
    record = Record(absent=warp.missing())
    record.architecture = device.architecture if device else _ARCHITECTURE
    if device is not None:
        record.device, record.copied = device.name, copied(device)
    parts: dict[str, Callable[[], None]] = {}
    for label in labels:
        chosen = FUNCTIONS[:1] if quick else _LARGE.get(label, FUNCTIONS)
        parts[label] = partial(run_model, label, chosen, record, run)
    if device is not None and not record.absent:
        parts |= {f"{label} by {PEER}": partial(run_peer, label, record, run) for label in labels}
    done = run.each(list(parts), lambda part: parts[part]())
    return {**done.head(record.ok, quick), **plain(record)}


_METHODS = {"semi_implicit_euler": "semi-implicit Euler", "rk4": "RK4"}


@dataclass(frozen=True)
class Goal(Labelled):
    """A rate that is to be reached with all arrays on the device.

    Attributes:
        model, function, precision: The kernel.
        rate: States a second.
    """

    model: str
    function: str
    precision: str
    rate: float


# Above a third of the bandwidth of an H100's memory.
GOALS = (Goal("panda", "dynamics", "single", 5e9), Goal("panda", "dynamics", "double", 2.5e9))
_INTRO = f"""Are kernels right on a graphics processor, and how near to the bound by its memory? One thread computes
one state; up to 2^21 states lie side by side on the device, and batches are started one behind the other, so that the
rate is the processor's. Share: the rate over that at which the memory, at the bandwidth of a kernel that copies,
would be busy all the time with the arrays of a state. Spills are bytes that a thread moves beside because registers
ran out. Differences from C are over 512 states, relative to a state's largest entry; {TOLERANCES["double"]:.0e} is
asked for in double precision and {TOLERANCES["single"]:.0e} in single, as solving M amplifies rounding. Fused:
products and sums round once."""
_ROLLOUTS = f"""Motions of 2^18 states over {STEPS} steps of {1e3 * STEP:g} ms in one kernel, all together;
differences are of the configurations at the end, from `simulate_batch`."""
_PEER = f"""{PEER} in single precision, its calls captured in a graph, without contacts, constraints and limits, with
as many states in a call as it is the fastest with. "M + h" are the five calls that both need, "forward dynamics" is
`forward`, a step is `step` by semi-implicit Euler. Ours beside it is in single precision, not fused, and rolled out
by the same method. Its differences from C are of the bias, of accelerations, and of the configurations after {STEPS}
steps."""
_NONE = """No graphics processor was at hand: registers and spills are the assembler's; nothing was run."""


def compose(data: Data) -> Report:
    """The report of its JSON."""
    record = restored(Record, data)
    failures = data.get("failures", {})
    failed = tuple(Text(f"{model}: {what}: {reason}", "bad") for model, what, reason in record.failed)
    return Report(
        "Graphics processor: kernels beside C, rollouts beside MuJoCo Warp",
        _summary(record),
        bool(data["ok"]) and all(_reached(record, goal) is not False for goal in GOALS),
        (_INTRO, *failure_texts(failures), *failed),
        tuple(_sections(record)),
        facts=tuple(_facts(record)),
        unfinished=tuple(data.get("unfinished", ())),
        decisions=(_goals(record),),
    )


def _summary(record: Record) -> str:
    if not record.device:
        kernels = counted(len(record.kernels), "kernel")
        return f"{kernels} compiled for {record.architecture}; none was run: no graphics processor was at hand."
    worst = max((row.error for row in record.kernels if row.precision == "double"), default=0.0)
    slower = [row for row in record.peers if _ours(record, row) > row.rate]
    wrongly = f" {counted(record.wrong, 'row')} further from C than is asked for." if record.wrong else ""
    kernels, rates = counted(len(record.kernels), "kernel"), counted(len(record.peers), "rate")
    return (
        f"{record.device}: {kernels} differ from C by at most {digits(worst)} in double precision; "
        f"ours is faster than {PEER} in {len(slower)} of {rates}.{wrongly}"
    )


def _rate(record: Record, goal: Goal) -> float | None:
    """The best of the fused and the other kernel; None without a measurement."""
    rates = [
        row.rate
        for row in record.kernels
        if (row.model, row.function, row.precision) == (goal.model, goal.function, goal.precision) and row.rate > 0.0
    ]
    return max(rates, default=None)


def _reached(record: Record, goal: Goal) -> bool | None:
    rate = _rate(record, goal)
    return None if rate is None else rate >= goal.rate


def _goals(record: Record) -> Table:
    lines = []
    for goal in GOALS:
        rate, reached = _rate(record, goal), _reached(record, goal)
        shown = "not measured" if rate is None else verdict(f"{rate:.2e}", reached)
        lines.append((goal.title, goal.task, goal.precision, f"{goal.rate:.1e}", shown))
    return Table(("model", "function", "precision", "asked [states/s]", "reached [states/s]"), tuple(lines))


def _facts(record: Record) -> Iterable[Fact]:
    for row in record.peers:
        if row.model == "panda":
            yield Fact(times(_ours(record, row) / row.rate), f"{row.title}, {row.task}: our rate over that of {PEER}")


def _ours(record: Record, peer: PeerRow) -> float:
    """Our rate beside the peer's, in single precision; 0 where there is none."""
    if peer.function == "step":
        found = [x.rate for x in record.rollouts if x.method == "semi_implicit_euler" and _same(x, peer)]
    else:
        found = [x.rate for x in record.kernels if not x.fused and x.function == peer.function and _same(x, peer)]
    return next(iter(found), 0.0)


def _same(row: KernelRow | RolloutRow, peer: PeerRow) -> bool:
    return row.model == peer.model and row.precision == "single"


def _sections(record: Record) -> Iterable[Section]:
    beside = (_PEER, _peer_table(record)) if record.peers else (Text(record.absent or _NONE, "soft"),)
    yield Section(f"Beside {PEER}", beside, "warp")
    if record.rollouts:
        yield Section("Rollouts", (_ROLLOUTS, _rollout_table(record.rollouts)), "rollouts")
    first = _figure(record) if record.device else _NONE
    yield Section("Kernels", (first, _kernel_table(record)), "kernels")


def _share(row: KernelRow, copied: float) -> str:
    share = row.rate * row.moved / copied
    return f"{share:.0%}" if share == share else "-"


def _kernel_table(record: Record) -> Table:
    lines = [
        (
            row.title,
            row.task,
            row.precision,
            "yes" if row.fused else "no",
            str(row.registers),
            str(row.spilled),
            str(row.moved),
            f"{row.rate:.2e}" if row.rate > 0.0 else "-",
            _share(row, record.copied),
            verdict(digits(row.error), row.right) if row.rate > 0.0 else "-",
        )
        for row in record.kernels
    ]
    heads = ("model", "function", "precision", "fused", "registers", "spills [B]", "arrays [B]", "states/s", "share")
    return Table.by_group((*heads, "difference from C"), lines)


def _rollout_table(rows: list[RolloutRow]) -> Table:
    lines = [
        (row.title, _METHODS[row.method], row.precision, f"{row.rate:.2e}", verdict(digits(row.error), row.right))
        for row in rows
    ]
    return Table.by_group(("model", "method", "precision", "steps/s", "difference from C"), lines)


def _peer_table(record: Record) -> Table:
    lines = [
        (
            row.title,
            row.task,
            f"{_ours(record, row):.2e}",
            f"{row.rate:.2e}",
            times(_ours(record, row) / row.rate),
            str(row.states),
            digits(row.error),
        )
        for row in record.peers
    ]
    heads = ("model", "function", "ours [1/s]", f"{PEER} [1/s]", "ours over it", "its states a call", "its difference")
    return Table.by_group(heads, lines)


def _figure(record: Record) -> Figure:
    model = record.kernels[0]
    shown = [row for row in record.kernels if row.model == model.model]
    functions = list(dict.fromkeys(row.function for row in shown))
    caption = f"""{model.title}. Look at how near the marks of our kernels come to the bound by the memory of their
    precision, and how far to the left {PEER} is: a decade is a factor of ten."""
    drawing = Drawing(
        f"{record.device}: states a second",
        "rate  [states/s]",
        "",
        partial(_paint, record, shown, functions),
        size=(640.0, 40.0 * len(functions) + 40.0),
    )
    return Figure(caption, (drawing,))


def _paint(record: Record, shown: list[KernelRow], functions: list[str], axes: Any) -> None:
    line = {function: -k for k, function in enumerate(functions)}

    def series(kept: Callable[[KernelRow], bool], value: Callable[[KernelRow], float]) -> list[tuple[float, float]]:
        return [(value(row), line[row.function]) for row in shown if kept(row) and not row.fused]

    curves: dict[str, list[tuple[float, float]]] = {
        "double": series(lambda row: row.precision == "double", lambda row: row.rate),
        "double: bound by the memory": series(
            lambda row: row.precision == "double", lambda row: record.copied / row.moved
        ),
        "single": series(lambda row: row.precision == "single", lambda row: row.rate),
        "single: bound by the memory": series(
            lambda row: row.precision == "single", lambda row: record.copied / row.moved
        ),
        f"{PEER}, single": [
            (row.rate, line[row.function])
            for row in record.peers
            if row.model == shown[0].model and row.function in line
        ],
    }
    for k, (label, places) in enumerate(curves.items()):
        if places:
            rates, lines = [x for x, _ in places], [y for _, y in places]
            axes.plot(rates, lines, **style(Curve(label, (), (), k, "points"), 8.0))
    tasks = {row.function: row.task for row in shown}
    axes.set_yticks(list(line.values()), [tasks[function] for function in functions])
    axes.set_ylim(0.6 - len(functions), 0.6)
    axes.set_xscale("log")
    logarithmic(axes.xaxis)


_QUESTION = "Is it right and fast on a graphics processor?"
TOPIC = Topic("cuda", "Speed", _QUESTION, compose, measure)
