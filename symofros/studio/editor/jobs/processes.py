"""Long work in processes of its own: it reports progress, can be stopped, and may crash without harm."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import IO, Any

import symofros
from symofros.studio.editor.editing.data_edits import refusal
from symofros.studio.editor.jobs.request import ORDERS

Json = dict[str, Any]

MAX_ANSWER = 256 << 20
MAX_COMPLAINT = 2000
KEPT = 20


class Job:
    """One piece of work and its process."""

    def __init__(self, key: str, kind: str, revision: int) -> None:
        self.key, self.kind, self.revision = key, kind, revision
        self.state = "running"
        self.progress: Json = {"done": 0, "total": 0, "text": "starting"}
        self.result: Any = None
        self.error: Json | None = None
        self.process: subprocess.Popen[bytes] | None = None
        self.over = threading.Event()

    def as_json(self, whole: bool = True) -> Json:
        """For the page; not whole: without the result, which may be large."""
        summary = {
            "id": self.key,
            "kind": self.kind,
            "revision": self.revision,
            "state": self.state,
            "progress": self.progress,
            "error": self.error,
        }
        return {**summary, "result": self.result} if whole else summary


class Jobs:
    """What is running, and what was."""

    def __init__(self, publish: Callable[[str, Json], None]) -> None:
        self.publish = publish
        self._jobs: dict[str, Job] = {}
        self._lock = threading.Lock()
        self._count = 0

    def start(self, kind: str, request: Json, revision: int = 0) -> Job:
        """Start a worker.

        Args:
            kind: Kind of job, a key of tasks.TASKS.
            request: Request that the worker process receives.
            revision: Revision of the document.

        Raises:
            EditError: One of that kind is running.
        """
        with self._lock:
            running = [job for job in self._jobs.values() if job.kind == kind and job.state == "running"]
            if running:
                raise refusal(
                    f"{kind} is running already",
                    f"job {running[0].key}",
                    "one job of a kind runs at a time",
                    "wait for it, or cancel it",
                )
            self._count += 1
            job = Job(str(self._count), kind, revision)
            self._jobs[job.key] = job
            over = [key for key, old in self._jobs.items() if old.state != "running"]
            for key in over[: max(0, len(self._jobs) - KEPT)]:
                del self._jobs[key]
            job.process = _worker()
        threading.Thread(target=self._follow, args=(job, {"kind": kind, **request}), daemon=True).start()
        return job

    def get(self, key: str) -> Job:
        """A job by its id.

        Raises:
            EditError: There is none, or none any more.
        """
        if key not in self._jobs:
            raise refusal(
                f"no job '{key[:50]}'",
                ", ".join(self._jobs) or "none",
                f"the last {KEPT} jobs are kept",
                "start it again",
            )
        return self._jobs[key]

    def order(self, key: str, order: Any) -> Job:
        """Tell a job that is running to pause, to go on, or to end with what it has.

        Raises:
            EditError: There is no such order, or no such job.
        """
        job = self.get(key)
        if order not in ORDERS:
            raise refusal("no such order", f"{order!r:.50}", f"one of {', '.join(ORDERS)}", "choose one of them")
        with self._lock:
            # Before its first progress a worker has not read its request, behind which the order would be lost.
            if job.state == "running" and job.progress["total"] and job.process is not None and job.process.stdin:
                with contextlib.suppress(OSError):  # It ends at this moment.
                    job.process.stdin.write(order.encode() + b"\n")
                    job.process.stdin.flush()
        return job

    def cancel(self, key: str) -> Job:
        """Kill a job's processes; one that is over stays as it is."""
        job = self.get(key)
        with self._lock:
            if job.state == "running":
                job.state = "cancelled"
                if job.process is not None and job.process.poll() is None:
                    _kill(job.process)
        job.over.wait(10.0)
        return job

    def close(self) -> None:
        """Kill whatever runs."""
        for key in list(self._jobs):
            self.cancel(key)

    def _follow(self, job: Job, request: Json) -> None:
        """Give a worker its request, and take what it says until it ends."""
        process = job.process
        assert process is not None and process.stdin and process.stdout and process.stderr
        complaint: list[bytes] = []
        reader = threading.Thread(target=_tail, args=(process.stderr, complaint), daemon=True)
        reader.start()
        with contextlib.suppress(OSError):  # It has died already; that is found below.
            process.stdin.write(json.dumps(request).encode() + b"\n")
            process.stdin.flush()
        for line in iter(lambda: process.stdout.readline(MAX_ANSWER), b""):  # type: ignore[union-attr]
            self._take(job, line)
        _kill(process)
        code = process.wait()
        reader.join(5.0)
        for stream in (process.stdin, process.stdout, process.stderr):
            with contextlib.suppress(OSError):
                stream.close()
        with self._lock:
            if job.state == "running":
                self._end(job, code, b"".join(complaint).decode(errors="replace"))
        job.over.set()
        self.publish("job", job.as_json(whole=False))

    def _take(self, job: Job, line: bytes) -> None:
        try:
            said = json.loads(line)
        except (ValueError, RecursionError):  # Too long, or cut off by a crash; the end of the process says which.
            return
        if not isinstance(said, dict):
            return
        if "progress" in said:
            job.progress = said["progress"]
            self.publish("job", job.as_json(whole=False))
        if "samples" in said:
            self.publish("samples", {"id": job.key, **said["samples"]})
        job.result, job.error = said.get("result", job.result), said.get("error", job.error)

    def _end(self, job: Job, code: int, complaint: str) -> None:
        if job.error is None and job.result is None:
            why = f"signal {-code}" if code < 0 else f"exit code {code}"
            job.error = {
                "object": f"{job.kind}: the worker ended without an answer",
                "found": f"{why}; {complaint}".strip("; "),
                "rule": "a worker answers or says what is wrong",
                "remedy": "the editor goes on; please report it",
            }
        job.state = "failed" if job.error is not None else "done"


def _worker() -> subprocess.Popen[bytes]:
    """A Python that waits for its request; nothing is imported from the folder that it works in."""
    home = str(Path(symofros.__file__).parents[1])
    path = os.pathsep.join(filter(None, (home, os.environ.get("PYTHONPATH"))))
    return subprocess.Popen(
        [sys.executable, "-P", "-m", "symofros.studio.editor.jobs.worker"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
        env={**os.environ, "PYTHONPATH": path},
    )


def _kill(process: subprocess.Popen[bytes] | None) -> None:
    """End a worker and whatever it has started: they share a process group of their own."""
    if process is None:
        return
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(process.pid, signal.SIGKILL)


def _tail(stream: IO[bytes], kept: list[bytes]) -> None:
    """Keep the end of what a worker complains about."""
    text = b""
    for line in iter(lambda: stream.readline(MAX_COMPLAINT), b""):
        text = (text + line)[-MAX_COMPLAINT:]
    kept.append(text)
