"""Check many models, each in a process of its own: one that crashes takes no other with it."""

from __future__ import annotations

import gc
import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from importlib import import_module
from pathlib import Path
from queue import SimpleQueue

import symofros as sf

from .adapters import route_of
from .checking import ModelResult, Settings, absent, broken, check, failed
from .inputs.cases import BODY, Case
from .worker_process import WorkerError, WorkerProcess

Report = Callable[[ModelResult], None]

# Libraries of linear algebra start a thread for each core in every process. Beside other workers these wait for each
# other at full load: products of Jacobians of a humanoid took 40 times the processor time, most of it waiting.
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
# Objects made between two searches for garbage. Expression graphs are large and hold none.
COLLECTED_AT = 50_000

# What relations, derivatives and procedures import when they are asked, the package's first uses of its public names
# among them: a quarter of a second of each model's process.
_OF_OWN_QUESTIONS = (
    f"{__package__}.procedures.equations.derivatives",
    f"{__package__}.procedures.catalogue",
    "symofros.exports.exporting",
    "symofros.description.mjcf.reader",
)


def _preloaded(settings: Settings) -> list[str]:
    """Modules loaded once into the process that the workers are forked from: no engine that is not asked for."""
    engines = [route_of(name).module for name in settings.routes()]
    own = () if settings.engines else _OF_OWN_QUESTIONS
    return [__name__, f"{__package__}.inputs.readers", *engines, *own]


def run_case(case: Case, settings: Settings) -> ModelResult:
    """Check one model; whatever goes wrong with it becomes its result, so that the others go on."""
    stage = "load"
    try:
        subject = case.load()
        stage = "compile"
        return check(subject, settings)
    except (sf.SymofrosError, OSError, UnicodeDecodeError) as error:
        if unsupported := absent(case.label, stage, error):
            return unsupported
        said = error.in_shell(case.reading.prefix) if isinstance(error, sf.SymofrosError) else str(error)
        return failed(case.label, stage, without_folder(said, case.path))
    except Exception as error:  # An engine's or our own fault, of any kind: one row of the table, with its place.
        return broken(case.label, error)


def without_folder(text: str, path: Path | None) -> str:
    """A message about a file, fit for a report that others read: the folder is left out."""
    return text if path is None else text.replace(f"{path.parent}{os.sep}", "")


def longest_first(cases: Sequence[Case]) -> list[Case]:
    """The models in the order in which they are checked: those that take long keep no worker alone at the end."""
    try:
        procedures = import_module(".procedures.catalogue", __package__).PROCEDURES
    except ModuleNotFoundError:  # What is not installed is said by the jobs that ask for it.
        procedures = {}
    return sorted(cases, key=lambda case: -(case.weight + BODY * len(procedures.get(case.label, ()))))


def run(cases: Sequence[Case], settings: Settings, workers: int, done: Report) -> None:
    """Check models, several at a time.

    Args:
        cases: The models.
        settings: States, seed, engines.
        workers: How many processes; with one, or with one model, everything happens in this process.
        done: Gets each result as it comes; what it got before a KeyboardInterrupt stands.
    """
    count = min(workers, len(cases))
    if count <= 1:
        for case in cases:
            done(run_case(case, settings))
        return
    pool = [_worker(settings) for _ in range(count)]
    free: SimpleQueue[WorkerProcess] = SimpleQueue()
    for worker in pool:
        free.put(worker)

    def judged(case: Case) -> ModelResult:
        worker = free.get()
        try:
            (result,) = worker.call(_judged, case, settings)
        except WorkerError as error:
            ended = f"ended with code {error.code}" if error.fate == "crashed" else f"failed: {error}"
            return failed(case.label, "check", f"the process that checked it {ended}")
        finally:
            free.put(worker)
        return result  # type: ignore[no-any-return]

    with ThreadPoolExecutor(count) as threads:
        results = [threads.submit(judged, case) for case in longest_first(cases)]
        try:
            for future in as_completed(results):
                done(future.result())
        finally:
            threads.shutdown(wait=False, cancel_futures=True)
            for worker in pool:
                worker.close()


def _worker(settings: Settings) -> WorkerProcess:
    threads = {name: os.environ.get(name, count) for name, count in ONE_THREAD.items()}
    return WorkerProcess(environment=threads, preload=_preloaded(settings), fresh=True)


def _judged(case: Case, settings: Settings) -> ModelResult:
    """Check one model, in a process of its own."""
    gc.freeze()  # Modules stay.
    gc.set_threshold(COLLECTED_AT)
    return run_case(case, settings)
