"""The protocol of worker processes: whatever a job does to its process, the others have theirs."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from validation.worker_process import WorkerError, WorkerProcess

FATES = {
    "raises": ("raised", None, "KeyError: 'no joint 7'"),
    "leaves": ("raised", None, "SystemExit: 3"),
    "crashes": ("crashed", -signal.SIGABRT, "killed by SIGABRT: memory"),
    "exits": ("crashed", 9, "exit code 9"),
    "hangs": ("timed out", None, "no answer in 2 s"),
    "prints": ("", None, ""),
    "counts": ("", None, ""),
}
NAMED: list[int] = []


def job(fate: str) -> Iterator[str]:
    """Answer once, and end in some way."""
    yield "first"
    if fate == "raises":
        raise KeyError("no joint 7")
    if fate == "leaves":
        sys.exit(3)
    if fate == "crashes":
        print("not enough\nmemory", flush=True)
        os.abort()
    if fate == "exits":
        os._exit(9)
    if fate == "hangs":
        time.sleep(60)
    if fate == "prints":
        os.write(1, b"not an answer\n")
        print(sys.stdin.read())


def called() -> int:
    """How often this was called in one process."""
    NAMED.append(1)
    return len(NAMED)


def grabbed(count: int) -> int:
    return len(bytearray(count))


def spun() -> None:
    while True:
        pass


def started(path: Path) -> Iterator[int]:
    """Start a process that would outlive this one."""
    yield subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"]).pid
    time.sleep(60)


def is_alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    return Path(f"/proc/{process}/stat").read_text().split()[2] != "Z" if Path("/proc/self").exists() else True


def ends(process: int) -> bool:
    """Whether a process is gone soon."""
    for _ in range(200):
        if not is_alive(process):
            return True
        time.sleep(0.05)
    return False


@pytest.mark.parametrize("fresh", [False, True])
def test_each_end_of_a_job_is_reported_and_the_next_job_is_done(fresh: bool, tmp_path: Path) -> None:
    with WorkerProcess(fresh=fresh, log=tmp_path / "log") as worker:
        for fate, (wanted, code, reason) in FATES.items():
            answers: list[str] = []
            try:
                for answer in worker.call(job, fate, limit=2.0 if fate == "hangs" else 60.0):
                    answers.append(answer)
                found: tuple[str, int | None, str] = ("", None, "")
            except WorkerError as error:
                found = error.fate, error.code, str(error)
            assert (answers, found) == (["first"], (wanted, code, reason))


def test_a_fresh_process_has_nothing_of_another_job_and_is_bounded() -> None:
    with WorkerProcess() as kept, WorkerProcess(fresh=True) as fresh:
        assert [[*worker.call(called)] for worker in (kept, kept, fresh, fresh)] == [[1], [2], [1], [1]]
        with pytest.raises(WorkerError, match="MemoryError"):
            list(fresh.call(grabbed, 1 << 40, memory=4 << 30))
        with pytest.raises(WorkerError, match="SIGXCPU"):
            list(fresh.call(spun, seconds=0.0, limit=60.0))


@pytest.mark.parametrize("fresh", [False, True])
def test_a_job_that_is_left_ends_with_all_that_it_started(fresh: bool) -> None:
    with WorkerProcess(fresh=fresh) as worker:
        process = next(worker.call(started, Path()))
        assert ends(process)
        assert list(worker.call(called)) == [1]


@pytest.mark.parametrize("fresh", [False, True])
def test_a_worker_ends_with_its_parent_process(fresh: bool) -> None:
    """Were it to go on, it would take a core from whatever is measured next."""
    code = (
        "from tests.validation.test_worker_process import started, WorkerProcess; import sys, time\n"
        f"answers = WorkerProcess(fresh={fresh}).call(started, None)\n"
        "print(next(answers), flush=True); time.sleep(60)"
    )
    with subprocess.Popen(
        [sys.executable, "-c", code],
        stdout=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
    ) as parent:
        assert parent.stdout is not None
        process = int(parent.stdout.readline())
        assert is_alive(process)
        parent.kill()
    assert ends(process)
