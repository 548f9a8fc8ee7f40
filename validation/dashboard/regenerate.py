"""Write all reports anew, each by a process of its own: one that crashes or is interrupted takes no other with it."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from validation.dashboard.catalogue import TOPICS


@dataclass(frozen=True)
class Outcome:
    """How one command ended.

    Attributes:
        name: Name of the report.
        code: Exit code of its process; 1 is a report that says something is wrong.
        seconds: Wall time.
        said: The last lines of what it complained of, if it wrote no report.
    """

    name: str
    code: int
    seconds: float
    said: str = ""


def commands() -> dict[str, tuple[str, ...]]:
    """Report -> its command, for those that `--regenerate` writes."""
    return {
        name: (name,) if topic.arguments is None else topic.arguments
        for name, topic in TOPICS.items()
        if topic.everyday
    }


def regenerate(folder: Path, starting: Callable[[str], None], done: Callable[[Outcome], None]) -> None:
    """Run every command in turn; Ctrl-C ends the one that runs, and KeyboardInterrupt goes on to the caller.

    Args:
        folder: Folder of the reports.
        starting: Gets the name of each report.
        done: Gets how it ended.
    """
    for name, arguments in commands().items():
        starting(name)
        start = time.perf_counter()
        command = [sys.executable, "-m", "validation", *arguments, "--output", str(folder)]
        run = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, check=False)
        said = "" if run.returncode in (0, 1) else "\n".join(run.stderr.strip().splitlines()[-5:])
        done(Outcome(name, run.returncode, time.perf_counter() - start, said))
