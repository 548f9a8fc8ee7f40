"""Races as a command, in parts if wanted: a part that is measured anew replaces that part of the record."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Annotated, Any

import typer

from ..reporting.command import Run, known
from ..reporting.record import Data
from . import waits
from .models import FUNCTIONS, TIMED_MODELS
from .record import Record, as_data, read
from .run import facts, jobs, load, prepare, run_job
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
