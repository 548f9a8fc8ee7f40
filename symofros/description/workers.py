"""Processes with few rights that read files from elsewhere: scripts of their own, asked and answered in JSON."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Mapping
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
