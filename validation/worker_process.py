"""Worker processes of the harness: one that crashes, hangs or raises is an answer, and harms nothing but its job.

A worker is started when it is first asked, and anew after its process has ended. It does one job at a time: a function,
named by its module, with arguments that pickle; each value of a generator is an answer, of other functions the result.
It has the environment and the search path that it is given, and prints to the standard error of this process, or to a
file. `worker_loop.py` is its other side, and has the messages.
"""

from __future__ import annotations

import os
import pickle
import queue
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import IO, Any, Self

from .worker_loop import received

_SCRIPT = Path(__file__).with_name("worker_loop.py")
# Seconds in which a process that is gone for others is gone for this one.
_ENDING = 5.0

Message = tuple[str, Any]


class WorkerError(RuntimeError):
    """A job that a worker did not bring to its end; the message says why.

    Args:
        reason: Why.
        fate: "raised", "crashed" or "timed out".
        code: Exit code of a process that crashed.
    """

    def __init__(self, reason: str, fate: str, code: int | None = None) -> None:
        super().__init__(reason)
        self.fate, self.code = fate, code


class WorkerProcess:
    """A process that does jobs.

    Args:
        environment: Variables that it has beside those of this process.
        path: Where it looks for modules: as this process does unless stated; where empty, as a new interpreter does.
        folder: Folder that it works in; that of this process unless stated.
        preload: Names of modules to load before the first job.
        fresh: Whether each job gets a process of its own, forked once these are loaded: nothing of another job is in
            it, and processor time and memory can be bounded. Where the system can't fork, the whole is started anew.
        log: File that gets what the jobs print, that of the latest alone, the last line of which says why one crashed;
            None: the standard error of this process.
        python: Interpreter that runs it, of another environment; that of this process unless stated.
    """

    def __init__(
        self,
        *,
        environment: Mapping[str, str] | None = None,
        path: Sequence[str] | None = None,
        folder: Path | None = None,
        preload: Sequence[str] = (),
        fresh: bool = False,
        log: Path | None = None,
        python: Path | None = None,
    ) -> None:
        self._python = str(python or sys.executable)
        self._environment = {**os.environ, **(environment or {})}
        self._path, self._preload = list(sys.path if path is None else path), tuple(preload)
        self._folder, self._fresh, self._log = folder, fresh, log
        self._process: subprocess.Popen[bytes] | None = None
        self._messages: queue.SimpleQueue[Message | None] = queue.SimpleQueue()
        self._doing = 0  # The process that does the job: the worker itself, or its child.

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def call(
        self,
        function: Callable[..., Any] | tuple[str, str],
        *arguments: Any,
        named: Mapping[str, Any] | None = None,
        limit: float | None = None,
        seconds: float | None = None,
        memory: int | None = None,
    ) -> Iterator[Any]:
        """The answers of a job, as they come; who does not take them all ends the process.

        Args:
            function: A function of a module, or the names of both.
            arguments: Its arguments.
            named: Those that are given by name.
            limit: Wall time for each answer, and for the end [s].
            seconds: Processor time of the job [s], where it has a process of its own.
            memory: Its address space [bytes], likewise.

        Raises:
            WorkerError: It raised, crashed, or gave no answer in time.
        """
        names = function if isinstance(function, tuple) else (function.__module__, function.__qualname__)
        job = {"module": names[0], "function": names[1], "arguments": pickle.dumps((arguments, named or {}))}
        failure: WorkerError | None = None
        has_ended = False
        process = self._started({**job, "seconds": seconds, "memory": memory})
        try:
            while not has_ended:
                kind, value = self._message(process, limit)
                if kind == "begun":
                    self._doing = value
                elif kind == "answer":
                    yield pickle.loads(value)
                elif kind == "raised":
                    failure = WorkerError(value, "raised")
                else:
                    has_ended = True
                    failure = failure if value is None else self._crashed(value)
        finally:
            # Where the system can't fork, a process that is to be fresh for each job has done its only one.
            if not has_ended or (self._fresh and self._doing == process.pid):
                self.close()
            self._doing = 0
        if failure is not None:
            raise failure

    def close(self) -> None:
        """End the process, and whatever its job has started."""
        process, self._process = self._process, None
        if process is None:
            return
        for group in {self._doing, process.pid} - {0}:
            with suppress(ProcessLookupError, PermissionError, AttributeError):
                os.killpg(group, signal.SIGKILL)
        process.kill()
        process.wait()
        self._doing = 0
        assert process.stdin is not None
        with suppress(OSError):
            process.stdin.close()

    def _started(self, job: Mapping[str, Any]) -> subprocess.Popen[bytes]:
        """The process, which has got a job."""
        if self._log is not None:
            self._log.write_bytes(b"")
        if self._process is None or self._process.poll() is not None:
            self.close()
            self._process = self._new_process()
        stdin = self._process.stdin
        assert stdin is not None
        with suppress(OSError):  # It has ended at this moment, which the end of its messages says.
            pickle.dump(job, stdin)
            stdin.flush()
        return self._process

    def _new_process(self) -> subprocess.Popen[bytes]:
        self._messages = queue.SimpleQueue()
        with open(self._log or os.devnull, "ab") as log:
            process = subprocess.Popen(
                [self._python, "-P", str(_SCRIPT)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=log if self._log else None,
                cwd=self._folder,
                env=self._environment,
                start_new_session=True,  # Ctrl-C is this process's, which ends its workers.
            )
        assert process.stdin is not None and process.stdout is not None
        threading.Thread(target=_listen, args=(process.stdout, self._messages), daemon=True).start()
        with suppress(OSError):
            pickle.dump({"path": self._path, "preload": self._preload, "fresh": self._fresh}, process.stdin)
        return process

    def _message(self, process: subprocess.Popen[bytes], limit: float | None) -> Message:
        """The next message.

        Raises:
            WorkerError: There is none in time, or the process has ended.
        """
        try:
            message = self._messages.get(timeout=limit)
        except queue.Empty:
            raise WorkerError(f"no answer in {limit:g} s", "timed out") from None
        if message is None:
            raise self._crashed(process.wait(_ENDING))
        return message

    def _crashed(self, code: int) -> WorkerError:
        """What the code of a process says of its end, with the last line of its log."""
        reason = f"killed by {signal.Signals(-code).name}" if code < 0 else f"exit code {code}"
        said = self._log.read_text(encoding="utf-8", errors="replace").strip() if self._log else ""
        return WorkerError(": ".join([reason, *said.splitlines()[-1:]]), "crashed", code)


def _listen(stream: IO[bytes], messages: queue.SimpleQueue[Message | None]) -> None:
    """Keep the messages of a worker, and None for its end."""
    with stream:
        while (message := received(stream)) is not None:
            messages.put(message)
    messages.put(None)
