"""Check many models, each in a process of its own: one that crashes takes no other with it."""

from __future__ import annotations

import gc
import multiprocessing
import os
import signal
from collections.abc import Callable, Sequence
from multiprocessing.connection import Connection, wait
from multiprocessing.context import BaseContext
from pathlib import Path
from typing import Any

import symofros as sf

from .adapters import route_of
from .checking import ModelResult, Settings, absent, broken, check, failed
from .inputs.cases import Case

Report = Callable[[ModelResult], None]

# Libraries of linear algebra start a thread for each core in every process. Beside other workers these wait for each
# other at full load: products of Jacobians of a humanoid took 40 times the processor time, most of it waiting.
ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
# Objects made between two searches for garbage. Expression graphs are large and hold none.
COLLECTED_AT = 50_000


def _preloaded(settings: Settings) -> list[str]:
    """Modules loaded once into the process that the workers are forked from: no engine that is not asked for."""
    return [__name__, f"{__package__}.inputs.readers", *(route_of(name).module for name in settings.routes())]


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


def run(cases: Sequence[Case], settings: Settings, workers: int, done: Report) -> None:
    """Check models, several at a time.

    Args:
        cases: The models.
        settings: States, seed, engines.
        workers: How many processes; with one, or with one model, everything happens in this process.
        done: Gets each result as it comes; what it got before a KeyboardInterrupt stands.
    """
    if min(workers, len(cases)) <= 1:
        for case in cases:
            done(run_case(case, settings))
    else:
        _WorkerPool(settings, workers, done).run(sorted(cases, key=lambda case: -case.weight))


class _WorkerPool:
    def __init__(self, settings: Settings, count: int, done: Report) -> None:
        self.settings, self.count, self.done = settings, count, done
        self.context = _context(settings)
        self.active: dict[Any, tuple[Any, Case]] = {}

    def run(self, cases: list[Case]) -> None:
        waiting = cases[::-1]
        try:
            while waiting or self.active:
                while waiting and len(self.active) < self.count:
                    self._start(waiting.pop())
                for connection in wait(list(self.active)):
                    self._finish(connection)
        finally:
            for process, _ in self.active.values():
                process.terminate()

    def _start(self, case: Case) -> None:
        receiving, sending = self.context.Pipe(duplex=False)
        # BaseContext has no Process in the type stubs; every real context does.
        process = self.context.Process(target=_work, args=(sending, case, self.settings))  # type: ignore[attr-defined]
        process.start()
        sending.close()  # So that the end of the process is the end of the pipe.
        self.active[receiving] = (process, case)

    def _finish(self, connection: Any) -> None:
        process, case = self.active.pop(connection)
        try:
            result: ModelResult = connection.recv()
        except EOFError:
            process.join()
            result = failed(case.label, "check", f"the process that checked it ended with code {process.exitcode}")
        connection.close()
        process.join()
        self.done(result)


def _context(settings: Settings) -> BaseContext:
    for name, threads in ONE_THREAD.items():  # Before NumPy is loaded in the process that workers come from.
        os.environ.setdefault(name, threads)
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(_preloaded(settings))
    return context


def _work(connection: Connection, case: Case, settings: Settings) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # The parent handles Ctrl-C and ends its workers.
    gc.freeze()  # Modules stay.
    gc.set_threshold(COLLECTED_AT)
    connection.send(run_case(case, settings))
    connection.close()
