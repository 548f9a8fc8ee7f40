"""How fast the C is: targets, ratios, what the sections show; and races as a command, in parts if wanted."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from statistics import median
from typing import Annotated, Any

import typer

from ..reporting.command import Run, known
from ..reporting.numbers import counted, times
from ..reporting.plain import restored
from ..reporting.record import Data, Fact, Report, Section, Table, Topic
from . import waits
from .models import FUNCTIONS, TIMED_MODELS
from .record import Entry, Record, as_data, read
from .run import facts, jobs, load, prepare, run_job
from .tables import TARGETS_TEXT, duration, ratios, sections, targets_table
from .targets import MAX_REVERSE, reverse_costs, verdicts
from .task import STATES
from .worker import PEERS, Job

# Four times through the copies of a library.
REPEATS = 24


def measure(
    run: Run,
    models: Annotated[list[str] | None, typer.Option("--model", help="Only this model; repeatable.")] = None,
    peers: Annotated[list[str] | None, typer.Option("--peer", help=f"Only this peer: {', '.join(PEERS)}.")] = None,
    functions: Annotated[list[str] | None, typer.Option("--function", help="Only this function; repeatable.")] = None,
    repeats: Annotated[int, typer.Option(min=3, help="Interleaved repeats.")] = REPEATS,
    states: Annotated[int, typer.Option(min=64, help="Random states.")] = STATES,
    resume: Annotated[bool, typer.Option("--resume", help="Leave out what the report has figures of.")] = False,
) -> Data:
    """Time generated C against Pinocchio's C++, MuJoCo's C, and C by CasADi and by SymPy.

    A part that is chosen replaces that part of the report's figures; the whole starts afresh. Ctrl-C keeps what was
    measured.
    """
    chosen = known(models, [*TIMED_MODELS, waits.LABEL], "--model", "model")
    record = read(run.folder / "timing.json") if models or peers or functions or resume else Record()
    todo = jobs(
        [name for name in chosen if name in TIMED_MODELS],
        tuple(known(peers, PEERS, "--peer", "peer")),
        known(functions, FUNCTIONS, "--function", "function"),
        repeats,
        states,
        record if resume else None,
    )
    whole = not (models or peers or functions)
    first_second = waits.LABEL in models if models else whole and not (resume and record.waits)
    measures = bool(todo) or first_second
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

    left = [*([waits.LABEL] * first_second), *(job.model for job in todo)]
    run.expect(sum(len(job.functions) for job in todo) + first_second, "compiling the engines")
    try:
        if first_second:
            _time_waits(record, run)
            left.remove(waits.LABEL)
            run.save(data(left))
        for failure in prepare(todo, lambda text: run.advance(text, 0)):
            run.say(failure, bad=True)
        for job in todo:
            _time(job, record, run)
            left.remove(job.model)
            run.save(data(left))  # So that even a kill leaves what was measured.
    except KeyboardInterrupt:
        return data(left)
    return data()


def _time(job: Job, record: Record, run: Run) -> None:
    """Time one model, and report what could not be timed."""
    skipped, failed = len(record.skipped), len(record.failed)

    def doing(model: str, function: str, part: str) -> None:
        task = f"{model}: {FUNCTIONS[function]}"
        run.advance(f"{task}: {part}" if part else task, 0 if part else 1)

    run_job(job, record, doing)
    for notes, bad in ((record.skipped[skipped:], False), (record.failed[failed:], True)):
        for model, function, peer, why in notes:
            run.say(f"not timed: {model}, {function}, {peer}: {why}", bad)


def _time_waits(record: Record, run: Run) -> None:
    run.advance(waits.LABEL)
    record.forget([waits.LABEL], ["all"], [])
    try:
        record.waits = waits.measure_waits(lambda text: run.advance(f"{waits.LABEL}: {text}", 0))
    except (RuntimeError, FileNotFoundError) as error:
        record.failed.append((waits.LABEL, "all", "symofros", str(error)))
        run.say(f"not timed: {error}", bad=True)


LIMITS = (
    """One thread, pinned to one processor, whose time on it is what is measured. All sides of a function run in one
    process, in turns of 10 ms or more, each a loop in C over the same random states; before, each side's results are
    compared with ours, to 1e-12 of the largest entry (1e-9 where a system is solved), and sides that differ are not
    timed. Cells hold minimum and median over the repeats, in nanoseconds a state; ratios are of medians, theirs to
    ours. Machines are noisy: quote a ratio rather than a time.""",
    """Ours is generated C, one state after the other, in the build that users get by default, and by vectors in calls
    of 64 states, or of as many as keep their results within 384 KiB: by rows, by columns, and by columns of floats
    (checked to 5e-4). Copies of our library, of CasADi's and of SymPy's compute in turn, because where code happens to
    lie matters. Pinocchio is its own headers, compiled in the run by gcc and by clang, in the faster of its two
    conventions; MuJoCo is its wheel's library; CasADi is the C of its
    composite-rigid-body, Newton-Euler and articulated-body recursions, SymPy Kane's equations with common
    subexpressions, both in the best of four builds (gcc and clang, -O3 with and without -ffast-math). Friction and
    springs in joints are taken out.""",
)

_DECISION = """**How fast, against which engine:** the time of the other's fastest build over that of the generated C,
state by state, on one core{}. 2.0 is twice as fast; below 1 the other is faster. Batches and all else:
[the races](timing.html#targets)."""
# What people compare engines by: functions and peers of the table that decides.
_ASKED = ("dynamics", "forward_dynamics")
_PEERS = ("pinocchio", "mujoco", "casadi")


def compose(data: Data) -> Report:
    """The report of its JSON."""
    record = restored(Record, data)
    judged, best = verdicts(record), record.fastest()
    table = targets_table(judged)
    measured = [verdict for verdict in judged if verdict.entry is not None]
    met = sum(verdict.met for verdict in measured)
    said = f"{met} of {len(judged)} targets are met"
    said += f", {len(judged) - len(measured)} were not measured" if len(measured) < len(judged) else ""
    failed = f"; {len(record.failed)} could not be timed" if record.failed else ""
    cut = f" Interrupted: {', '.join(data['unfinished'])} not timed." if data.get("unfinished") else ""
    sizes = (counted(len({getattr(row, name) for row in best}), name) for name in ("model", "function"))
    by_peer = {row.peer: sorted(other.ratio for other in best if other.peer == row.peer) for row in best}
    medians = {peer: times(median(group)) for peer, group in by_peer.items()}
    raced = ", ".join(f"{peer} {ratio}" for peer, ratio in medians.items())
    won = sum(row.ratio > 1.0 for row in best)
    race = f"{won} of {counted(len(best), 'race')} over {' and '.join(sizes)}"
    raced = f" (median of their time over ours: {raced})" if raced else ""
    raced = f"The generated C is faster than the peer in {race}{raced}; " if best else ""
    late = [wait for wait in record.waits if not wait.met]
    any_judged = measured or record.waits or record.failed
    costly = [cost for cost in reverse_costs(record) if not cost.met]
    return Report(
        "Timing: generated C against engines and symbolic peers",
        f"{raced}{said}{failed}.{cut}",
        met == len(measured) and not (late or costly or record.failed) if any_judged else None,
        (*LIMITS, _conditions(record.machine)),
        (
            Section("Targets", (TARGETS_TEXT, table, ratios(best)), "targets"),
            *sections(record),
        ),
        facts=(
            Fact(f"{won} of {len(best)}", "races in which the generated C is faster than the peer"),
            Fact(f"{met} of {len(judged)}", "targets are met", met == len(measured)),
            *(
                Fact(
                    medians[peer],
                    f"{peer}'s time over ours, median of {len(group)}; {times(group[0])} to {times(group[-1])}",
                )
                for peer, group in by_peer.items()
            ),
        ),
        digest=(table,),
        unfinished=tuple(data.get("unfinished", ())),
        decisions=_decisions(best, record.machine),
        missed=tuple(
            f"{v.target.title}, {v.target.task}, against {v.target.peer}: {v.ratio:.2f} times its speed, asked is "
            f"{v.target.least:g}"
            for v in measured
            if not v.met
        )
        + tuple(
            f"{cost.title}, {cost.task}: {cost.ratio:.2f} times its function's time, asked is at most {MAX_REVERSE:g}"
            for cost in costly
        )
        + tuple(
            f"{' of '.join(filter(None, (wait.what, wait.model)))}: {duration(wait.seconds)}, asked is at most "
            f"{duration(wait.asked)}"
            for wait in late
            if wait.asked is not None
        ),
        aims=not record.failed,
    )


def _decisions(best: Sequence[Entry], machine: Mapping[str, Any]) -> tuple[str | Table, ...]:
    """Sentence and table on speed-ups of the generated C on each model; none where nothing was measured."""
    raced = [row for row in best if row.function in _ASKED and row.peer in _PEERS]
    if not raced:
        return ()
    ratios = {(row.title, row.function, row.peer): f"{row.ratio:.1f}" for row in raced}
    columns = [(function, peer) for function in _ASKED for peer in _PEERS]
    rows = (
        (title, *(ratios.get((title, *column), "-") for column in columns))
        for title in dict.fromkeys(row.title for row in raced)
    )
    known = [str(machine[name]) for name in ("processor", "system") if machine.get(name)]
    where = ", ".join([*known, f"last raced {max(row.date for row in raced)[:10]}"])
    head = " | ".join(("model", *(f"{FUNCTIONS[function]}: {peer} / ours" for function, peer in columns)))
    return _DECISION.format(f" ({where})"), Table.of(head, rows)


def _conditions(machine: Mapping[str, Any]) -> str:
    """Conditions besides versions and flags: states, repeats, load, measured limits of a core."""
    load = " and ".join(f"{load:.1f}" for load in machine.get("load before and after", ()))
    peaks = {"scalar_flops": "GFlop/s one by one", "vector_flops": "GFlop/s in vectors", "copied_bytes": "GB/s copied"}
    limits = ", ".join(f"{machine[name] / 1e9:.1f} {unit}" for name, unit in peaks.items() if name in machine)
    size = f"{machine.get('states', '?')} states, {machine.get('repeats', '?')} repeats"
    lanes = f"vectors of {machine['lanes']:.0f} doubles; " if "lanes" in machine else ""
    return (
        f"{size}; {lanes}load before and after {load or 'unknown'}; measured limits of a core: {limits or 'unknown'}."
    )


TOPIC = Topic("timing", "Speed", "How fast is the C beside engines and generators?", compose, measure)
