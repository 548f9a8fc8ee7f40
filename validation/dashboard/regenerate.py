"""Write a report anew by a process of its own: one that crashes or is interrupted takes no other with it."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

from validation.reporting.record import Topic

_ENDS = {0: "written", 1: "written; something in it is missed"}


def regenerate(topic: Topic, folder: Path) -> str:
    """Run the command of a report.

    Returns:
        How it ended, with the last lines of what it complained of if it wrote no report.
    """
    start = time.perf_counter()
    command = [sys.executable, "-m", *topic.words, "--output", str(folder)]
    run = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False)
    end = _ENDS.get(run.returncode, f"failed ({run.returncode})")
    complaint = [] if run.returncode in _ENDS else run.stderr.strip().splitlines()[-5:]
    return "\n".join([f"{topic.name}: {end}, {time.perf_counter() - start:.0f} s", *complaint])
