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
from validation.reporting.plain import restored
from validation.reporting.record import Data, Fact, Report, Topic
from validation.timing.contestants.programs import BuildError
from validation.timing.flexible.race import LABEL, run_flexible
from validation.timing.flexible.report import flexible_section
from validation.timing.models import FUNCTIONS, TIMED_MODELS
from validation.timing.record import Entry, Record, as_data, read
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
    "not timed. Cells hold minimum and median over the repeats, in nanoseconds a state; ratios are of medians, theirs "
    "to ours. Machines are noisy: quote a ratio rather than a time.",
    "Ours is generated C, one state after the other, in the fastest of its builds by gcc and clang "
    "(Options(tune=True)), and by vectors in calls of 64 states, or of as many as keep their results within 384 KiB: "
    "by rows, by columns, and by columns of floats (checked to 5e-4). Copies of our library, of CasADi's and of "
    "SymPy's compute in turn, because where code happens to lie matters. Pinocchio is its own headers, compiled in the "
    "run by gcc and by clang, in the faster of its two conventions; MuJoCo is its wheel's library; CasADi is the C of "
    "its composite-rigid-body, Newton-Euler and articulated-body recursions, SymPy Kane's equations with common "
    "subexpressions, both in the best of four builds (gcc and clang, -O3 with and without -ffast-math). Friction and "
    "springs in joints are taken out.",
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
    record = restored(Record, data)
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
    return Report(
        "Timing: generated C against engines and symbolic peers",
        f"{said}; {counted(len(best), 'race')} over {sizes}; median of their time over ours: "
        f"{', '.join(medians)}{failed}.{cut}",
        met == len(measured) and not record.failed if measured or record.failed else None,
        (*LIMITS, _conditions(record.machine)),
        (*sections(record), *flexible),
        facts=tuple(key),
        highlights=tuple(_ratios(best, name) for name in _TELLING if name in functions),
        digest=(targets_table(record),),
        unfinished=tuple(data.get("unfinished", ())),
        missed=tuple(
            f"{TIMED_MODELS[v.target.model].title}, {FUNCTIONS[v.target.function]}, against {v.target.peer}: "
            f"{v.ratio:.2f} times its speed, asked is {v.target.least:g}"
            for v in measured
            if not v.met
        ),
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
        curves.append(Curve(peer, x, y, k, "points"))
    return Chart(
        f"{FUNCTIONS[function]}: their time over ours, a point a model",
        "speeds of the model  [1]",
        "ratio of medians  [1]",
        tuple(curves),
        (Mark("as fast as we", 1.0),),
        log="xy",
    )


def _conditions(machine: Mapping[str, Any]) -> str:
    """What times depend on beside versions and flags."""
    load = " and ".join(f"{load:.1f}" for load in machine.get("load before and after", ()))
    peaks = {"scalar_flops": "GFlop/s one by one", "vector_flops": "GFlop/s in vectors", "copied_bytes": "GB/s copied"}
    limits = ", ".join(f"{machine[name] / 1e9:.1f} {unit}" for name, unit in peaks.items() if name in machine)
    size = f"{machine.get('states', '?')} states, {machine.get('repeats', '?')} repeats"
    return f"{size}; load before and after {load or 'unknown'}; measured limits of a core: {limits or 'unknown'}."


TOPIC = Topic("timing", "Speed", "How fast is the C against engines and other generators?", compose, measure)
