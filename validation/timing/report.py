"""How fast the C is: what is measured, in parts if wanted, and the report."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from statistics import median
from typing import Annotated, Any

import typer

from validation.reporting.command import Run, known
from validation.reporting.figures import Chart, Curve, Mark
from validation.reporting.numbers import counted, times
from validation.reporting.record import Data, Fact, Report, Section, Table, Topic
from validation.timing.contestants.programs import BuildError
from validation.timing.flexible.race import LABEL, run_flexible
from validation.timing.flexible.report import flexible_section
from validation.timing.models import FUNCTIONS, TIMED_MODELS
from validation.timing.record import Entry, Record, as_data, of, read
from validation.timing.run import facts, jobs, load, prepare, run_job
from validation.timing.tables import sections, targets_table
from validation.timing.targets import verdicts
from validation.timing.task import STATES
from validation.timing.worker import PEERS, Job

# Four times through the copies of a library.
REPEATS = 24
LIMITS = (
    "One thread, pinned to one processor, whose time on it is what is measured. All sides of a function run in one "
    "process, in turns of 10 ms or more, each a loop in C over the same random states; before, each side's results "
    "are compared with ours, to 1e-12 of the largest entry (1e-9 where a system is solved), and sides that differ are "
    "not timed. Cells hold minimum and median over the repeats, in nanoseconds a state; ratios are of medians, the "
    "peer's to ours.",
    "Ours is generated C, one state after the other through the public header, in the fastest of its builds by gcc "
    "and clang (Options(tune=True)), and (batch) several at a time by vectors, likewise, in calls of 64 states, or of "
    "as many as keep their results within 384 KiB, by rows, by columns, and by columns of floats (checked to 5e-4, "
    "2^29 times as coarse); results replace each other as those of the engines do, and copies of the library compute "
    "them in turn, because where its code happens to lie matters; so with CasADi's and SymPy's. Pinocchio is its own "
    "headers, compiled in the run by gcc and by clang, in the faster of its two conventions; MuJoCo is its wheel's "
    "own library; CasADi is the C that it makes of composite-rigid-body, Newton-Euler and articulated-body "
    "recursions, in the best of four builds, gcc and clang with -O3 and -O3 -ffast-math; SymPy is Kane's equations "
    "and common subexpressions, built alike. Friction and springs in joints are taken out. Machines are noisy: quote "
    "a ratio rather than a time.",
)
# What a simulation asks for at each step: shown in the index.
_TELLING = ("dynamics", "forward_dynamics")


def measure(
    run: Run,
    models: Annotated[list[str] | None, typer.Option("--model", help="Only this model; repeatable.")] = None,
    peers: Annotated[list[str] | None, typer.Option("--peer", help=f"Only this peer: {', '.join(PEERS)}.")] = None,
    functions: Annotated[list[str] | None, typer.Option("--function", help="Only this function; repeatable.")] = None,
    repeats: Annotated[int, typer.Option(min=3, help="Interleaved repeats.")] = REPEATS,
    states: Annotated[int, typer.Option(min=64, help="Random states.")] = STATES,
    resume: Annotated[bool, typer.Option("--resume", help="Leave out what the report has figures of.")] = False,
) -> Data:
    """Time generated C against Pinocchio's C++, MuJoCo's C, C by CasADi and by SymPy, and Exudyn's flexible robot.

    A part that is chosen replaces that part of the report's figures; the whole starts afresh. Ctrl-C keeps what was
    measured.
    """
    chosen = known(models, [*TIMED_MODELS, LABEL], "--model", "model")
    record = read(run.folder / "timing.json") if models or peers or functions or resume else Record()
    todo = jobs(
        [name for name in chosen if name in TIMED_MODELS],
        tuple(known(peers, PEERS, "--peer", "peer")),
        known(functions, FUNCTIONS, "--function", "function"),
        repeats,
        states,
        record if resume else None,
    )
    flexible = LABEL in models if models else not (peers or functions) and not (resume and record.flexible)
    measures = bool(todo) or flexible
    before, limits = load(), facts() if measures else {}

    def data(unfinished: Sequence[str] = ()) -> dict[str, Any]:
        if measures:
            record.machine = {
                **limits,
                "load before and after": [*before, *load()],
                "date": time.strftime("%Y-%m-%d %H:%M UTC", time.gmtime()),
                "states": states,
                "repeats": repeats,
            }
        return as_data(record) | {"unfinished": list(unfinished)}

    left = [*(job.model for job in todo), *([LABEL] if flexible else [])]
    run.expect(sum(len(job.functions) for job in todo) + int(flexible), "compiling the engines")
    try:
        for failure in prepare({peer for job in todo for peer in job.peers}):
            run.say(failure, bad=True)
        for job in todo:
            _time(job, record, run)
            left.remove(job.model)
            run.save(data())  # So that even a kill leaves what was measured.
        if flexible:
            _time_flexible(record, repeats, run)
    except KeyboardInterrupt:
        return data(left)
    return data()


def _time(job: Job, record: Record, run: Run) -> None:
    """One model; what could not be timed is told."""
    skipped, failed = len(record.skipped), len(record.failed)
    run_job(job, record, lambda model, function: run.advance(f"{model}: {FUNCTIONS[function]}"))
    for notes, bad in ((record.skipped[skipped:], False), (record.failed[failed:], True)):
        for model, function, peer, why in notes:
            run.say(f"not timed: {model}, {function}, {peer}: {why}", bad)


def _time_flexible(record: Record, repeats: int, run: Run) -> None:
    run.advance(LABEL)
    try:
        record.flexible = [asdict(row) for row in run_flexible(repeats)]
    except BuildError as error:
        record.failed.append((LABEL, "M + h", "exudyn", str(error)))
        run.say(f"not timed: {error}", bad=True)


def compose(data: Data) -> Report:
    """The report of its JSON."""
    record = of(data)
    judged = verdicts(record)
    measured = [verdict for verdict in judged if verdict.entry is not None]
    met = sum(verdict.met for verdict in measured)
    best = _best(record)
    functions, models = ({getattr(row, name) for row in best} for name in ("function", "model"))
    said = f"{met} of {len(judged)} targets are met"
    said += f", {len(judged) - len(measured)} were not measured" if len(measured) < len(judged) else ""
    failed = f"; {len(record.failed)} could not be timed" if record.failed else ""
    cut = f" Interrupted: {', '.join(data['unfinished'])} not timed." if data.get("unfinished") else ""
    sizes = f"{counted(len(models), 'model')} and {counted(len(functions), 'function')}"
    key = [Fact(f"{met} of {len(judged)}", "targets are met", met == len(measured))]
    medians = []
    for peer in dict.fromkeys(row.peer for row in best):
        ratios = [row.ratio for row in best if row.peer == peer]
        medians.append(f"{peer} {times(median(ratios))}")
        span = f"{times(min(ratios))} to {times(max(ratios))}"
        key.append(Fact(times(median(ratios)), f"{peer}'s time over ours, median of {len(ratios)}; {span}"))
    flexible = [flexible_section(record.flexible)] if record.flexible else []
    machine = Section("What times depend on", (Table(("what", "value"), tuple(_facts(record.machine))),))
    return Report(
        "Timing: generated C against engines and symbolic peers",
        f"{said}; {counted(len(best), 'race')} over {sizes}; median of their time over ours: "
        f"{', '.join(medians)}{failed}.{cut}",
        met == len(measured) and not record.failed if measured or record.failed else None,
        LIMITS,
        (*sections(record), *flexible, machine),
        tuple(key),
        tuple(_ratios(best, name) for name in _TELLING if name in functions),
        (targets_table(record),),
        tuple(data.get("unfinished", ())),
    )


def _best(record: Record) -> list[Entry]:
    """Each peer's fastest build of each function of each model."""
    best: dict[tuple[str, str, str], Entry] = {}
    for row in record.entries:
        key = row.model, row.function, row.peer
        if key not in best or row.peer_time[1] < best[key].peer_time[1]:
            best[key] = row
    return list(best.values())


def _ratios(rows: Sequence[Entry], function: str) -> Chart:
    """Their time over ours, over the size of the model; a point a model."""
    chosen = [row for row in rows if row.function == function]
    curves = []
    for k, peer in enumerate(dict.fromkeys(row.peer for row in chosen)):
        x, y = zip(*sorted((row.nv, row.ratio) for row in chosen if row.peer == peer), strict=True)
        curves.append(Curve(peer, x, y, k, "points", k % 4))
    return Chart(
        f"{FUNCTIONS[function]}: their time over ours, a point a model",
        "speeds of the model  [1]",
        "ratio of medians  [1]",
        tuple(curves),
        (Mark("as fast as we", 1.0),),
        log="xy",
    )


def _facts(machine: Mapping[str, Any]) -> list[tuple[str, str]]:
    """What times depend on, in words."""
    listed = []
    for name, value in machine.items():
        if isinstance(value, Mapping):
            listed += [(f"{name}: {part}", str(what)) for part, what in value.items()]
        elif name in ("scalar_flops", "vector_flops", "copied_bytes"):
            unit = "GB/s copied in the first cache" if name == "copied_bytes" else f"GFlop/s, {name.partition('_')[0]}"
            listed.append(("measured limit of a core", f"{value / 1e9:.1f} {unit}"))
        elif isinstance(value, list):
            listed.append((name, "; ".join(f"{x:.1f}" if isinstance(x, float) else str(x) for x in value)))
        else:
            listed.append((name, f"{value:g}" if isinstance(value, float) else str(value)))
    return listed


TOPIC = Topic("timing", "Speed", "How fast is the C against engines and other generators?", compose)
