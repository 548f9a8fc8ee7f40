"""A cluster of other processes: the same rows as here, whoever of its workers dies."""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Thread

import pytest
from typer.testing import CliRunner

from tests.late import late
from tests.validation.campaigns.test_killed import PLAN as WHOLE
from tests.validation.campaigns.test_killed import (
    assert_rows_are_those_of_an_uninterrupted_run,
    busy_worker,
    events,
    journal,
    options,
    wait_for,
)
from validation.__main__ import app

runner = late("validation.campaigns.runner")
session = late("validation.campaigns.session")
ROOT = Path(__file__).parents[3]
PLAN = WHOLE | {"states": 240}


@contextmanager
def cluster(folder: Path) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """Address of a scheduler, and its process and those of two workers, as their own command line starts them."""
    folder.mkdir()
    log, processes = folder / "scheduler.log", list[subprocess.Popen[bytes]]()

    def started(*words: str) -> None:
        command = [sys.executable, "-m", "distributed.cli.dask_" + words[0], *words[1:], "--no-dashboard"]
        environment = os.environ | {"PYTHONPATH": str(ROOT)}
        with log.open("ab") as file:
            processes.append(subprocess.Popen(command, cwd=ROOT, env=environment, stdout=file, stderr=file))

    def address() -> list[str]:
        return re.findall(r"Scheduler at:\s+(tcp://127\.0\.0\.1:\d+)", log.read_text())

    try:
        started("scheduler", "--host", "127.0.0.1", "--port", "0")
        wait_for(lambda: bool(address()))
        for _ in range(2):  # Without a nanny, who would start another in its place: whoever dies is gone.
            options = ("--host", "127.0.0.1", "--nthreads", "1", "--no-nanny", "--local-directory", str(folder))
            started("worker", address()[0], *options)
        yield address()[0], processes
    finally:
        for process in reversed(processes):
            process.kill()
            process.wait()


@pytest.mark.slow  # In every run: a worker that does not see the folder, and one of other code, in test_session.py.
def test_a_campaign_on_a_cluster_outlives_a_worker_and_leaves_the_scheduler(tmp_path: Path) -> None:
    """By the command line's own option; a dead worker's batches are done by the others."""
    folder = tmp_path / "c"

    def kill() -> None:
        wait_for(lambda: len(events(folder, "done")) >= 2)
        os.kill(busy_worker(folder), signal.SIGKILL)

    with cluster(tmp_path / "cluster") as (address, (scheduler, *workers)):
        killer = Thread(target=kill)
        killer.start()
        words = ["campaign", "run", "-o", str(folder), *options(PLAN), "--scheduler", address]
        result = CliRunner().invoke(app, words)
        killer.join()
        assert result.exit_code == 0, result.output
        assert sorted(worker.poll() is None for worker in workers) == [False, True]
        at_work = {line["worker"] for line in journal(folder) if line["event"] == "done"}
        assert at_work <= {worker.pid for worker in workers} and at_work
        assert scheduler.poll() is None  # It is not ours to end.
    assert set(events(folder, "done").values()) == {1}
    assert_rows_are_those_of_an_uninterrupted_run(folder, PLAN)


@pytest.mark.parametrize(
    ("address", "found"),
    [
        ("127.0.0.1:{closed}", "refused"),
        ("tcp://127.0.0.1:99999", "no such address"),
        ("carrier-pigeon://roof:1", "no such address"),
    ],
)
def test_an_unreachable_scheduler_is_reported_at_once(tmp_path: Path, address: str, found: str) -> None:
    with socket.socket() as reserved:  # Bound, and not listening.
        reserved.bind(("127.0.0.1", 0))
        asked = address.format(closed=reserved.getsockname()[1])
        words = ["campaign", "run", "-o", str(tmp_path / "c"), "--models", "pendulum", "--states", "4"]
        result = CliRunner().invoke(app, [*words, "--scheduler", asked])
    assert result.exit_code == 2
    assert f"scheduler '{asked}'" in result.output and found in result.output and "remedy: " in result.output
