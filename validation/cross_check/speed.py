"""How fast our functions are, as multiples of a fixed program's time in the same run: what another run can be held to.

A time in seconds says as much about the machine and its load as about the code. Here each turn of a function stands
between two turns of a program that never changes (`native/yardstick.c`), and the ratio of their times is kept: the
lower quartile over the turns, since load only ever adds, and the range between the quartiles as its noise.
"""

from __future__ import annotations

import ctypes
import math
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path

import numpy as np

from symofros.tools import DEFAULT_FLAGS, find_toolchain

from ..adapters import compiled
from ..contract.interface import Subject
from ..inputs.frames import chosen_frames
from ..inputs.sampling import sample

# Functions that are timed, by the harness's names of quantities.
TIMED = ("mass_matrix", "bias", "inverse_dynamics", "forward_dynamics")
# States of one call: enough that the way from Python is little beside them.
STATES = 4096
TURNS = 25
# As many sets of turns at most, until the noise is below STEADY: others may be at work on the machine.
SETS, STEADY = 4, 0.05
# A turn takes at least as long [ns]: far above the clock's steps, far below the periods in which machines change speed.
LEAST = 4_000_000
_INPUTS, _WIDTH = 8, 16

Turn = Callable[[], object]


@dataclass(frozen=True)
class Speed:
    """Speed of one function of one model.

    Attributes:
        model: Label of the model.
        function: Name of the function.
        ratio: Time a state over the yardstick's, lower quartile over the turns.
        noise: Range between the quartiles of the ratio, relative to it.
        nanoseconds: Time a state, lower quartile [ns]; for people.
    """

    model: str
    function: str
    ratio: float
    noise: float
    nanoseconds: float


class YardstickError(Exception):
    """The yardstick can't be compiled; the message says why."""


def measure(subject: Subject) -> list[Speed]:
    """The speeds of a subject's functions, in batches of STATES.

    Raises:
        SymofrosError: The model can't be made.
        YardstickError: There is no compiler, or it refuses the yardstick.
    """
    assembly = subject.assembly
    subject = Subject(subject.label, subject.system, subject.frames or chosen_frames(assembly))
    engine = compiled.build(subject)
    states = sample(assembly, engine.model.nu, STATES)
    rows = []
    for function in TIMED:
        ratio, noise, nanoseconds = paired(partial(getattr(engine, function), states), yardstick())
        rows.append(Speed(subject.label, function, ratio, noise, nanoseconds / STATES))
    return rows


def paired(function: Turn, standard: Turn) -> tuple[float, float, float]:
    """Time of a function over that of a standard, its noise, and the function's time [ns].

    Args:
        function: Function of a call to be timed.
        standard: Standard, timed before and after each turn of it.

    Returns:
        Lower quartile of the ratio; range between its quartiles, relative to it; lower quartile of the time of a call:
        of the set of turns with the least noise.
    """
    calls, standard_calls = _calls(function), _calls(standard)
    sets: list[tuple[float, float, float]] = []
    while len(sets) < SETS and min((noise for _, noise, _ in sets), default=np.inf) > STEADY:
        before = _time(standard, standard_calls)
        ratios, times = [], []
        for _ in range(TURNS):
            own = _time(function, calls)
            after = _time(standard, standard_calls)
            times.append(own)
            ratios.append(own / (0.5 * (before + after)))
            before = after
        low, high = np.quantile(ratios, [0.25, 0.75])
        sets.append((float(low), float((high - low) / low), float(np.quantile(times, 0.25))))
    return min(sets, key=lambda one: one[1])


def _calls(function: Turn) -> int:
    """Number of calls that take LEAST together; this also warms caches and branches."""
    function()
    return max(1, math.ceil(LEAST / max(_time(function, 1), 1.0)))


def _time(function: Turn, calls: int) -> float:
    """Processor time of a call [ns]: while others have the processor, none passes."""
    start = time.thread_time_ns()
    for _ in range(calls):
        function()
    return (time.thread_time_ns() - start) / calls


@cache
def yardstick() -> Turn:
    """The fixed program over STATES rows, compiled as generated code is.

    Raises:
        YardstickError: There is no compiler, or it refuses.
    """
    toolchain = find_toolchain()
    if toolchain is None:
        raise YardstickError("the yardstick of speeds: no C compiler was found; install gcc or clang, or ziglang")
    with tempfile.TemporaryDirectory(prefix="symofros-yardstick-") as private:
        library = Path(private) / "yardstick.so"
        source = Path(private) / "yardstick.c"
        shutil.copyfile(Path(__file__).parents[1] / "native" / "yardstick.c", source)
        command = [*toolchain.command, *DEFAULT_FLAGS, "-std=c99", "-shared", "-fPIC", str(source), "-o", str(library)]
        done = subprocess.run([*command, "-lm"], capture_output=True, text=True, timeout=120)
        if done.returncode != 0:
            raise YardstickError(f"the yardstick of speeds: {toolchain.command[0]} refuses it: {done.stderr[-500:]}")
        function = ctypes.CDLL(str(library)).yardstick
    function.restype = None
    x = np.linspace(-3.0, 3.0, STATES * _INPUTS)
    y = np.empty(STATES * _WIDTH)
    pointer = ctypes.POINTER(ctypes.c_double)
    arguments = ctypes.c_size_t(STATES), x.ctypes.data_as(pointer), y.ctypes.data_as(pointer)

    def run(kept: Sequence[object] = (x, y)) -> None:
        function(*arguments)

    return run
