"""What a worker process does: started as a script by `worker_process.py`, it takes jobs and sends their answers.

It imports nothing of ours by itself. Both streams hold pickles. First comes the start:
{"path": the search path of modules, empty for that of a new interpreter, "preload": modules to load in advance,
"fresh": whether each job gets a child of its own}. Then come jobs, one after the other:
{"module", "function", "arguments": a pickle, "seconds": of processor time, "memory": in bytes}; the two bounds hold in
a child only. What goes back is a kind and a value: ("begun", the process that does the job), an ("answer", a pickle)
for each result, ("raised", words) for an exception, and at last ("ended", None), or the exit code of a child that did
not come to its end. When the other side is gone, the process that does a job ends, and what it started with it.
"""

from __future__ import annotations

import importlib
import inspect
import os
import pickle
import signal
import sys
import threading
import traceback
from collections.abc import Callable, Mapping
from contextlib import suppress
from queue import SimpleQueue
from typing import IO, Any

Send = Callable[[str, Any], None]
ENDED = ("ended", None)


def main() -> None:
    """Serve until the requests end."""
    requests, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)  # Whatever else reads must not get the requests,
    os.dup2(2, 1)  # and what it prints must not garble the answers.
    start = pickle.load(requests)
    sys.path[:] = start["path"] or sys.path
    for name in start["preload"]:
        with suppress(ImportError):  # What is not installed is said by the job that asks for it.
            importlib.import_module(name)
    if start["fresh"] and hasattr(os, "fork"):
        _serve_in_children(requests, answers)
    else:
        _serve_here(requests, answers)


def _serve_here(requests: IO[bytes], answers: IO[bytes]) -> None:
    """Do one job after the other in this process."""
    jobs: SimpleQueue[Mapping[str, Any]] = SimpleQueue()
    threading.Thread(target=_read, args=(requests, jobs.put), daemon=True).start()
    send = _sender(answers)
    while True:
        _do(jobs.get(), send)


def _serve_in_children(requests: IO[bytes], answers: IO[bytes]) -> None:
    """Do each job in a child of this process, and pass on what it sends."""
    send = _sender(answers)
    while True:
        try:
            job = pickle.load(requests)
        except EOFError:
            return
        reading, writing = os.pipe()
        child = os.fork()
        if child == 0:
            os.close(reading)
            os.close(answers.fileno())  # So that the end of this process is the end of its answers.
            _do_as_child(job, writing, requests)
        os.close(writing)
        message: tuple[str, Any] | None = None
        with os.fdopen(reading, "rb") as said:
            while (following := received(said)) is not None:
                message = following
                if message != ENDED:  # Held back until the child is gone.
                    send(*message)
        _end_group(child)  # What it started goes with it.
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        send("ended", None if message == ENDED else code)


def _do_as_child(job: Mapping[str, Any], writing: int, requests: IO[bytes]) -> None:
    """Do a job in the child process; never returns."""
    code = 1
    try:
        os.setsid()
        bound(job["seconds"], job["memory"])
        threading.Thread(target=_read, args=(requests, _ignored), daemon=True).start()
        with os.fdopen(writing, "wb") as answers:
            _do(job, _sender(answers))
        code = 0
    finally:
        with suppress(Exception):
            sys.stdout.flush()
        os._exit(code)


def _do(job: Mapping[str, Any], send: Send) -> None:
    """Import, call, answer; an exception is an answer, wherever it is raised."""
    send("begun", os.getpid())
    try:
        function = getattr(importlib.import_module(job["module"]), job["function"])
        arguments, named = pickle.loads(job["arguments"])
        result = function(*arguments, **named)
        for answer in result if inspect.isgenerator(result) else (result,):
            send("answer", pickle.dumps(answer))
    except BaseException as error:
        traceback.print_exc()
        send("raised", f"{type(error).__name__}: {error}")
    send(*ENDED)


def bound(seconds: float | None, memory: int | None) -> None:
    """Bound the processor time [s] and the memory [bytes] of this process, where the system can."""
    try:
        import resource  # Windows has none.
    except ImportError:
        return
    bounds = {resource.RLIMIT_CORE: (0, 0)}
    if seconds is not None:
        bounds[resource.RLIMIT_CPU] = int(seconds) + 1, int(seconds) + 5
    if memory is not None:
        bounds[resource.RLIMIT_AS] = memory, memory
    for what, limits in bounds.items():
        with suppress(ValueError, OSError):  # Not every system bounds the address space.
            resource.setrlimit(what, limits)


def received(stream: IO[bytes]) -> tuple[str, Any] | None:
    """The next message of a stream; None where it ends, be it within a message."""
    try:
        message: tuple[str, Any] = pickle.load(stream)
    except (EOFError, OSError, ValueError, pickle.UnpicklingError):
        return None
    return message


def _sender(stream: IO[bytes]) -> Send:
    def send(kind: str, value: Any) -> None:
        pickle.dump((kind, value), stream)
        stream.flush()

    return send


def _read(requests: IO[bytes], take: Callable[[Mapping[str, Any]], object]) -> None:
    """Hand on requests; when they end, this process ends, whatever it computes, with all that it started."""
    with suppress(EOFError, OSError, ValueError):
        while True:
            take(pickle.load(requests))
    _end_group(0)
    os._exit(1)  # Where there are no groups of processes.


def _ignored(_: Mapping[str, Any]) -> None:
    """No job comes before the end of the present one."""


def _end_group(leader: int) -> None:
    """Kill a group of processes; 0: this process's own."""
    with suppress(ProcessLookupError, PermissionError, AttributeError):
        os.killpg(leader, signal.SIGKILL)


if __name__ == "__main__":
    main()
