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
WORKERS = 2
SMALL = {
    "kind": "check",
    "models": ("pendulum", "double_pendulum"),
    "states": 600,
    "batch": 20,
    "seed": 3,
    "engines": ("pinocchio",),
}
FEW = SMALL | {"states": 80, "batch": 10}
PATIENCE = 600.0  # [s], for a campaign that hangs.


def start(folder: Path, plan: dict[str, object] = SMALL, workers: int = WORKERS) -> subprocess.Popen[bytes]:
    """A client of its own, in a process group of its own."""
    options = ["--states", str(plan["states"]), "--batch", str(plan["batch"]), "--seed", str(plan["seed"])]
    if "engines" in plan:
        options += ["--engines", ",".join(plan["engines"])]  # type: ignore[arg-type]
    models = ",".join(plan["models"])  # type: ignore[arg-type]
    command = ["run", "-o", str(folder), "--models", models, *options, "--workers", str(workers)]
    return launched(command)


def resume(folder: Path, workers: int = WORKERS) -> subprocess.Popen[bytes]:
    return launched(["resume", str(folder), "--workers", str(workers)])


def launched(command: list[str]) -> subprocess.Popen[bytes]:
    words = [sys.executable, "-m", "validation", "campaign", *command]
    return subprocess.Popen(
        words,
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


def wait_for(client: subprocess.Popen[bytes], condition: Callable[[], bool]) -> None:
    end = time.monotonic() + PATIENCE
    while not condition():
        assert client.poll() is None, client.communicate()[1].decode()
        assert time.monotonic() < end
        time.sleep(0.01)


def busy_worker(folder: Path) -> int:
    """The process that began a batch last and has not finished it."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        lines = [line for line in journal(folder) if "batch" in line]
        done = {line["batch"] for line in lines if line["event"] == "done"}
        busy = [int(str(line["worker"])) for line in lines if line["event"] == "begun" and line["batch"] not in done]
        if busy:
            return busy[-1]
    raise AssertionError("nobody is at work")


def ended_well(client: subprocess.Popen[bytes]) -> None:
    said, complained = client.communicate(timeout=PATIENCE)
    assert client.returncode == 0, said.decode() + complained.decode()


def result(folder: Path) -> pa.Table:
    return parquet.read_table(folder / "results.parquet").replace_schema_metadata(None)


def uninterrupted(plan: dict[str, object] = SMALL) -> pa.Table:
    return pa.concat_tables([task.run() for task in tasks(make(plan, "test"))])


@pytest.mark.slow  # In every run: tests/validation/campaigns/test_session.py, a worker that kills itself.
def test_a_killed_worker_costs_its_batch_and_no_other(tmp_path: Path) -> None:
    client = start(tmp_path / "c")
    wait_for(client, lambda: sum(events(tmp_path / "c", "done").values()) >= 5)
    os.kill(busy_worker(tmp_path / "c"), signal.SIGKILL)
    ended_well(client)
    begun = events(tmp_path / "c", "begun")
    assert sum(begun.values()) - len(begun) <= 1
    assert set(events(tmp_path / "c", "done").values()) == {1}
    assert result(tmp_path / "c").equals(uninterrupted())


@pytest.mark.slow  # In every run: an interrupt, and parts that a kill in the middle of writing leaves out.
def test_a_killed_client_costs_what_its_workers_were_at(tmp_path: Path) -> None:
    client = start(tmp_path / "c")
    wait_for(client, lambda: sum(events(tmp_path / "c", "done").values()) >= 5)
    client.kill()
    client.wait()
    finished = set(events(tmp_path / "c", "done"))
    assert not (tmp_path / "c" / "results.parquet").exists()
    ended_well(resume(tmp_path / "c"))
    begun = events(tmp_path / "c", "begun")
    again = {batch for batch, times in begun.items() if times > 1}
    assert len(begun) == 30 and len(again) <= WORKERS and not again & finished
    assert result(tmp_path / "c").equals(uninterrupted())


@pytest.mark.slow
def test_an_interrupt_ends_in_words_and_is_resumed(tmp_path: Path) -> None:
    client = start(tmp_path / "c", FEW, workers=1)
    wait_for(client, lambda: sum(events(tmp_path / "c", "done").values()) >= 3)
    os.killpg(client.pid, signal.SIGINT)  # As Ctrl-C: client and workers get it.
    _, complained = client.communicate(timeout=PATIENCE)
    assert client.returncode == 130
    assert f"campaign resume {tmp_path / 'c'}" in complained.decode() and "Traceback" not in complained.decode()
    finished = set(events(tmp_path / "c", "done"))
    ended_well(resume(tmp_path / "c", workers=1))
    assert all(events(tmp_path / "c", "begun")[batch] == 1 for batch in finished)
    assert result(tmp_path / "c").equals(uninterrupted(FEW))
