"""Processes that print what they find as they find it: a line of JSON, {kind: value}, a message."""

from __future__ import annotations

import json
import subprocess
import tempfile
from collections.abc import Callable, Mapping, Sequence
from typing import Any

Say = Callable[[str, Any], object]


class WorkerError(RuntimeError):
    """A worker ended before its time; with its status and last words."""


def follow(command: Sequence[str], take: Callable[[str], None], environment: Mapping[str, str] | None = None) -> None:
    """Run a worker and hand on its lines as they come; it ends with this process, or with Ctrl-C.

    Args:
        command: Program and arguments.
        take: Takes a line.
        environment: Variables of the process; this one's unless stated.

    Raises:
        WorkerError: It ended before its time.
    """
    with tempfile.TemporaryFile("w+") as complaints:
        pipe = subprocess.PIPE
        worker = subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=complaints, text=True, env=environment)
        assert worker.stdin is not None and worker.stdout is not None
        try:
            for line in worker.stdout:
                take(line)
            status = worker.wait()
        except BaseException:
            worker.kill()
            worker.wait()
            raise
        finally:
            worker.stdin.close()
            worker.stdout.close()
        if status != 0:
            complaints.seek(0)
            last = (complaints.read().strip() or "no word").splitlines()[-1]
            raise WorkerError(f"ended with {status}: {last}")


def say(kind: str, value: Any) -> None:
    """Print a message from a worker process, as a line of JSON."""
    print(json.dumps({kind: value}), flush=True)


def message(line: str) -> tuple[str, Any]:
    """Kind and value of a line; of lines that are no messages, as engines and frameworks print them, "" and None."""
    try:
        ((kind, value),) = json.loads(line).items()
    except (ValueError, AttributeError):
        return "", None
    return kind, value
