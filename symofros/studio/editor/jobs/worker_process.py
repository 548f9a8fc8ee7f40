"""The process of a worker, seen from the server: requests and orders in, lines of answers out."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import IO

import symofros

MAX_ANSWER = 256 << 20
MAX_COMPLAINT = 2000
SECONDS_TO_END = 5.0


class WorkerProcess:
    """A Python that waits for requests; nothing is imported from the folder that it works in.

    Attributes:
        served: Number of requests that it has answered.
    """

    def __init__(self) -> None:
        home = str(Path(symofros.__file__).parents[1])
        path = os.pathsep.join(filter(None, (home, os.environ.get("PYTHONPATH"))))
        self.served = 0
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", "symofros.studio.editor.jobs.worker"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            start_new_session=True,
            env={**os.environ, "PYTHONPATH": path},
        )
        self._complaint: list[bytes] = []
        self._reader = threading.Thread(target=_tail, args=(self._process.stderr, self._complaint), daemon=True)
        self._reader.start()

    @property
    def is_alive(self) -> bool:
        """Whether it can be sent a request."""
        return self._process.poll() is None

    def send(self, line: str) -> None:
        """Send a line: a request, or an order.

        Raises:
            OSError: It has ended.
        """
        stdin = self._process.stdin
        assert stdin is not None
        try:
            stdin.write(line.encode() + b"\n")
            stdin.flush()
        except ValueError:  # Closed by `end`.
            raise OSError("the worker has ended") from None

    def lines(self) -> Iterator[bytes]:
        """Lines of the worker's output until it ends."""
        stdout = self._process.stdout
        assert stdout is not None
        return iter(lambda: stdout.readline(MAX_ANSWER), b"")

    def kill(self) -> None:
        """End it and whatever it has started: they share a process group of their own."""
        if self.is_alive:
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(self._process.pid, signal.SIGKILL)

    def end(self) -> tuple[int, str]:
        """Kill the worker if it runs; its exit code, and the end of its error output."""
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(self._process.pid, signal.SIGKILL)
        code = self._process.wait()
        self._reader.join(SECONDS_TO_END)
        for stream in (self._process.stdin, self._process.stdout, self._process.stderr):
            with contextlib.suppress(OSError):
                if stream is not None:
                    stream.close()
        return code, b"".join(self._complaint).decode(errors="replace")


def _tail(stream: IO[bytes], kept: list[bytes]) -> None:
    """Keep the end of a worker's error output."""
    text = b""
    for line in iter(lambda: stream.readline(MAX_COMPLAINT), b""):
        text = (text + line)[-MAX_COMPLAINT:]
        kept[:] = [text]
