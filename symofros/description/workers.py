"""Processes with few rights that read files from elsewhere, or run their code: scripts, asked and answered in JSON."""

from __future__ import annotations

import json
import os
import select
import signal
import subprocess
import sys
import time
from collections.abc import Mapping
from contextlib import suppress
from threading import Thread
from typing import Any

# Bytes of what a worker prints that are kept: a file may ask for any number of warnings.
MAX_PRINTED = 20_000


def answer_of(script: str, task: Mapping[str, Any], timeout: float, bounds: str) -> dict[str, Any]:
    """Run a worker and return its answer; {"fault": ...} if it takes too long or fails.

    Args:
        script: Path of the worker's script, which bounds its own processor time and memory.
        task: What it reads.
        timeout: Wall time [s].
        bounds: Limits that a worker may have hit when it ended without an answer, as text after "it takes".

    Returns:
        The answer, with the beginning of what the worker printed to its standard error as "printed".
    """
    printed = _Beginning()
    try:
        done = subprocess.run(
            [sys.executable, "-I", script],
            input=json.dumps(task).encode(),
            stdout=subprocess.PIPE,
            stderr=printed.writer,
            timeout=timeout,
            env={},
        )
    except subprocess.TimeoutExpired:
        return {"fault": f"it takes longer than {timeout} s", "printed": printed.text()}
    finally:
        printed.close()
    answer: dict[str, Any]
    try:
        answer = {"fault": f"it takes {bounds}"} if done.returncode else json.loads(done.stdout)
    except ValueError:
        answer = {"fault": "it prints what is no answer"}
    return {**answer, "printed": printed.text()}


class Conversation:
    """A worker that is asked again and again: a line of JSON for each task, a line for each answer.

    Args:
        script: Path of the worker's script, which bounds its own memory.
    """

    def __init__(self, script: str) -> None:
        self._printed = _Beginning()
        self._process = subprocess.Popen(
            [sys.executable, "-I", script],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._printed.writer,
            bufsize=0,
            env={},
            start_new_session=True,  # So that what it starts ends with it.
        )
        self._read = b""

    def ask(self, task: Mapping[str, Any], timeout: float) -> dict[str, Any]:
        """The answer to a task; {"fault": ...} if it takes too long or the worker ends, which no longer runs then.

        Args:
            task: What it reads.
            timeout: Wall time [s].
        """
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(json.dumps(task).encode() + b"\n")
            line = self._line(time.monotonic() + timeout)
        except (BrokenPipeError, ValueError):
            line = b""
        if line is None:
            self.close()
            return {"fault": f"it takes longer than {timeout:g} s"}
        try:
            answer: dict[str, Any] = json.loads(line)
        except ValueError:
            answer = {"fault": self._ended()}
        if "fault" in answer:
            self.close()
        return answer

    def _line(self, until: float) -> bytes | None:
        """The next line; b"" at the end of the worker, None if there is none by then."""
        assert self._process.stdout is not None
        stream = self._process.stdout.fileno()
        while b"\n" not in self._read:
            if not select.select([stream], [], [], max(0.0, until - time.monotonic()))[0]:
                return None
            chunk = os.read(stream, 1 << 16)
            if not chunk:
                return b""
            self._read += chunk
        line, _, self._read = self._read.partition(b"\n")
        return line

    def _ended(self) -> str:
        """How the worker ended without an answer."""
        self.close()
        code, printed = self._process.returncode, self._printed.text().strip()
        how = f"by {signal.Signals(-code).name}" if code < 0 else f"with status {code}"
        return f"its process ended {how}{f', and printed: {printed[-300:]}' if printed else ''}"

    def close(self) -> None:
        """End the worker and all that it started."""
        for stream in (self._process.stdin, self._process.stdout):
            if stream is not None:
                with suppress(BrokenPipeError):
                    stream.close()
        if self._process.poll() is None:
            with suppress(subprocess.TimeoutExpired):  # It ends by itself, once nothing more is asked.
                self._process.wait(0.2)
        with suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()
        self._printed.close()


class _Beginning:
    """A pipe, of which the first bytes are kept and the others read and dropped, so that its writer never waits."""

    def __init__(self) -> None:
        self._reader, self.writer = os.pipe()
        self._kept = bytearray()
        self._thread = Thread(target=self._read, daemon=True)
        self._thread.start()

    def _read(self) -> None:
        with os.fdopen(self._reader, "rb", buffering=0) as stream:
            while chunk := stream.read(1 << 16):
                self._kept += chunk[: MAX_PRINTED - len(self._kept)]

    def close(self) -> None:
        """End the pipe; its last writer is gone."""
        if self.writer >= 0:
            os.close(self.writer)
            self.writer = -1
            self._thread.join()

    def text(self) -> str:
        """The stored first bytes, with control characters and invalid UTF-8 escaped for terminals and logs."""
        self.close()
        text = self._kept.decode("utf-8", "backslashreplace")
        return "".join(c if c.isprintable() or c == "\n" else f"\\u{ord(c):04x}" for c in text)
