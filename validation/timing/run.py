"""A whole run: one process a model, what it says added to the record as it comes."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from symofros.tools import find_toolchain

from ..reporting.provenance import machine
from ..worker_process import WorkerError, WorkerProcess
from .contestants.arrays import first_compiler
from .contestants.engines import CLOSED, PINOCCHIO_FLAGS, TREES, pinocchio_builds
from .contestants.generated import BUILDS
from .contestants.programs import BuildError, Say, Skipped, compilers, source
from .models import TIMED_MODELS
from .race import pin_to_one_cpu
from .record import Record
from .worker import Job, Message, work

Doing = Callable[[str, str, str], None]
# What a worker that died had not done.
LEFT = "what was left"


def run_job(job: Job, record: Record, doing: Doing = lambda model, function, part: None) -> None:
    """Time one model in a process of its own; what was measured before it fails, or before Ctrl-C, is kept.

    Args:
        job: Model, functions and peers to time.
        record: Record that the results are added to.
        doing: Told the model, the function and the part of its race that is under way; "" where a function begins.
    """
    record.forget([job.model], [LEFT], [])
    try:
        with TemporaryDirectory() as folder, WorkerProcess(log=Path(folder) / "log") as worker:
            for message in worker.call(work, job):
                take(message, job, record, doing)
    except WorkerError as error:
        record.failed.append((job.model, LEFT, "symofros", f"the worker: {error}"))


def take(message: Message, job: Job, record: Record, doing: Doing) -> None:
    """Add a worker's message to a record."""
    kind, value = message
    if kind == "doing":
        record.forget([job.model], [value], job.peers)
        doing(job.model, value, "")
    elif kind == "part":
        doing(job.model, *value)
    else:
        lists: dict[str, list[Any]] = {"entry": record.entries, "cost": record.costs}
        (lists[kind] if kind in lists else getattr(record, kind)).append(value)


def jobs(
    models: Iterable[str],
    peers: tuple[str, ...],
    functions: Iterable[str],
    repeats: int,
    states: int,
    done: Record | None = None,
) -> list[Job]:
    """One job for each model, with its requested functions that were not measured before."""
    wanted = set(functions)
    todo = []
    for model in models:
        left = [name for name in TIMED_MODELS[model].functions if done is None or not done.has(model, name)]
        chosen = tuple(name for name in left if name in wanted)
        if chosen:
            todo.append(Job(model, peers, chosen, repeats, states))
    return todo


def prepare(todo: Iterable[Job], say: Say) -> list[str]:
    """Compile the programs that models of the jobs share, in parallel; each model reports what fails itself.

    Args:
        todo: Jobs.
        say: Told of what is being compiled, which may take minutes.

    Returns:
        What went wrong, in words.
    """
    raced = [TIMED_MODELS[job.model].load() for job in todo if "pinocchio" in job.peers]
    programs = {CLOSED if system.constraints else TREES for system in raced}
    tasks: list[Callable[[], Any]] = [first_compiler, *(partial(pinocchio_builds, name, say) for name in programs)]
    failures = []
    with ThreadPoolExecutor() as pool:
        for future in [pool.submit(job) for job in tasks]:
            try:
                future.result()
            except (BuildError, Skipped) as error:
                failures.append(str(error))
    return failures


def facts() -> Mapping[str, Any]:
    """Conditions that times depend on: processor, its measured limits, compilers, flags."""
    toolchain = find_toolchain()
    flags = {
        "symofros": " ".join(toolchain.default_flags) if toolchain else "none",
        "pinocchio": " ".join(PINOCCHIO_FLAGS),
        "casadi, sympy": " or ".join(" ".join(flags) for flags in BUILDS) + " -march=native",
        "mujoco": "as in its wheel",
    }
    return {
        **machine(),
        "compilers": [compiler.version for compiler in compilers()],
        "flags": flags,
        **peaks(),
    }


def peaks() -> dict[str, float]:
    """Measured limits of one core: operations a second in fused multiply-adds (two each), bytes copied a second."""
    compiler = first_compiler()
    with TemporaryDirectory() as private:
        text, program = Path(private) / "peak.c", Path(private) / "peak"
        text.write_text(source("peak.c"), encoding="utf-8")
        subprocess.run([compiler.path, "-O3", "-march=native", str(text), "-o", str(program)], check=True)
        printed = subprocess.run([str(program)], capture_output=True, text=True, check=True, preexec_fn=pin_to_one_cpu)
    scalar, vector, lanes, copied = map(float, printed.stdout.split())
    return {"scalar_flops": 2.0 * scalar, "vector_flops": 2.0 * vector, "lanes": lanes, "copied_bytes": copied}


def load() -> list[float]:
    """Processes that ran in the last minute, on average; nothing where the system does not say."""
    return [os.getloadavg()[0]] if hasattr(os, "getloadavg") else []
