"""A cluster of other processes: the same rows as here, whoever of its workers dies."""

from __future__ import annotations

import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Thread

import pyarrow as pa
import pyarrow.parquet as parquet
import pytest
from typer.testing import CliRunner

from tests.late import late
from tests.validation.campaigns.test_killed import busy_worker, events, journal
from validation.__main__ import app
from validation.campaigns.plan import make
from validation.campaigns.tasks import tasks

runner = late("validation.campaigns.runner")
session = late("validation.campaigns.session")
ROOT = Path(__file__).parents[3]
PLAN = {
    "kind": "check",
    "models": ("pendulum", "double_pendulum"),
    "states": 240,
    "batch": 20,
    "seed": 3,
    "engines": ("pinocchio",),
}
PATIENCE = 120.0  # [s]


class Cluster:
    """A scheduler and workers as their own command line starts them, on the loopback."""

    def __init__(self, folder: Path, workers: int) -> None:
        self.folder = folder
        self.processes: list[subprocess.Popen[bytes]] = []
        log = folder / "scheduler.log"
        self.scheduler = self.started(log, "scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard")
        self.address = said(log, r"Scheduler at:\s+(tcp://127\.0\.0\.1:\d+)")
        self.workers = [self.worker(k) for k in range(workers)]

    def worker(self, number: int) -> subprocess.Popen[bytes]:
        # Without a nanny, who would start another in its place: whoever dies is gone.
        return self.started(
            self.folder / f"worker{number}.log",
            "worker",
            self.address,
            "--host",
            "127.0.0.1",
            "--nthreads",
            "1",
            "--no-nanny",
            "--no-dashboard",
            "--local-directory",
            str(self.folder),
        )

    def started(self, log: Path, *words: str) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-m", "distributed.cli.dask_" + words[0], *words[1:]]
        environment = os.environ | {"PYTHONPATH": str(ROOT)}
        with log.open("wb") as file:
            process = subprocess.Popen(command, cwd=ROOT, env=environment, stdout=file, stderr=file)
        self.processes.append(process)
        return process

    def stop(self) -> None:
        for process in reversed(self.processes):
            process.kill()
            process.wait()


def said(log: Path, pattern: str) -> str:
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        found = re.search(pattern, log.read_text())
        if found:
            return found[1]
        time.sleep(0.02)
    raise AssertionError(log.read_text())


@contextmanager
def cluster(folder: Path, workers: int = 2) -> Iterator[Cluster]:
    folder.mkdir()
    made = Cluster(folder, workers)
    try:
        yield made
    finally:
        made.stop()
        shutil.rmtree(folder)


def rows(folder: Path) -> pa.Table:
    return parquet.read_table(folder / "results.parquet").replace_schema_metadata(None)


def here() -> pa.Table:
    return pa.concat_tables([task.run() for task in tasks(make(PLAN, "test"))])


def killing(folder: Path, victim: Callable[[], None], after: int) -> Callable[[], None]:
    """In another thread: once some batches are done, kill."""

    def kill() -> None:
        end = time.monotonic() + PATIENCE
        while len(events(folder, "done")) < after and time.monotonic() < end:
            time.sleep(0.005)
        victim()

    return kill


@pytest.mark.slow  # In every run: a campaign of the command line that is interrupted and resumed.
def test_the_rows_of_a_local_campaign(tmp_path: Path) -> None:
    """By the command line's own option."""
    models, engines = ",".join(PLAN["models"]), ",".join(PLAN["engines"])  # type: ignore[arg-type]
    with cluster(tmp_path / "cluster", workers=1) as made:
        words = [
            "campaign",
            "run",
            "-o",
            str(tmp_path / "c"),
            "--models",
            models,
            "--engines",
            engines,
            "--states",
            "240",
            "--batch",
            "20",
            "--seed",
            "3",
            "--scheduler",
            made.address,
        ]
        result = CliRunner().invoke(app, words)
        assert result.exit_code == 0, result.output
        workers = {line["worker"] for line in journal(tmp_path / "c") if line["event"] == "done"}
        assert workers <= {worker.pid for worker in made.workers} and workers
        assert made.scheduler.poll() is None  # It is not ours to end.
    assert rows(tmp_path / "c").equals(here())


@pytest.mark.slow
def test_a_dead_worker_leaves_its_batches_to_the_others(tmp_path: Path) -> None:
    folder = tmp_path / "c"
    with cluster(tmp_path / "cluster") as made:
        killer = Thread(target=killing(folder, lambda: os.kill(busy_worker(folder), signal.SIGKILL), 2))
        killer.start()
        session.begin(make(PLAN, "test"), folder, runner.Pool(scheduler=made.address))
        killer.join()
        assert sorted(worker.poll() is None for worker in made.workers) == [False, True]
    assert set(events(folder, "done").values()) == {1}
    assert rows(folder).equals(here())


@pytest.mark.parametrize(
    ("address", "found"),
    [
        ("tcp://127.0.0.1:{closed}", "refused"),
        ("127.0.0.1:{closed}", "refused"),
        ("tcp://127.0.0.1", "no such address"),
        ("tcp://127.0.0.1:99999", "no such address"),
        ("carrier-pigeon://roof:1", "no such address"),
    ],
)
def test_nobody_there_is_told_at_once(tmp_path: Path, address: str, found: str) -> None:
    with socket.socket() as reserved:  # Bound, and not listening.
        reserved.bind(("127.0.0.1", 0))
        asked = address.format(closed=reserved.getsockname()[1])
        words = ["campaign", "run", "-o", str(tmp_path / "c"), "--models", "pendulum", "--states", "4"]
        result = CliRunner().invoke(app, [*words, "--scheduler", asked])
    assert result.exit_code == 2
    assert f"scheduler '{asked}'" in result.output and found in result.output and "remedy: " in result.output
