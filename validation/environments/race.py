"""Sides of one function in turn: each checked against native C first, then timed by the clock."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from time import perf_counter_ns

from ..mechanics.geometry import Array
from ..timing.race import error, in_turn
from .record import NATIVE, OURS, TOLERANCE, Row
from .sides import Offer, Side, Subject, native

TURNS = 11
# What a turn takes at least [ns]; a call that takes longer is a turn.
LEAST = 4_000_000
# Told of a side that could not be computed, or differs: its name, and why.
Fail = Callable[[str, str], object]


def rows(
    environment: str,
    subject: Subject,
    offers: Sequence[tuple[str, Offer]],
    function: str,
    states: int,
    turns: int,
    fail: Fail,
) -> Iterator[Row]:
    """Race a function.

    Args:
        environment: Name of the environment.
        subject: Model and states.
        offers: Names of the sides, ours among them, with what makes each.
        function: Name of the function.
        states: States in a call.
        turns: Interleaved.
        fail: Told of sides that are left out of the race.
    """
    reference = native(subject, function, states)
    expected = reference.results()
    sides, errors = [reference], {NATIVE: 0.0}
    for who, offer in offers:
        try:
            side = offer(function, states)
            computed = None if side is None else side.results()
        except Exception as problem:  # Frameworks raise errors of every kind; the others are raced all the same.
            fail(who, f"{type(problem).__name__}: {_first_line(problem)}")
            continue
        if side is None or computed is None:
            continue
        off = checked(computed, expected, partial(fail, who))
        if off is not None:
            sides.append(side)
            errors[who] = off
    times = raced(sides, states, turns)
    for who, taken in times.items():
        yield Row.of(environment, subject.label, function, states, who, taken, times.get(OURS), errors[who])


def checked(computed: Array, expected: Array, fail: Callable[[str], object]) -> float | None:
    """Error of results (n, size) against native C, relative to a state's largest entry; None if above TOLERANCE."""
    off = error(computed, expected) if computed.shape == expected.shape else math.inf
    if off <= TOLERANCE:
        return off
    fail(f"differs from native C by {off:.1e}: its time means nothing")
    return None


def _first_line(problem: Exception) -> str:
    return next(iter(str(problem).strip().splitlines()), "no word")


def raced(sides: Sequence[Side], states: int, turns: int) -> dict[str, list[float]]:
    """Times of each turn of each side [ns a state], by side."""
    return in_turn({side.who: partial(_taken, side) for side in sides}, states, turns, LEAST)


def _taken(side: Side, rounds: int) -> int:
    """Time of so many calls by the clock [ns]: frameworks compute in threads of their own."""
    call = side.call
    start = perf_counter_ns()
    for _ in range(rounds):
        call()
    return perf_counter_ns() - start
