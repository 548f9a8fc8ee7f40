"""Samples in time: which blocks are due when, from periods and offsets taken as exact decimals."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import count

import numpy as np

from symofros.errors import DescriptionError
from symofros.simulation.inputs import ROUNDED_ZERO

# Instants of a common period: more are a sign of periods that do not fit together.
MAX_INSTANTS = 100_000
# Different sets of blocks that are due together; a function is generated for each.
MAX_SETS = 64


@dataclass(frozen=True)
class Schedule:
    """Instants that repeat.

    Attributes:
        base: All instants are multiples of it [s].
        cycle: After so many multiples of base the pattern repeats; 0 where nothing is sampled.
        instants: (multiple of base in the cycle, index of the set that is due), in order of time.
        sets: Names of what is due together.
    """

    base: Fraction
    cycle: int
    instants: tuple[tuple[int, int], ...]
    sets: tuple[frozenset[str], ...]

    @property
    def spacing(self) -> float:
        """The shortest time between two instants [s]; infinite without any."""
        at = [k for k, _ in self.instants]
        gaps = [b - a for a, b in zip(at, [*at[1:], *(first + self.cycle for first in at[:1])], strict=True)]
        return float(min(gaps) * self.base) if gaps else math.inf

    def between(self, t0: float, t_end: float) -> Iterator[tuple[float, frozenset[str]]]:
        """(time [s], what is due) of each instant up to the end, with the bits that C gives the times."""
        base_n, base_d = float(self.base.numerator), float(self.base.denominator)
        for turn in count() if self.instants else ():
            for k, which in self.instants:
                t = float(np.float64(t0) + np.float64(turn * self.cycle + k) * base_n / base_d)
                t = 0.0 if abs(t) < ROUNDED_ZERO * base_n / base_d else t
                if t > t_end + 1e-9 * base_n / base_d:
                    return
                yield min(t, t_end), self.sets[which]

    @staticmethod
    def empty() -> Schedule:
        """A schedule without instants."""
        return Schedule(Fraction(1), 0, (), ())


def schedule(rates: Iterable[tuple[str, float, float]], name: str) -> Schedule:
    """The schedule of (thing, period, offset), each offset less than its period.

    Raises:
        DescriptionError: The periods have no common multiple within bounds.
    """
    exact = [(thing, _exact(period), _exact(offset)) for thing, period, offset in rates]
    if not exact:
        return Schedule.empty()
    numbers = [number for _, period, offset in exact for number in (period, offset) if number]
    denominator = math.lcm(*(number.denominator for number in numbers))
    base = Fraction(math.gcd(*(int(number * denominator) for number in numbers)), denominator)
    cycle = math.lcm(*(int(period / base) for _, period, _ in exact))
    samples = sum(cycle // int(period / base) for _, period, _ in exact)
    if samples > MAX_INSTANTS:
        raise _too_many(name, exact, f"{samples} samples before the pattern repeats", f"at most {MAX_INSTANTS}")
    due: dict[int, set[str]] = {}
    for thing, period, offset in exact:
        for k in range(int(offset / base), cycle, int(period / base)):
            due.setdefault(k, set()).add(thing)
    sets: dict[frozenset[str], int] = {}
    instants = [(k, sets.setdefault(frozenset(due[k]), len(sets))) for k in sorted(due)]
    if len(sets) > MAX_SETS:
        raise _too_many(name, exact, f"{len(sets)} different sets due together", f"at most {MAX_SETS}")
    return Schedule(base, cycle, tuple(instants), tuple(sets))


def _exact(seconds: float) -> Fraction:
    """The decimal that a person wrote, not the binary number next to it."""
    return Fraction(repr(float(seconds))).limit_denominator(10**12)


def _too_many(name: str, exact: list[tuple[str, Fraction, Fraction]], found: str, rule: str) -> DescriptionError:
    periods = sorted({float(period) for _, period, _ in exact})
    return DescriptionError(
        f"diagram '{name}': sample times do not fit together",
        f"{found}; periods {periods[:6]}",
        rule,
        "choose periods that are multiples of each other",
    )
