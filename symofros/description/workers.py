"""Processes with few rights that read files from elsewhere: scripts of their own, asked and answered in JSON."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Mapping
from typing import Any


def answer_of(script: str, task: Mapping[str, Any], timeout: float, bounds: str) -> dict[str, Any]:
    """What a worker answers; {"fault": ...} where it takes too long or does not come to its end.

    Args:
        script: Path of the worker's script, which bounds its own processor time and memory.
        task: What it reads.
        timeout: Wall time [s].
        bounds: Limits that a worker may have hit when it ended without an answer, as text after "it takes".
    """
    try:
        # Warnings are dropped: a file may ask for any number of them.
        done = subprocess.run(
            [sys.executable, "-I", script],
            input=json.dumps(task).encode(),
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            timeout=timeout,
            env={},
        )
    except subprocess.TimeoutExpired:
        return {"fault": f"it takes longer than {timeout} s"}
    if done.returncode:
        return {"fault": f"it takes {bounds}"}
    answer: dict[str, Any] = json.loads(done.stdout)
    return answer
