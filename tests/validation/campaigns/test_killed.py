"""Whoever is killed, what was finished stays, and is not done again."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as parquet
import pytest

from validation.campaigns.plan import make
from validation.campaigns.tasks import tasks

ROOT = Path(__file__).parents[3]
PLAN = {
    "kind": "check",
    "models": ("pendulum", "double_pendulum"),
    "states": 600,
    "batch": 20,
    "seed": 3,
    "engines": ("pinocchio",),
}
PATIENCE = 600.0  # [s], for a campaign that hangs.


def options(plan: dict[str, object]) -> list[str]:
    """A plan as words of the command."""
    lists = [f"--{key}={','.join(plan[key])}" for key in ("models", "engines")]  # type: ignore[arg-type]
    return lists + [f"--{key}={plan[key]}" for key in ("states", "batch", "seed")]


def launched(*command: str) -> subprocess.Popen[bytes]:
    """A client of its own, in a process group of its own."""
    return subprocess.Popen(
        [sys.executable, "-m", "validation", "campaign", *command],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
        # A shell's background jobs start with it ignored, and so do their children.
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )


def journal(folder: Path) -> list[dict[str, object]]:
    path = folder / "journal.jsonl"
    return [json.loads(line) for line in path.read_text().splitlines()] if path.is_file() else []


def events(folder: Path, event: str) -> Counter[object]:
    return Counter(line["batch"] for line in journal(folder) if line["event"] == event)


def wait_for(condition: Callable[[], bool]) -> None:
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)


def busy_worker(folder: Path) -> int:
    """The process that began a batch last and has not finished it."""
    busy: list[int] = []

    def is_at_work() -> bool:
        lines = [line for line in journal(folder) if "batch" in line]
        done = {line["batch"] for line in lines if line["event"] == "done"}
        busy[:] = [int(str(line["worker"])) for line in lines if line["event"] == "begun" and line["batch"] not in done]
        return bool(busy)

    wait_for(is_at_work)
    return busy[-1]


def assert_rows_are_those_of_an_uninterrupted_run(folder: Path, plan: dict[str, object] = PLAN) -> None:
    rows = parquet.read_table(folder / "results.parquet").replace_schema_metadata(None)
    assert rows.equals(pa.concat_tables([task.run() for task in tasks(make(plan, "test"))]))


# In every run: tests/validation/campaigns/test_session.py, a worker that kills itself; parts that a kill in the middle
# of writing leaves out.
@pytest.mark.slow
@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGINT])
def test_a_campaign_that_is_ended_goes_on_where_it_was(tmp_path: Path, how: signal.Signals) -> None:
    """A worker dies, which costs its batch alone; then the client by a kill, or all of them by Ctrl-C, in words."""
    folder = tmp_path / "c"
    client = launched("run", "-o", str(folder), *options(PLAN), "--workers", "2")
    wait_for(lambda: len(events(folder, "done")) >= 5 or client.poll() is not None)
    if how == signal.SIGKILL:
        os.kill(busy_worker(folder), how)
        wait_for(lambda: len(events(folder, "done")) >= 10 or client.poll() is not None)
        client.kill()
        client.wait()
    else:
        os.killpg(client.pid, how)
        said = client.communicate(timeout=PATIENCE)[1].decode()
        assert client.returncode == 130 and f"campaign resume {folder}" in said and "Traceback" not in said
    finished, before = set(events(folder, "done")), events(folder, "begun")
    assert sum(before.values()) - len(before) <= 1  # What the worker was at.
    assert not (folder / "results.parquet").exists()
    resumed = launched("resume", str(folder), "--workers", "2")
    _, complained = resumed.communicate(timeout=PATIENCE)
    assert resumed.returncode == 0, complained.decode()
    begun = events(folder, "begun")
    again = {batch for batch, times in before.items() if begun[batch] > times}
    assert len(begun) == 30 and len(again) <= 2 and not again & finished
    assert_rows_are_those_of_an_uninterrupted_run(folder)
