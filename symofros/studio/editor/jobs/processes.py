"""Long work in processes of its own: it reports progress, can be stopped, and may crash without harm."""

from __future__ import annotations

import contextlib
import json
import threading
from collections.abc import Callable
from typing import Any

from symofros.studio.editor.editing.data_edits import EditError
from symofros.studio.editor.jobs.request import ORDERS
from symofros.studio.editor.jobs.worker_process import WorkerProcess

Json = dict[str, Any]

KEPT = 20
# Workers that wait for the next request: what they have imported and compiled is there already.
IDLE = 2


class Job:
    """One piece of work and its process."""

    def __init__(self, key: str, kind: str, revision: int, path: str) -> None:
        self.key, self.kind, self.revision, self.path = key, kind, revision, path
        self.state = "running"
        self.progress: Json = {"done": 0, "total": 0, "text": "starting"}
        self.result: Any = None
        self.error: Json | None = None
        self.worker: WorkerProcess | None = None
        self.over = threading.Event()

    def as_json(self, whole: bool = True) -> Json:
        """The job as JSON for the page; with `whole=False` without the result, which may be large."""
        summary = {
            "id": self.key,
            "kind": self.kind,
            "revision": self.revision,
            "path": self.path,
            "state": self.state,
            "progress": self.progress,
            "error": self.error,
        }
        return {**summary, "result": self.result} if whole else summary

    def motion(self, block: str = "") -> Json:
        """The motion that a simulation, an analysis or a diagram's run has led to: "t", "series", "par".

        Args:
            block: Block of a diagram that moves a mechanism, or motion of an analysis; "" for the first one.

        Raises:
            EditError: It is another job, has no result, or moves no such mechanism.
        """
        result = self.result if isinstance(self.result, dict) else {}
        if self.kind == "simulate" and result:
            return result
        motions: Json = result.get("motions", {}) if self.kind in ("run", "analyse") else {}
        chosen = block or next(iter(motions), "")
        if chosen not in motions:
            actual = f"block '{block[:50]}' of {', '.join(motions)}" if motions else f"{self.kind}, {self.state}"
            rule = "a motion is that of a simulation, an analysis, or of a block of a run that moves a mechanism"
            raise EditError(f"job {self.key} has no such motion", actual, rule, "simulate or run it first")
        motion: Json = motions[chosen]
        return motion


class Jobs:
    """Running and finished jobs."""

    def __init__(self, publish: Callable[[str, Json], None]) -> None:
        self.publish = publish
        self._jobs: dict[str, Job] = {}
        self._idle: list[WorkerProcess] = []
        self._closed = False
        self._lock = threading.Lock()
        self._count = 0

    def warm(self) -> None:
        """Have a worker wait, if none does and none is at work."""
        with self._lock:
            if not self._closed and not self._idle and all(job.worker is None for job in self._jobs.values()):
                self._idle.append(WorkerProcess())

    def running(self) -> list[Job]:
        """Jobs that are not over."""
        return [job for job in self._jobs.values() if job.state == "running"]

    def start(self, kind: str, request: Json, revision: int = 0, path: str = "") -> Job:
        """Start a worker; a job of that kind for a document that was left, of which nothing is shown, is cancelled.

        Raises:
            EditError: One of that kind is running for the same document.
        """
        for left in self.running():
            if left.kind == kind and left.path != path:
                self.cancel(left.key)
        with self._lock:
            running = [job for job in self.running() if job.kind == kind]
            if running:
                raise EditError(
                    f"{kind} is running already",
                    f"job {running[0].key}",
                    "one job of a kind runs at a time",
                    "wait for it, or cancel it",
                )
            self._count += 1
            job = Job(str(self._count), kind, revision, path)
            self._jobs[job.key] = job
            over = [key for key, old in self._jobs.items() if old.state != "running"]
            for key in over[: max(0, len(self._jobs) - KEPT)]:
                del self._jobs[key]
            job.worker = self._free_worker()
        threading.Thread(target=self._follow, args=(job, {"kind": kind, **request}), daemon=True).start()
        return job

    def get(self, key: str) -> Job:
        """A job by its id.

        Raises:
            EditError: There is none, or none any more.
        """
        if key not in self._jobs:
            raise EditError(
                f"no job '{key[:50]}'",
                ", ".join(self._jobs) or "none",
                f"the last {KEPT} jobs are kept",
                "start it again",
            )
        return self._jobs[key]

    def order(self, key: str, order: Any) -> Job:
        """Tell a running job to pause, to continue, or to end with its present results.

        Raises:
            EditError: There is no such order, or no such job.
        """
        job = self.get(key)
        if order not in ORDERS:
            raise EditError("no such order", f"{order!r:.50}", f"one of {', '.join(ORDERS)}", "choose one of them")
        with self._lock:
            # Before its first progress a worker has not read its request, behind which the order would be lost.
            if job.state == "running" and job.progress["total"] and job.worker is not None:
                with contextlib.suppress(OSError):  # It ends at this moment.
                    job.worker.send(order)
        return job

    def cancel(self, key: str) -> Job:
        """Kill a job's processes; one that is over stays as it is."""
        job = self.get(key)
        with self._lock:
            if job.state == "running":
                job.state = "cancelled"
                if job.worker is not None:
                    job.worker.kill()
        job.over.wait(10.0)
        return job

    def close(self) -> None:
        """Kill whatever runs or waits."""
        with self._lock:
            self._closed = True
            waiting, self._idle = self._idle, []
        for worker in waiting:
            worker.end()
        for key in list(self._jobs):
            self.cancel(key)

    def _free_worker(self) -> WorkerProcess:
        """A worker that waits, or a new one; the caller holds the lock."""
        while self._idle:
            worker = self._idle.pop()
            if worker.is_alive:
                return worker
            worker.end()
        return WorkerProcess()

    def _follow(self, job: Job, request: Json) -> None:
        """Send a worker its request and read its messages until it answers or ends; replace one that died idle."""
        worker = job.worker
        assert worker is not None
        heard = self._listen(job, worker, request)
        if not heard and worker.served and job.state == "running":
            # One that had waited ended before it could begin; that says nothing about this job.
            worker.end()
            with self._lock:
                job.worker = worker = WorkerProcess()
            self._listen(job, worker, request)
        is_answered = job.result is not None or job.error is not None
        code, complaint = (0, "") if is_answered else worker.end()
        with self._lock:
            is_kept = is_answered and job.state == "running" and len(self._idle) < IDLE and not self._closed
            if is_kept:
                worker.served += 1
                self._idle.append(worker)
            if job.state == "running":
                self._end(job, code, complaint)
            job.worker = None
        if is_answered and not is_kept:
            worker.end()
        job.over.set()
        self.publish("job", job.as_json(whole=False))

    def _listen(self, job: Job, worker: WorkerProcess, request: Json) -> bool:
        """Send a request to a worker and read its messages until it answers or ends; whether there were any."""
        heard = False
        with contextlib.suppress(OSError):  # It has died already; that is found below.
            worker.send(json.dumps(request))
        for line in worker.lines():
            heard = True
            self._take(job, line)
            if job.result is not None or job.error is not None:
                break
        return heard

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
