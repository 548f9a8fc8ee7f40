"""A process that has loaded the engines, and forks one child for each task: run as a script, in an overlay of the tree.

It imports nothing of ours: each child imports the package anew, with the fault that is planted in it at the time. Tasks
and answers are lines of JSON on standard input and output. A child that crashes or does not end is an answer, too.
"""

from __future__ import annotations

import importlib
import json
import os
import select
import signal
import sys
import time
import traceback
from contextlib import suppress
from typing import Any

# What children need and what takes long to import; what is not installed is left out.
PRELOADED = (
    "numpy numpy.testing numpy.random mpmath scipy.optimize scipy.linalg scipy.sparse scipy.integrate scipy.spatial"
    " pinocchio mujoco casadi exudyn yaml sksundae pytest hypothesis _pytest.assertion.rewrite typer rich.console"
).split()
MEMORY = 12 << 30  # Bytes of address space: a fault may ask for all there is.
WAIT = 8  # Seconds that a child is waited for, over those of processor time: other work delays it.


def main() -> None:
    """Serve until standard input ends."""
    sys.path[:] = [path for path in sys.path if path != os.path.dirname(os.path.abspath(__file__))]
    for name in PRELOADED:
        with suppress(ImportError):
            importlib.import_module(name)
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    for line in sys.stdin:
        answers.write(json.dumps(_served(json.loads(line))) + "\n")
        answers.flush()


def _served(task: dict[str, Any]) -> dict[str, Any]:
    """How a task ended in a child of its own, which gets `limit` seconds of processor time, and WAIT times as many."""
    began = time.perf_counter()
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        _work(task, writing)
    os.close(writing)
    received, ended = b"", False
    while not ended:
        left = began + WAIT * task["limit"] - time.perf_counter()
        ready = select.select([reading], [], [], max(0.0, left))[0]
        if not ready:
            break
        piece = os.read(reading, 1 << 16)
        received, ended = received + piece, not piece
    os.close(reading)
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(child, signal.SIGKILL)  # What it started goes with it.
    with suppress(ProcessLookupError):
        os.kill(child, signal.SIGKILL)
    _, status = os.waitpid(child, 0)
    answer = json.loads(received) if received and ended else None
    fate = "answered" if answer is not None else "crashed" if ended else "timed out"
    code = os.waitstatus_to_exitcode(status)
    fate = "timed out" if code == -signal.SIGXCPU else fate
    return {"fate": fate, "code": code, "answer": answer, "seconds": round(time.perf_counter() - began, 2)}


def _work(task: dict[str, Any], writing: int) -> None:
    """Run a task in the child process: import, call, answer; never returns."""
    code = 1
    try:
        os.setsid()
        _limit_resources(task["limit"])
        log = os.open(task["log"], os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
        os.dup2(log, 1)
        os.dup2(log, 2)
        sys.stdin = open(os.devnull, encoding="utf-8")
        sys.path.insert(0, os.getcwd())
        try:
            work = getattr(importlib.import_module(task["module"]), task["function"])
            answer = work(**task["arguments"])
        except BaseException as error:  # A fault may raise anything, and wherever it is imported.
            traceback.print_exc()
            answer = {"status": "raised", "reason": f"{type(error).__name__}: {error}"[:300]}
        with os.fdopen(writing, "wb") as stream:
            stream.write(json.dumps(answer).encode())
        code = 0
    finally:
        os._exit(code)


def _limit_resources(seconds: float) -> None:
    with suppress(ImportError, ValueError, OSError):
        resource = importlib.import_module("resource")
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_CPU, (int(seconds) + 1, int(seconds) + 5))


if __name__ == "__main__":
    main()
