"""What a user waits for: the import, the first number, all functions compiled; with an empty cache and a full one.

Each run is a new process, timed by the clock from its start to its end. Plain calls from Python are timed in a worker
process (calls.py).
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from ..inputs.cases import robot_file
from ..worker_process import WorkerProcess
from . import calls
from .record import Wait

LABEL = "first_second"
# Runs with a full cache take a second at most, those with an empty one up to half a minute.
RUNS, RUNS_ANEW = 7, 3
_FIRST_NUMBER = """
import symofros as sf
model = sf.compile(sf.load({path!r}, floating_base={floating}))
model.mass_matrix(model.neutral())
"""


@dataclass(frozen=True)
class Robot:
    """A robot that is waited for.

    Attributes:
        label: Name in tables.
        file: Path below the robots of the package.
        floating: Whether nothing holds its root.
        asked: Seconds that are asked for, keyed by what is waited for.
    """

    label: str
    file: str
    floating: bool
    asked: Mapping[str, float]


INFO, FIRST, FIRST_AGAIN = "symofros info", "first M, cache empty", "first M"
COMPILE, COMPILE_AGAIN = "symofros compile, cache empty", "symofros compile"
CALL, BATCH = "model.mass_matrix(q)", "M, then h, of 4096 states: a state"
ROBOTS = (
    Robot("panda", "panda_description/urdf/panda.urdf", False, {INFO: 0.5, CALL: 1.5e-6}),
    Robot(
        "go2",
        "go2_description/urdf/go2.urdf",
        True,
        {INFO: 0.5, FIRST: 1.0, COMPILE: 8.0, COMPILE_AGAIN: 0.3, CALL: 3.0e-6},
    ),
    # As `symofros compile go2.urdf` has it.
    Robot("go2, base fixed", "go2_description/urdf/go2.urdf", False, {COMPILE: 8.0, COMPILE_AGAIN: 0.3}),
)
# A plain batched call takes at most so many times what its C takes.
BATCH_OVERHEAD = 1.4


def measure_waits(doing: Callable[[str], None]) -> list[Wait]:
    """All waits, in the order of the table.

    Args:
        doing: Told what is measured next.

    Raises:
        RuntimeError: A process failed; with its last words.
        FileNotFoundError: The package of robots is not installed.
    """
    waits: list[Wait] = []
    with tempfile.TemporaryDirectory() as folder:
        for what, asked in (("import numpy", None), ("import symofros", 0.1)):
            doing(what)
            waits.append(Wait(what, "", process_time(("-c", what), Path(folder), RUNS), asked))
        for robot in ROBOTS:
            waits += _robot_waits(robot, Path(folder), doing)
    return waits


def _robot_waits(robot: Robot, cache: Path, doing: Callable[[str], None]) -> Iterator[Wait]:
    """Waiting times of one robot.

    Args:
        robot: The robot.
        cache: Folder of a cache, which is filled.
        doing: Told what is measured next.
    """
    path = str(robot_file(robot.file))
    first = ("-c", _FIRST_NUMBER.format(path=path, floating=robot.floating))
    model = (path, "--floating-base") if robot.floating else (path,)
    info, compiling = (("-m", "symofros", command, *model) for command in ("info", "compile"))
    processes = (
        (INFO, info, cache),
        (FIRST, first, None),
        (COMPILE, compiling, None),
        (COMPILE_AGAIN, compiling, cache),
        (FIRST_AGAIN, first, cache),
    )
    for what, arguments, folder in processes:
        doing(f"{robot.label}: {what}")
        if what == COMPILE_AGAIN:
            process_time(arguments, cache, 1)  # Fills the cache.
        seconds = process_time(arguments, folder, RUNS_ANEW if folder is None else RUNS)
        yield Wait(what, robot.label, seconds, robot.asked.get(what))
    doing(f"{robot.label}: {CALL}")
    with WorkerProcess(environment={"SYMOFROS_CACHE": str(cache)}) as worker:
        (times,) = worker.call(calls.times, path, robot.floating)
    yield Wait(CALL, robot.label, times["call"], robot.asked.get(CALL))
    if "pinocchio" in times:
        yield Wait("pinocchio.crba(model, data, q)", robot.label, times["pinocchio"], None)
    yield Wait(BATCH, robot.label, times["batch"], BATCH_OVERHEAD * times["kernel"])
    yield Wait("the same by bound functions: the C alone", robot.label, times["kernel"], None)


def process_time(arguments: Sequence[str], cache: Path | None, runs: int) -> float:
    """Median seconds of some runs of a process of Python; without a cache's folder each has an empty one."""
    seconds = []
    for _ in range(runs):
        with tempfile.TemporaryDirectory() as empty:
            seconds.append(_process(arguments, cache or Path(empty)))
    return median(seconds)


def _process(arguments: Sequence[str], cache: Path) -> float:
    """Wall time of a Python process [s]."""
    environment = {**os.environ, "SYMOFROS_CACHE": str(cache)}
    # Whoever installs a package has its bytecode; without, each process would translate its text again.
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    start = time.perf_counter()
    done = subprocess.run([sys.executable, *arguments], capture_output=True, text=True, env=environment, check=False)
    seconds = time.perf_counter() - start
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(arguments)}: {(done.stderr.strip() or 'no word').splitlines()[-1]}")
    return seconds
