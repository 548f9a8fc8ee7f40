"""Sides of one function in turn, over the same states, on one processor; each checked against ours first."""

from __future__ import annotations

import math
import os
import statistics
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import partial
from time import thread_time_ns
from typing import NamedTuple

import numpy as np

from ..contract.quantities import ROUNDING, SOLVE
from ..mechanics.geometry import Array
from .task import Loop

# Of the largest entry of a state's result. Integrators of quaternions differ in method, by the fourth power of a step.
_SOLVED = ("forward_dynamics", "forward_dynamics_derivatives", "forward_dynamics_vjp", "step")
TOLERANCES = dict.fromkeys(_SOLVED, SOLVE)
# Of floats, whose last place is so much larger; forward dynamics amplifies it by the condition of M, as it does with
# doubles.
SINGLE_OVER_DOUBLE_ROUNDING = 2.0**29
# What a turn takes at least [ns]: whatever the side before has left in the caches, hundreds of kilobytes of code among
# it, is paid for once a turn. With turns of 1 ms fast sides of large models seemed 40 % slower than they are.
LEAST = 10_000_000


class DisagreementError(Exception):
    """Two sides compute different things, so their times mean nothing."""


class Times(NamedTuple):
    """Nanoseconds a state.

    Attributes:
        minimum: Over the repeats, as the median.
    """

    minimum: float
    median: float


def race(loops: Mapping[str, Loop], states: int, repeats: int) -> dict[str, Times]:
    """Time contestants in turn.

    Args:
        loops: Name of a contestant -> its loop.
        states: Number of states of one round.
        repeats: Interleaved.

    Returns:
        Times by the same names.
    """
    sides = {name: partial(_nanoseconds, loop.run) for name, loop in loops.items()}
    return {name: summary(turns) for name, turns in in_turn(sides, states, repeats, LEAST).items()}


def in_turn(sides: Mapping[str, Callable[[int], int]], states: int, repeats: int, least: int) -> dict[str, list[float]]:
    """Times of each turn of each side [ns a state].

    Args:
        sides: Name of a side -> nanoseconds that so many rounds of it take.
        states: Number of states of one round.
        repeats: Interleaved.
        least: What the rounds of a turn take together at least [ns]; finding how many warms caches and branches.
    """
    times: dict[str, list[float]] = {name: [] for name in sides}
    with on_one_cpu():
        rounds = {name: max(1, math.ceil(least / max(min(side(1), side(1)), 1))) for name, side in sides.items()}
        for _ in range(repeats):
            for name, side in sides.items():
                times[name].append(side(rounds[name]) / (rounds[name] * states))
    return times


def summary(times: Sequence[float]) -> Times:
    """Minimum and median."""
    return Times(min(times), statistics.median(times))


def _nanoseconds(run: Callable[[int], None], rounds: int) -> int:
    """Nanoseconds of this thread's processor time: time given to other threads is not counted."""
    start = thread_time_ns()
    run(rounds)
    return thread_time_ns() - start


def error(computed: Array, expected: Array) -> float:
    """The largest difference of a state, relative to the state's largest entry.

    States where everything vanishes are judged by the largest entry of all.
    """
    scale = np.abs(expected).max(axis=1)
    scale = np.maximum(scale, np.abs(expected).max() * np.finfo(float).eps)
    largest = np.abs(computed - expected).max(axis=1)
    return float(np.max(np.divide(largest, scale, out=largest.copy(), where=scale > 0.0)))


def checked(function: str, name: str, computed: Array, expected: Array, coarser: float = 1.0) -> float:
    """The error of a contestant.

    Args:
        function: Name of the function.
        name: Name of the contestant.
        computed: Results of the contestant (n, size).
        expected: Results of symofros (n, size).
        coarser: Factor by which its rounding is larger.

    Raises:
        DisagreementError: It is more than rounding.
    """
    if computed.shape != expected.shape:
        raise DisagreementError(f"{function} by {name}: {computed.shape[1]} numbers a state, not {expected.shape[1]}")
    off = error(computed, expected)
    if not off <= coarser * TOLERANCES.get(function, ROUNDING):
        raise DisagreementError(f"{function} by {name} differs from ours by {off:.1e}: their times mean nothing")
    return off


def pin_to_one_cpu() -> None:
    """Keep this process on one processor, where the system can."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})


@contextmanager
def on_one_cpu() -> Iterator[None]:
    """The same for a while: compilers may use all of them again."""
    before = os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else None
    pin_to_one_cpu()
    try:
        yield
    finally:
        if before is not None:
            os.sched_setaffinity(0, before)
