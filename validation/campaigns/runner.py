"""Batches over dask.distributed: processes of this machine by default, a cluster's where its scheduler is named.

A worker writes each part as soon as it has it, so that whoever is killed afterwards, what was finished stays; it looks
for the part first, so that nothing is done twice. The client writes what workers could not, on machines that do not
see the folder.
"""

from __future__ import annotations

import logging
import os
import re
import signal
import socket
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from itertools import islice
from pathlib import Path

import dask
import distributed

from symofros.tools import CODE_IDENTITY, source_digest

from .errors import ClusterError
from .store import Store
from .tasks import Task

# Batches handed out ahead of each worker: enough that none waits, few enough that little is queued.
AHEAD = 2
# A batch is given up when so many workers have died under it: one may be killed by chance, or by hand.
DEATHS = 2
PATIENCE = 60.0  # [s] for a worker of a cluster, the first one.
ANSWER = 10.0  # [s] for its scheduler.
_ADDRESS = re.compile(r"(?:(?:tcp|tls)://)?(\[[0-9A-Fa-f:]+\]|[^\s:/\[\]]+):([0-9]{1,5})\Z")


@dataclass(frozen=True)
class Pool:
    """Processes or cluster that work on a campaign.

    Attributes:
        workers: Processes of this machine, if no cluster is named.
        scheduler: Address of a cluster's scheduler.
        dashboard: Port of dask's own pages on this machine's loopback; none is opened unless asked for.
        patience: Time that a cluster may take to have a worker [s].
    """

    workers: int = 2
    scheduler: str = ""
    dashboard: int | None = None
    patience: float = PATIENCE

    @contextmanager
    def client(self) -> Iterator[distributed.Client]:
        """A connection; processes that were started for it end with it.

        Raises:
            ClusterError: There is no such scheduler, or it has no workers.
        """
        if self.scheduler:
            with _connected(self.scheduler) as client:
                try:
                    client.wait_for_workers(1, timeout=self.patience)
                except TimeoutError:
                    raise _deserted(self) from None
                yield client
            return
        page = None if self.dashboard is None else f"127.0.0.1:{self.dashboard}"
        # One thread each: engines and our own scratch are not asked whether they share a process.
        with (
            dask.config.set({"distributed.scheduler.allowed-failures": DEATHS - 1}),
            distributed.LocalCluster(
                n_workers=self.workers,
                threads_per_worker=1,
                processes=True,
                host="127.0.0.1",
                dashboard_address=page,
                worker_dashboard_address=None,
                silence_logs=logging.CRITICAL,
            ) as cluster,
            distributed.Client(cluster) as client,
        ):
            client.register_plugin(_Undisturbed())
            yield client


def _connected(address: str) -> distributed.Client:
    """A client of a scheduler that answers; a port without a listener is reported at once."""
    match = _ADDRESS.match(address)
    if match is None or int(match[2]) > 65535:
        raise ClusterError(
            address,
            "no such address",
            "a dask scheduler's address is tcp://HOST:PORT",
            "give what `dask scheduler` prints when it starts",
        )
    try:
        socket.create_connection((match[1].strip("[]"), int(match[2])), timeout=ANSWER).close()
        return distributed.Client(address, timeout=ANSWER)
    except OSError as error:  # Of a name that is not known, a port that is closed, time that has run out.
        said = str(error).partition("\n")[0] or type(error).__name__
        raise ClusterError(
            address,
            said,
            f"a dask scheduler answers there within {ANSWER:g} s",
            "start one with `dask scheduler`, or leave --scheduler out",
        ) from None


def _deserted(pool: Pool) -> ClusterError:
    return ClusterError(
        pool.scheduler,
        f"no worker for {pool.patience:g} s",
        "one worker at least is connected",
        "start some with `dask worker ADDRESS --nthreads 1`",
    )


class _Undisturbed(distributed.WorkerPlugin):  # type: ignore[misc]  # dask has no types.
    """Ctrl-C, which a terminal sends to all, is the client's business; it ends the workers."""

    def setup(self, worker: object) -> None:
        """Ignore Ctrl-C in the worker; called in its main thread before it is given work."""
        signal.signal(signal.SIGINT, signal.SIG_IGN)


def run(store: Store, tasks: Sequence[Task], pool: Pool, done: Callable[[Task], None]) -> dict[int, str]:
    """Do batches, a few ahead of each worker.

    Args:
        store: Store that receives the parts.
        tasks: Tasks that are not done yet.
        pool: Who works.
        done: Gets each batch whose part is written.

    Returns:
        Batch -> why it could not be done: it killed its worker each time, or raised what no row can say.

    Raises:
        ClusterError: A cluster can't be reached, or has no workers.
    """
    failures: dict[int, str] = {}
    with pool.client() as client:
        width = AHEAD * sum(client.nthreads().values())
        suspects: list[Task] = []
        for task, error in _outcomes(client, store, tasks, width):
            if isinstance(error, distributed.KilledWorker):
                suspects.append(task)
            elif error is not None:
                failures[task.number] = reason(task, error)
            else:
                done(task)
        # Whoever waited behind a batch that kills its worker is under suspicion, too; alone, each shows what it is.
        for suspect in suspects:
            for task, error in _outcomes(client, store, [suspect], 1):
                if error is not None:
                    failures[task.number] = reason(task, error)
                else:
                    done(task)
    return failures


def _outcomes(
    client: distributed.Client, store: Store, tasks: Sequence[Task], width: int
) -> Iterator[tuple[Task, BaseException | None]]:
    """Each task once its part is written, with None, or with its exception; at most `width` are in flight."""
    waiting, by_key = iter(tasks), {f"{store.hash}-{task.number}": task for task in tasks}

    def submit(task: Task) -> distributed.Future:
        key = f"{store.hash}-{task.number}"
        return client.submit(execute, task, store.folder.resolve(), store.hash, sources(), key=key)

    active = distributed.as_completed([submit(task) for task in islice(waiting, width)])
    for future in active:
        task = by_key[future.key]
        error = None
        if future.status == "finished":
            part = future.result()
            if store.part(task.number) is None:
                store.write(task.number, part)
        else:
            error = future.exception()
        future.release()  # Else a batch that failed could not be tried again.
        yield task, error
        for following in islice(waiting, 1):
            active.add(submit(following))


@cache
def sources() -> dict[str, str]:
    """Digests of the code that makes rows, generator and harness, as this process has it."""
    return {
        "source of symofros": CODE_IDENTITY[:16],
        "source of validation": source_digest(Path(__file__).parents[1])[:16],
    }


def execute(task: Task, folder: Path, hash: str, code: Mapping[str, str]) -> bytes:
    """Do a batch on a worker, unless its part is there already.

    Returns:
        The part.

    Raises:
        RuntimeError: The worker's code is not the client's.
    """
    if code != sources():
        raise RuntimeError("the worker runs other code than the client, whose rows would not belong to the others")
    store = Store(folder, hash)
    shared = store.parts.is_dir()
    known = store.part(task.number) if shared else None
    if known is not None:
        return known
    if shared:
        store.note(batch=task.number, event="begun", worker=os.getpid())
    start = time.perf_counter()
    rows = task.run()
    part = store.encode(task.number, rows, {"seconds": round(time.perf_counter() - start, 3)})
    if shared:
        store.write(task.number, part)
        store.note(batch=task.number, event="done", worker=os.getpid())
    return part


def reason(task: Task, error: BaseException | None) -> str:
    """Why a batch has no part, in one line."""
    if isinstance(error, distributed.KilledWorker):
        return f"{task.title}: the process that did it died, each time it was tried"
    return f"{task.title}: {type(error).__name__}: {str(error).partition(chr(10))[0]}"
